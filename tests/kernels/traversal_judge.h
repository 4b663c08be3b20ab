// Decides whether a kernel or the reference is correct if they disagree: every primitive is tested
// in double precision, with bounds of the errors that single precision may cause in the kernel.
#ifndef LAMPYRIS_TESTS_TRAVERSAL_JUDGE_H
#define LAMPYRIS_TESTS_TRAVERSAL_JUDGE_H

#include "bvh_trace.h"
#include "flatten/flatten.h"
#include "render/probe/ray_probe.h"

// The CPU reference for a renderer's own geometry.
struct reference {
    const struct flat_scene *flat;
    struct bvh_box *boxes; // boxes of the shapes
    struct bvh_trace_instance *instances;
    struct bvh_params geometry;
    struct bvh_trace_scene scene;
};

// Creates the reference. Memory is taken from `arena`; *out must not be moved. Returns false when
// out of memory.
bool reference_create(const struct renderer *r, struct arena *arena, struct reference *out);
// Returns whether the hit is that of the reference, within the error for a triangle that is neither
// a sliver nor seen edge-on: about 16 rounding errors of the largest coordinate relative to the
// ray's origin.
bool reference_agrees(const struct reference *reference, const struct bvh_ray *ray,
                      const struct probe_hit *result, double extent);
struct bvh_ray reference_ray(const struct probe_ray *ray, double t_max);

// Return true if no exact arithmetic within the kernel's error bounds contradicts the result: the
// primitive may be hit at that distance, and no primitive is certainly hit before it.
bool judge_closest(const struct flat_scene *flat, const struct probe_ray *ray,
                   const struct probe_hit *hit);
bool judge_occluded(const struct flat_scene *flat, const struct probe_ray *ray, bool occluded);

#endif
