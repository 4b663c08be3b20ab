// The emitters that vertices connect to, as kernels read them (BINDING_EMITTERS): the data for each
// way to choose among them (LIGHT_CHOICE_*).
#ifndef LAMPYRIS_RENDER_TABLES_EMITTERS_H
#define LAMPYRIS_RENDER_TABLES_EMITTERS_H

#include "bvh/bvh.h"
#include "flatten/flatten.h"
#include "scene/core/scene.h"
#include "shared/types.h"

// Numbers of a scene's emitters by kind.
struct emitter_counts {
    uint32_t triangles;
    uint32_t shapes[SHAPE_KIND_COUNT]; // by enum shape_kind; see shape_is_emitter()
    uint32_t lights;                   // delta lights
    uint32_t suns;                     // directional lights with an angular diameter
    uint32_t environment; // 1: its image is an emitter; a uniform one is found by chance only
};

// Returns whether shadow rays can be aimed at shapes of that kind. Infinite planes and distance
// fields emit, too, but are found by chance only.
bool shape_is_emitter(uint32_t kind);

struct emitter_counts emitters_count(const struct scene *scene, const struct flat_scene *flat);
uint64_t emitters_total(const struct emitter_counts *counts);

struct emitters {
    void *data; // see struct gpu_emitter and struct gpu_light_tree
    uint64_t bytes;
    uint32_t count;           // 0: there is nothing to choose from
    uint32_t *primitives;     // by the emitter's number: triangles, shapes, lights, environment
    uint32_t surface_count;   // the first so many are triangles and shapes
    struct gpu_light *lights; // scene->light_count
    float environment_pick;   // the selection probability of the environment's image
    float environment_floor;  // luminance: shadow rays sample the image's radiance above it
    float reach;              // length of shadow rays to infinitely far emitters
    double total_power;       // see emitter_power.h; set when emitters are chosen by power
    double build_seconds;     // time to build the tree
};

struct shading_tables_params;

// Builds everything in `arena`. Warns of lights that the estimator cannot find.
bool emitters_build(const struct shading_tables_params *p, struct arena *arena,
                    struct emitters *out, struct err *err);
// Returns PARAMETER_PICK_DENSITY of a material: the selection density, for a unit of area, when
// choosing by power; otherwise 1 if its surfaces are emitters.
float emitters_pick_density(const struct emitters *emitters, const struct scene *scene,
                            const struct material *material);

#endif
