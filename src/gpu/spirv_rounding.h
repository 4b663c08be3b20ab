// Makes a module request that floating-point operations are rounded to nearest.
#ifndef LAMPYRIS_GPU_SPIRV_ROUNDING_H
#define LAMPYRIS_GPU_SPIRV_ROUNDING_H

#include <stddef.h>
#include <stdint.h>

// The greatest number of bytes that spirv_round_to_nearest() adds to a module.
#define SPIRV_ROUNDING_BYTES 52u

// Copies a module (`code`, a whole number of words) to `out` and adds the execution mode
// RoundingModeRTE for 32 bits (SPV_KHR_float_controls, revision 4) to its entry point. `out` needs
// room for SPIRV_ROUNDING_BYTES more. The device must have shaderRoundingModeRTEFloat32. Returns
// the number of bytes written, or 0 if the code is not a module or has no entry point.
size_t spirv_round_to_nearest(const uint32_t *code, size_t bytes, uint32_t *out);

#endif
