// Lists the emitters at which shadow rays are aimed, as kernels read them (BINDING_EMITTERS), in a
// form that depends on the light sampling strategy (LIGHT_CHOICE_*).
#ifndef LAMPYRIS_RENDER_TABLES_EMITTERS_H
#define LAMPYRIS_RENDER_TABLES_EMITTERS_H

#include "bvh/bvh.h"
#include "flatten/flatten.h"
#include "scene/core/scene.h"
#include "shared/types.h"

// Numbers of a scene's emitters, by kind.
struct emitter_counts {
    uint32_t triangles;
    uint32_t shapes[SHAPE_KIND_COUNT]; // by enum shape_kind; see shape_is_emitter()
    uint32_t lights;                   // delta lights
    uint32_t suns;                     // directional lights with an angular diameter
    uint32_t environment; // 1: the environment's image is an emitter; only scattered rays find a
                          // uniform environment
};

// Returns whether shadow rays can be aimed at shapes of that kind. Infinite planes and distance
// fields emit, too, but only scattered rays find them.
bool shape_is_emitter(uint32_t kind);

struct emitter_counts emitters_count(const struct scene *scene, const struct flat_scene *flat);
uint64_t emitters_total(const struct emitter_counts *counts);

struct emitters {
    void *data; // records for kernels: see struct gpu_emitter and struct gpu_light_tree
    uint64_t bytes;
    uint32_t count;           // 0: there are no emitters to aim at
    uint32_t *primitives;     // primitive word of each emitter: triangles, shapes, lights,
                              // environment
    uint32_t surface_count;   // number of emitters that are triangles or shapes; these come first
    struct gpu_light *lights; // scene->light_count records
    float environment_pick;   // selection probability of the environment's image
    float environment_floor;  // luminance; shadow rays sample only the image's part above it
    float reach;              // length of shadow rays to infinitely far emitters
    double total_power;       // see emitter_power.h; set if emitters are selected by power
    double build_seconds;     // time to build the light tree
};

struct shading_tables_params;

// Builds all members in `arena`. Warns of lights that no ray can find.
bool emitters_build(const struct shading_tables_params *p, struct arena *arena,
                    struct emitters *out, struct err *err);
// Returns PARAMETER_PICK_DENSITY of a material: if emitters are selected by power, the selection
// probability per unit of area; otherwise 1 if its surfaces are emitters, else 0.
float emitters_pick_density(const struct emitters *emitters, const struct scene *scene,
                            const struct material *material);

#endif
