// What emits and can be sampled: primitives with emission, lights without extent.
#ifndef LAMPYRIS_RENDER_EMITTERS_H
#define LAMPYRIS_RENDER_EMITTERS_H

#include "bvh.h"
#include "flatten.h"
#include "scene.h"
#include "shared/types.h"

// Counts of what a scene emits with.
struct emitter_counts {
    uint32_t triangles, spheres, discs, lights;
};

struct emitter_counts emitters_count(const struct scene *scene, const struct flat_scene *flat);

struct emitters {
    struct gpu_emitter *bins; // alias table
    struct gpu_light *lights; // scene->light_count
    uint32_t count;           // bins; 0: nothing to sample
    double total_power;       // in units of luminance * area
};

// In `arena`. Warns of lights without extent that the estimator cannot find.
bool emitters_build(const struct scene *scene, const struct flat_scene *flat, const struct bvh *bvh,
                    struct arena *arena, struct emitters *out, struct err *err);
// PARAMETER_PICK_DENSITY of a material.
float emitters_pick_density(const struct emitters *emitters, const struct scene *scene,
                            const struct material *material);

#endif
