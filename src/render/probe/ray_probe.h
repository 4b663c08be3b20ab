// Runs one traversal kernel on rays of the caller's choice: for benchmarks, and for tests against a
// reference.
#ifndef LAMPYRIS_RENDER_PROBE_RAY_PROBE_H
#define LAMPYRIS_RENDER_PROBE_RAY_PROBE_H

#include "render/render.h"

struct probe_ray {
    float origin[3];
    float direction[3]; // intersect_closest: unit; intersect_shadow: up to the end of the segment
    bool leaves;        // it starts on a triangle or shape, named as in struct probe_hit
    uint32_t from, from_instance;
};

struct probe_hit {
    float t, u, v;
    uint32_t primitive; // index into the flat scene's triangles, or PRIMITIVE_SHAPE | shape;
                        // NO_PRIMITIVE: none. intersect_shadow: 0 for any hit
    uint32_t instance;  // index into the flat scene's instances, or NO_INSTANCE
};

// Traces count <= plan.wave_slots rays. kernel: KERNEL_intersect_closest or
// KERNEL_intersect_shadow. hits may be NULL. *ms: the time of the dispatch on the device, 0 without
// timestamps. *complete: false if a ray ran out of its budget. The film is unchanged.
bool ray_probe_trace(struct renderer *renderer, enum kernel_id kernel, const struct probe_ray *rays,
                     uint32_t count, struct probe_hit *hits, double *ms, bool *complete,
                     struct err *err);

#endif
