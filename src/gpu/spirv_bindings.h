// Finds the bindings that a SPIR-V module declares.
#ifndef LAMPYRIS_GPU_SPIRV_BINDINGS_H
#define LAMPYRIS_GPU_SPIRV_BINDINGS_H

#include <stddef.h>
#include <stdint.h>

// Returns a word whose bit i is set if a variable of the module has binding i, for i < 64. All
// variables must be in descriptor set 0.
uint64_t spirv_bindings(const uint32_t *code, size_t bytes);

#endif
