// What emits and can be connected to, as kernels read it (BINDING_EMITTERS): for each way to choose
// among emitters (LIGHT_CHOICE_*) what that needs.
#ifndef LAMPYRIS_RENDER_TABLES_EMITTERS_H
#define LAMPYRIS_RENDER_TABLES_EMITTERS_H

#include "bvh/bvh.h"
#include "flatten/flatten.h"
#include "scene/core/scene.h"
#include "shared/types.h"

// Counts of what a scene emits with.
struct emitter_counts {
    uint32_t triangles;
    uint32_t shapes[SHAPE_KIND_COUNT]; // by enum shape_kind; see shape_is_emitter()
    uint32_t lights;                   // without extent
    uint32_t suns;                     // directional lights with one
    uint32_t environment; // 1: its image is an emitter. Even surroundings are left to chance hits
};

// Returns whether points of shapes of that kind can be chosen to connect to. Planes without end and
// distance fields emit, too, but are found by chance only.
bool shape_is_emitter(uint32_t kind);

struct emitter_counts emitters_count(const struct scene *scene, const struct flat_scene *flat);
uint64_t emitters_total(const struct emitter_counts *counts);

struct emitters {
    void *data; // see struct gpu_emitter and struct gpu_light_tree
    uint64_t bytes;
    uint32_t count;           // 0: nothing to choose from
    uint32_t *primitives;     // of the emitters by number: triangles, shapes, lights, environment
    uint32_t surface_count;   // of them, the first so many are triangles and shapes
    struct gpu_light *lights; // scene->light_count
    float environment_pick;   // the probability of the environment's image
    float environment_floor;  // luminance: shadow rays are aimed by what its image exceeds this by
    float reach;              // length of shadow rays to what is infinitely far
    double total_power;       // as in emitter_power.h; when chosen by power
    double build_seconds;     // of the tree
};

struct shading_tables_params;

// In `arena`. Warns of lights that the estimator cannot find.
bool emitters_build(const struct shading_tables_params *p, struct arena *arena,
                    struct emitters *out, struct err *err);
// PARAMETER_PICK_DENSITY of a material: the density of choosing by power, a unit area; by other
// ways 1 where its surfaces are emitters.
float emitters_pick_density(const struct emitters *emitters, const struct scene *scene,
                            const struct material *material);

#endif
