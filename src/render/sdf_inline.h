// Compiles the programs of distance fields into the kernels, in place of the interpreter of
// lib/sdf.glsl.
#ifndef LAMPYRIS_RENDER_SDF_INLINE_H
#define LAMPYRIS_RENDER_SDF_INLINE_H

#include "scene/core/scene.h"
#include <stddef.h>
#include <stdint.h>

#define SDF_INLINE_MOST 256 // instructions of all programs together; more take too long to compile

// Returns whether the programs are few and short enough.
bool sdf_inline_fits(const struct scene *scene);

// Returns a hash of the programs, as the key of their code; 0 if they do not fit.
uint64_t sdf_inline_key(const struct scene *scene);

// Returns the SPIR-V module `code` with another body of sdf_value(): a branch for each program that
// calls the functions of its operations, with its numbers as constants, in the interpreter's order.
// Values differ from the interpreter's only by rounding, since drivers fold constants. The caller
// frees the result. NULL if the module has no sdf_value(), is not understood, or memory runs out:
// the module is then used unchanged.
uint32_t *sdf_inline(const uint32_t *code, size_t bytes, const struct scene *scene,
                     size_t *out_bytes);

#endif
