// The CPU reference in double precision: closest hit, any hit and brute force.
#ifndef LAMPYRIS_TESTS_BVH_TRACE_H
#define LAMPYRIS_TESTS_BVH_TRACE_H

#include "bvh/bvh.h"

struct bvh_ray {
    double origin[3];
    double direction[3];         // any length > 0
    double t_max;                // hits have 0 < t < t_max, in units of direction's length
    uint32_t ignore[2];          // primitives that must not be hit, see bvh_hit.primitive;
                                 // UINT32_MAX: none
    uint32_t ignore_instance[2]; // the instance of each of them plus 1; 0: world space
};

struct bvh_hit {
    double t;
    double u, v; // barycentrics of corners 1 and 2 (triangles); 0 for shapes
    // For a triangle its index in the input, not in leaf order; for a shape BVH_LEAF_SHAPE | index.
    uint32_t primitive; // UINT32_MAX: no hit
    uint32_t instance;  // index of the instance that was hit; UINT32_MAX: none
    uint32_t nodes_visited, primitives_tested;
};

// Intersects a shape. Returns the nearest t in (0, t_max), or a negative number.
typedef double (*bvh_shape_fn)(const void *context, uint32_t shape, const struct bvh_ray *ray);

// The tree to which an instance's leaf leads.
struct bvh_trace_instance {
    double to_object[3][4]; // from world space to the tree's space, as accurate as known
    uint32_t root;
    uint32_t first_triangle, triangle_count; // the tree's triangles; only for
                                             // bvh_trace_brute_force()
};

struct bvh_trace_scene {
    const struct bvh *bvh;
    // The geometry in world space. Its list of triangles also contains those of shared trees;
    // triangle_count is the number of those in world space. If it has no instance_boxes, hits are
    // not tested against these.
    const struct bvh_params *geometry;
    const struct bvh_trace_instance *instances; // NULL: there are none
    bvh_shape_fn intersect_shape;               // NULL: there are no shapes
    const void *shape_context;
};

// These functions compute in double precision with the vertices in single precision, by the
// watertight, two-sided test of Woop, Benthin, Wald 2013. Rays are transformed to the space of an
// instance without normalisation, so that t is the same in all spaces. Of hits with equal t the
// lowest primitive is reported: triangles before shapes, those of world space before those of
// instances, and instances in their order. The three functions agree for every ray, bit for bit,
// even if rounding decides. Without a hit, t is t_max.
void bvh_trace_closest(const struct bvh_trace_scene *scene, const struct bvh_ray *ray,
                       struct bvh_hit *hit);
bool bvh_trace_any(const struct bvh_trace_scene *scene, const struct bvh_ray *ray);
// Traces without the BVH, to test the functions above.
void bvh_trace_brute_force(const struct bvh_trace_scene *scene, const struct bvh_ray *ray,
                           struct bvh_hit *hit);

#endif
