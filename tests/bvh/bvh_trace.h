// The reference in double precision: closest hit, any hit and brute force, on the CPU.
#ifndef LAMPYRIS_TESTS_BVH_TRACE_H
#define LAMPYRIS_TESTS_BVH_TRACE_H

#include "bvh/bvh.h"

struct bvh_ray {
    double origin[3];
    double direction[3];         // any length > 0
    double t_max;                // hits have 0 < t < t_max, in units of direction's length
    uint32_t ignore[2];          // primitives not to hit; see bvh_hit.primitive. UINT32_MAX: none
    uint32_t ignore_instance[2]; // that they are of, plus 1; 0: of the world
};

struct bvh_hit {
    double t;
    double u, v; // barycentrics of corners 1 and 2 (triangles); 0 for shapes
    // Triangle: its index as given (not leaf order). Shape: BVH_LEAF_SHAPE | index.
    uint32_t primitive; // UINT32_MAX: no hit
    uint32_t instance;  // that it is of; UINT32_MAX: of the world
    uint32_t nodes_visited, primitives_tested;
};

// A shape test supplied by the caller: the nearest t in (0, t_max) or a negative number.
typedef double (*bvh_shape_fn)(const void *context, uint32_t shape, const struct bvh_ray *ray);

// The place that an instance's leaf leads to.
struct bvh_trace_instance {
    double to_object[3][4]; // from the world to the tree's space, as exact as is known
    uint32_t root;
    uint32_t first_triangle, triangle_count; // the tree's: for bvh_trace_brute_force() alone
};

struct bvh_trace_scene {
    const struct bvh *bvh;
    // The geometry in world space; with all triangles, it includes those of shared trees.
    // triangle_count is that of world space. Without instance_boxes hits are not checked against
    // these.
    const struct bvh_params *geometry;
    const struct bvh_trace_instance *instances; // NULL when there are none
    bvh_shape_fn intersect_shape;               // NULL when there are none
    const void *shape_context;
};

// In double precision on the single-precision vertices (watertight test of Woop, Benthin, Wald
// 2013, two-sided), to whose spaces rays are transformed without normalising: t is the same in all.
// Of hits with equal t the lowest primitive wins, triangles before shapes; the world's before those
// of instances, and these in their order. All three agree on every ray, bit for bit, also where
// rounding decides. Without a hit t is t_max.
void bvh_trace_closest(const struct bvh_trace_scene *scene, const struct bvh_ray *ray,
                       struct bvh_hit *hit);
bool bvh_trace_any(const struct bvh_trace_scene *scene, const struct bvh_ray *ray);
// Traces without the BVH: the yardstick of the yardstick.
void bvh_trace_brute_force(const struct bvh_trace_scene *scene, const struct bvh_ray *ray,
                           struct bvh_hit *hit);

#endif
