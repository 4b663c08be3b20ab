// Decides which features a (scene, settings, device) needs, in one function.
#ifndef LAMPYRIS_RENDER_SPECIALIZE_H
#define LAMPYRIS_RENDER_SPECIALIZE_H

#include "bvh/bvh.h"
#include "flatten/flatten.h"
#include "gpu/gpu.h"
#include "render/kernels.h"
#include "scene/core/scene.h"
#include "shared/bindings.h"
#include <stddef.h>

// Values of the specialization constants, in the order of their ids.
struct specialization {
    uint32_t features; // FEATURE_*
    uint32_t workgroup;
    uint32_t stack_entries;
    uint32_t iteration_budget; // iterations of one lane; see specialize.c
    uint32_t interleave;
    uint32_t lobes;                                       // LOBE_*
    uint32_t queues;                                      // bits of the queues that exist
    uint32_t emitters;                                    // EMITTER_*
    uint32_t aovs;                                        // AOV_*
    uint32_t integrator, sampler, halves, filter, camera; // constants of shared/methods.h
    uint32_t light_choice;                                // never LIGHT_CHOICE_AUTO
    uint32_t light_rays;                                  // shadow rays that a vertex sends at most
    uint32_t mis, directions, roulette;
    uint32_t nodes;    // NODES_*
    uint32_t geometry; // GEOMETRY_*
    uint32_t sdf;      // SDF_*, as bits
    uint32_t parts;    // number and length of the parts of long buffers: see memory_plan.h
    uint32_t part_shift;
    uint32_t environment_filter; // ENVIRONMENT_FILTER_*; nearest where there is no image
    uint32_t pixel_sampling;     // PIXEL_SAMPLING_*; the sampler's own if no error is spread
    uint32_t leaf_index_bits;    // bvh_leaf_index_bits()
    uint32_t normals;            // NORMALS_*
    uint32_t radiance_scaling;
    uint32_t accumulation;   // ACCUMULATION_*
    uint32_t rounding;       // ROUNDING_*
    uint32_t stack_shared;   // entries of a thread's stack in shared memory; 0: none
    uint32_t light_vertices; // with LIGHT_CHOICE_ALL: the number of first vertices of a path, or
                             // ALL_VERTICES
    // Not a constant: `lobes` for each kernel that shades one class; 0 for classes that the scene
    // lacks.
    uint32_t class_lobes[CLASS_COUNT];
    uint32_t pending_rays; // rays that a slot may postpone; INTEGRATOR_WHITTED only
    uint32_t split_lobes;  // first vertices at which paths split; 2^this slots a sample
    bool sort_rays;        // by octant and cell, from SORT_FIRST_BOUNCE on
};
_Static_assert(offsetof(struct specialization, class_lobes) == 4 * CONSTANT_COUNT,
               "one word a constant");

// The most storage buffers that a kernel binds. For the state of paths these are as many as Vulkan
// guarantees (shading binds paths, shadow rays, radiance and queues); where scenes are not read as
// texels, all of a scene's buffers but the nodes are added.
#define STATE_STORAGE 4
#define SHADING_STORAGE (BINDING_TEXELS + STATE_STORAGE)

// Rays of earlier bounces are coherent enough: "Rays sorted by octant and cell" in
// docs/performance.md.
#define SORT_FIRST_BOUNCE 2u

struct specialize_params {
    const struct scene *scene;
    const struct flat_scene *flat;
    const struct bvh *bvh;
    const struct gpu *gpu;
    const struct camera *camera;
    const struct emitter_lamps *lamps; // see light_choice_of(); NULL: none
    uint32_t aovs;      // AOV_*
    uint32_t workgroup; // threads; 0: the device's default
    // Compiles in every feature that does not change the result: to measure what leaving features
    // out is worth, and to test that it changes no bit.
    bool compile_all;
    bool merge_classes; // one queue and one kernel for all classes of surfaces
    bool tiles;         // sample counts by tile
};
struct specialization specialize(const struct specialize_params *params);
// Sets the number of threads of a workgroup, and the members that depend on it.
void specialization_set_workgroup(struct specialization *s, const struct gpu *gpu,
                                  uint32_t workgroup);
// From now on rays that run out of their budget are suspended and continued later.
void specialization_suspend(struct specialization *s);
// Makes the traversal kernels count their steps, or not; only measurements need it.
void specialization_count_steps(struct specialization *s, bool on);

// Returns *s with one more bit of a constant and with its consequences, as if the scene needed it.
// constant: CONSTANT_FEATURES, _GEOMETRY, _PARTS, _LOBES or _EMITTERS.
struct specialization specialization_with(const struct specialization *s, uint32_t constant,
                                          uint32_t bit);

bool specialization_needs_kernel(const struct specialization *s, enum kernel_id id);
// Returns whether a buffer, by its binding number, is needed; one that is not needed is not
// created.
bool specialization_needs_binding(const struct specialization *s, uint32_t binding);
// Returns "spheres", …; NULL for a number that is not one feature's bit.
const char *feature_name(uint32_t bit);
const char *geometry_name(uint32_t bit);
const char *lobe_name(uint32_t bit);
const char *emitter_name(uint32_t bit);

#endif
