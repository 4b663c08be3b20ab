// Requests sums and products that are rounded to the nearest float.
#ifndef LAMPYRIS_GPU_SPIRV_ROUNDING_H
#define LAMPYRIS_GPU_SPIRV_ROUNDING_H

#include <stddef.h>
#include <stdint.h>

// The greatest number of bytes that spirv_round_to_nearest() adds to a module.
#define SPIRV_ROUNDING_BYTES 52u

// Writes `code` (`bytes` long, whole words) to `out`, which has room for SPIRV_ROUNDING_BYTES more,
// with the execution mode RoundingModeRTE of 32 bits (SPV_KHR_float_controls, revision 4) for its
// entry point. A device must have shaderRoundingModeRTEFloat32. Returns the bytes written, or 0 for
// what is no module or has no entry point.
size_t spirv_round_to_nearest(const uint32_t *code, size_t bytes, uint32_t *out);

#endif
