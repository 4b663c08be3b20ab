// Programs of distance fields as code of the kernels, in place of the interpreter of lib/sdf.glsl.
#ifndef LAMPYRIS_RENDER_SDF_INLINE_H
#define LAMPYRIS_RENDER_SDF_INLINE_H

#include "scene/core/scene.h"
#include <stddef.h>
#include <stdint.h>

#define SDF_INLINE_MOST 256 // instructions of all programs; beyond, compiling takes too long

// Returns whether the programs are few and short enough.
bool sdf_inline_fits(const struct scene *scene);

// Of the programs, to tell their code from that of others; 0 where they do not fit.
uint64_t sdf_inline_key(const struct scene *scene);

// Writes the SPIR-V module `code` with another body of sdf_value(): a branch for each program, and
// in it calls of the operations' functions with its numbers as constants, in the interpreter's
// order. Values differ from the interpreter's by rounding at most: drivers add constants up. The
// result is the caller's to free(); NULL for a module without sdf_value(), one that it does not
// understand, or without memory: such a module is to be used as it is.
uint32_t *sdf_inline(const uint32_t *code, size_t bytes, const struct scene *scene,
                     size_t *out_bytes);

#endif
