// Shared by the parts of bench_intersect: a scene's rays, and a yardstick for tracing them.
#ifndef LAMPYRIS_TESTS_BENCH_H
#define LAMPYRIS_TESTS_BENCH_H

#include "flatten/flatten.h"
#include "render/probe/ray_probe.h"

enum ray_kind { RAYS_PRIMARY, RAYS_DIFFUSE, RAYS_SHADOW, RAY_KINDS };

// The yardstick. All rays of a call are traced on `threads` threads.
struct yardstick;
struct yardstick *yardstick_create(const struct flat_scene *flat, unsigned threads); // or NULL
void yardstick_destroy(struct yardstick *y);
// Returns seconds. Hits of shadow rays: primitive 0 for any hit.
double yardstick_trace(struct yardstick *y, bool shadow, const struct probe_ray *rays,
                       uint32_t count, struct probe_hit *hits);

// Camera rays in the order in which generate_rays makes them (`samples` of a pixel adjacent).
void rays_primary(const struct camera *camera, const double origin[3], uint32_t width,
                  uint32_t height, uint32_t samples, struct probe_ray *rays);
// From hits of `from`: cosine-distributed directions about the normal, or segments to random points
// of the light (a parallelogram). Rays that hit nothing give none; returns how many there are.
uint32_t rays_diffuse(const struct flat_scene *flat, const struct probe_ray *from,
                      const struct probe_hit *hits, uint32_t count, struct probe_ray *rays);
uint32_t rays_shadow(const struct flat_scene *flat, const struct probe_ray *from,
                     const struct probe_hit *hits, uint32_t count, const float light[3][3],
                     struct probe_ray *rays);

#endif
