// Removes from a SPIR-V module the code that its specialization constants make unreachable.
#ifndef LAMPYRIS_GPU_SPIRV_TRIM_H
#define LAMPYRIS_GPU_SPIRV_TRIM_H

#include <stddef.h>
#include <stdint.h>

#define SPIRV_TRIM_NO_MEMORY SIZE_MAX

// Copies a module (`code`, a whole number of words) to `out`, which has the same size, for the
// given values of the specialization constants 0 .. count - 1, which become plain constants.
// Functions that are not called, instructions in unreachable blocks, and variables with bindings
// that are no longer used are left out. The blocks remain, empty, so that the structure of the
// control flow is unchanged. Drivers remove the same code, but some (lavapipe) only after inlining
// every function, which takes most of the time of pipeline creation.
//
// Returns the number of bytes written; 0 if the module is not understood, and the caller should use
// the original; SPIRV_TRIM_NO_MEMORY if there is not enough memory.
size_t spirv_trim(const uint32_t *code, size_t bytes, const uint32_t *constants, uint32_t count,
                  uint32_t *out);

// Returns the number of instructions in the functions of a module, without labels and source lines;
// 0 if the code is not a module.
uint32_t spirv_instructions(const uint32_t *code, size_t bytes);

#endif
