// Who is right where a kernel and the reference disagree: every primitive is looked at in double
// precision, with bounds of the error that the kernel's single-precision arithmetic may make.
#ifndef LAMPYRIS_TESTS_TRAVERSAL_JUDGE_H
#define LAMPYRIS_TESTS_TRAVERSAL_JUDGE_H

#include "bvh_trace.h"
#include "flatten/flatten.h"
#include "render/probe/ray_probe.h"

// The CPU reference on a renderer's own geometry.
struct reference {
    const struct flat_scene *flat;
    struct bvh_box *boxes; // boxes of the shapes
    struct bvh_trace_instance *instances;
    struct bvh_params geometry;
    struct bvh_trace_scene scene;
};

// Memory comes from `arena`; *out must stay where it is. False when out of memory.
bool reference_create(const struct renderer *r, struct arena *arena, struct reference *out);
// The hit that the kernels should find, within the error of a triangle that is neither a sliver nor
// seen edge-on: some 16 roundings of the largest coordinate relative to the ray's origin.
bool reference_agrees(const struct reference *reference, const struct bvh_ray *ray,
                      const struct probe_hit *result, double extent);
struct bvh_ray reference_ray(const struct probe_ray *ray, double t_max);

// True when no exact arithmetic within the kernel's error bounds contradicts the result: the
// primitive may be hit at that distance, and none is hit for certain before it.
bool judge_closest(const struct flat_scene *flat, const struct probe_ray *ray,
                   const struct probe_hit *hit);
bool judge_occluded(const struct flat_scene *flat, const struct probe_ray *ray, bool occluded);

#endif
