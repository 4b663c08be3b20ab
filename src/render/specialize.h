// What a (scene, settings, device) needs: decided here, in one function, and nowhere else.
#ifndef LAMPYRIS_RENDER_SPECIALIZE_H
#define LAMPYRIS_RENDER_SPECIALIZE_H

#include "bvh.h"
#include "flatten.h"
#include "gpu.h"
#include "kernels.h"
#include "scene.h"
#include "shared/bindings.h"

// Values of the specialization constants, in the order of their ids.
struct specialization {
    uint32_t features; // FEATURE_*
    uint32_t workgroup;
    uint32_t stack_entries;
    uint32_t iteration_budget; // of a lane; see specialize.c
    uint32_t interleave;
};
_Static_assert(sizeof(struct specialization) == 4 * CONSTANT_COUNT, "one word a constant");

// Counts of what a scene emits with, for the features and the emitters' table.
struct emitter_counts {
    uint32_t triangles, spheres, discs;
};

struct emitter_counts emitters_count(const struct scene *scene, const struct flat_scene *flat);

// `everything` compiles in all that does not change what is computed: for measuring what leaving
// out is worth, and for testing that it changes no bit.
struct specialization specialize(const struct scene *scene, const struct flat_scene *flat,
                                 const struct bvh *bvh, const struct gpu *gpu, bool everything);

bool specialization_needs_kernel(const struct specialization *s, enum kernel_id id);
// By binding number; a buffer that is not needed is not created.
bool specialization_needs_binding(const struct specialization *s, uint32_t binding);
// "spheres", …; NULL for bits that are none.
const char *feature_name(uint32_t bit);

#endif
