// Removes code from a SPIR-V module that its specialization constants make unreachable.
#ifndef LAMPYRIS_GPU_SPIRV_TRIM_H
#define LAMPYRIS_GPU_SPIRV_TRIM_H

#include <stddef.h>
#include <stdint.h>

#define SPIRV_TRIM_NO_MEMORY SIZE_MAX

// Writes `code` (`bytes` long; whole words) to `out`, which has room for as much, without functions
// that nothing calls, without what stands in blocks that nothing reaches and without the variables
// with bindings that nothing names then, given the specialization constants 0 .. count - 1, which
// become constants of these values. Blocks stay, empty, and with them the structure of the control
// flow. Drivers find the same, but some (lavapipe) only after they have put every function into its
// callers, which takes most of the time they need for a pipeline.
//
// Returns the bytes written; 0 for a module that it does not understand, which is to be used as it
// is; SPIRV_TRIM_NO_MEMORY if memory is lacking.
size_t spirv_trim(const uint32_t *code, size_t bytes, const uint32_t *constants, uint32_t count,
                  uint32_t *out);

// Returns the number of instructions in a module's functions, without labels and source lines; 0 if
// it is no module.
uint32_t spirv_instructions(const uint32_t *code, size_t bytes);

#endif
