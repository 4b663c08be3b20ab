// Runs one traversal kernel on given rays: for benchmarks, and for tests against a reference.
#ifndef LAMPYRIS_RENDER_PROBE_RAY_PROBE_H
#define LAMPYRIS_RENDER_PROBE_RAY_PROBE_H

#include "render/render.h"

struct probe_ray {
    float origin[3];
    float direction[3]; // unit for intersect_closest; up to the segment's end for intersect_shadow
    bool leaves;        // the ray starts on primitive `from` of `from_instance`, numbered as in
                        // struct probe_hit
    uint32_t from, from_instance;
};

struct probe_hit {
    float t, u, v;
    uint32_t primitive; // index into the flat scene's triangles, or PRIMITIVE_SHAPE | shape;
                        // NO_PRIMITIVE: none. intersect_shadow: 0 for any hit
    uint32_t instance;  // index into the flat scene's instances, or NO_INSTANCE
};

// Traces count rays, at most plan.wave_slots. kernel: KERNEL_intersect_closest or
// KERNEL_intersect_shadow. `hits` may be NULL. *ms: time of the dispatches on the device, in
// milliseconds; 0 without timestamps. *complete: false if a ray exceeded its iteration budget. The
// film is unchanged.
bool ray_probe_trace(struct renderer *renderer, enum kernel_id kernel, const struct probe_ray *rays,
                     uint32_t count, struct probe_hit *hits, double *ms, bool *complete,
                     struct err *err);

#endif
