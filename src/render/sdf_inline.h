// Compiles the programs of distance fields into the kernels, in place of the interpreter of
// lib/sdf.glsl.
#ifndef LAMPYRIS_RENDER_SDF_INLINE_H
#define LAMPYRIS_RENDER_SDF_INLINE_H

#include "scene/core/scene.h"
#include <stddef.h>
#include <stdint.h>

#define SDF_INLINE_MOST 256 // instructions of all programs together; more take too long to compile

// Returns whether all programs together have at most SDF_INLINE_MOST instructions.
bool sdf_inline_fits(const struct scene *scene);

// Returns a hash of the programs, by which compiled code is cached; 0 if they are too long.
uint64_t sdf_inline_key(const struct scene *scene);

// Returns the SPIR-V module `code` with another body of sdf_value(): a branch for each program,
// which calls the functions of the program's operations in the interpreter's order, with its
// numbers as constants. Values differ from the interpreter's only by rounding, because drivers fold
// constants. The caller frees the result. Returns NULL if the module has no sdf_value() or an
// unknown structure, or when out of memory; use the module unchanged then.
uint32_t *sdf_inline(const uint32_t *code, size_t bytes, const struct scene *scene,
                     size_t *out_bytes);

#endif
