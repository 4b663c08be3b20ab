// Decides, in one function, which features a scene, its settings and a device need.
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
    uint32_t iteration_budget; // iterations of one lane before its ray is suspended or voids the
                               // wave; see specialize.c
    uint32_t interleave;
    uint32_t lobes;                                       // LOBE_*
    uint32_t queues;                                      // bit mask of the queues in use
    uint32_t emitters;                                    // EMITTER_*
    uint32_t aovs;                                        // AOV_*
    uint32_t integrator, sampler, halves, filter, camera; // values of shared/methods.h
    uint32_t light_choice;                                // never LIGHT_CHOICE_AUTO
    uint32_t light_rays;                                  // maximum number of shadow rays of a
                                                          // vertex
    uint32_t mis, directions, roulette;
    uint32_t nodes;    // NODES_*
    uint32_t geometry; // GEOMETRY_*
    uint32_t sdf;      // SDF_*, as bits
    uint32_t parts;    // number and length of the parts of long buffers: see memory_plan.h
    uint32_t part_shift;
    uint32_t environment_filter; // ENVIRONMENT_FILTER_*; nearest if there is no image
    uint32_t pixel_sampling;     // PIXEL_SAMPLING_*; PIXEL_SAMPLING_SAMPLER if samples are not
                                 // spread over pixels
    uint32_t leaf_index_bits;    // bvh_leaf_index_bits()
    uint32_t normals;            // NORMALS_*
    uint32_t radiance_scaling;
    uint32_t accumulation;   // ACCUMULATION_*
    uint32_t rounding;       // ROUNDING_*
    uint32_t stack_shared;   // entries of a thread's stack that are in shared memory; 0: none
    uint32_t light_vertices; // with LIGHT_CHOICE_ALL: the number of vertices of a path, from its
                             // beginning, that sample all lamps, or ALL_VERTICES
    uint32_t window;         // 1: the film is a window of the picture
    // Not a constant: the value of `lobes` for each kernel that shades one class; 0 for classes
    // that do not occur in the scene.
    uint32_t class_lobes[CLASS_COUNT];
    uint32_t pending_rays; // maximum number of rays that a slot may postpone; INTEGRATOR_WHITTED
                           // only
    uint32_t split_lobes;  // number of vertices, from a path's beginning, at which paths split; a
                           // sample has 2^split_lobes slots
    bool sort_rays;        // sorts rays by octant and cell, from bounce SORT_FIRST_BOUNCE on
};
_Static_assert(offsetof(struct specialization, class_lobes) == 4 * CONSTANT_COUNT,
               "one word a constant");

// Maximum numbers of storage buffers that a kernel binds. STATE_STORAGE is for the state of paths:
// shading binds paths, shadow rays, radiance and queues. Vulkan guarantees as many. SHADING_STORAGE
// adds all buffers of the scene except the nodes, which are bound if scenes are not read as texels.
#define STATE_STORAGE 4
#define SHADING_STORAGE (BINDING_TEXELS + STATE_STORAGE)

// The first bounce whose rays are sorted; earlier rays are coherent enough: "Rays sorted by octant
// and cell" in docs/performance.md.
#define SORT_FIRST_BOUNCE 2u

struct specialize_params {
    const struct scene *scene;
    const struct flat_scene *flat;
    const struct bvh *bvh;
    const struct gpu *gpu;
    const struct camera *camera;
    const struct emitter_lamps *lamps; // see light_choice_of(); NULL: none
    uint32_t aovs;                     // AOV_*
    uint32_t workgroup;                // threads; 0: the device's default
    // Compiles in every feature that does not change the result, to measure the benefit of leaving
    // features out, and to test that they change no bit.
    bool compile_all;
    bool merge_classes; // one queue and one kernel for surfaces of all classes
    bool tiles;         // sample counts by tile
    bool has_window;    // the film is a window of the picture
};
struct specialization specialize(const struct specialize_params *params);
// Sets the number of threads of a workgroup, and the members that depend on that number.
void specialization_set_workgroup(struct specialization *s, const struct gpu *gpu,
                                  uint32_t workgroup);
// Lets rays that exceed their budget be suspended and continue in a later dispatch.
void specialization_suspend(struct specialization *s);
// Sets whether the traversal kernels count their steps; only measurements need that.
void specialization_count_steps(struct specialization *s, bool on);

// Returns *s with one more bit of a constant, and with all changes that follow from it, as if the
// scene needed that bit. constant: CONSTANT_FEATURES, _GEOMETRY, _PARTS, _LOBES or _EMITTERS.
struct specialization specialization_with(const struct specialization *s, uint32_t constant,
                                          uint32_t bit);

bool specialization_needs_kernel(const struct specialization *s, enum kernel_id id);
// Returns whether the buffer with this binding is needed; if it is not, it is not created.
bool specialization_needs_binding(const struct specialization *s, uint32_t binding);
// Returns a name such as "spheres"; NULL if the value is not the bit of one feature.
const char *feature_name(uint32_t bit);
const char *geometry_name(uint32_t bit);
const char *lobe_name(uint32_t bit);
const char *emitter_name(uint32_t bit);

#endif
