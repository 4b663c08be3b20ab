// Finds the bindings that a SPIR-V module declares.
#ifndef LAMPYRIS_GPU_SPIRV_BINDINGS_H
#define LAMPYRIS_GPU_SPIRV_BINDINGS_H

#include <stddef.h>
#include <stdint.h>

// Returns bit i if a variable of the module has binding i < 64. All variables are in descriptor set
// 0.
uint64_t spirv_bindings(const uint32_t *code, size_t bytes);

#endif
