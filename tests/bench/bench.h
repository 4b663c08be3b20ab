// Shared by the parts of bench_intersect: the rays of a scene, and Embree, with which the tracing
// is compared.
#ifndef LAMPYRIS_TESTS_BENCH_H
#define LAMPYRIS_TESTS_BENCH_H

#include "flatten/flatten.h"
#include "render/probe/ray_probe.h"

enum ray_kind { RAYS_PRIMARY, RAYS_DIFFUSE, RAYS_SHADOW, RAY_KINDS };

// The tracer of Embree. All rays of a call are traced on `threads` threads.
struct yardstick;
// returns NULL on failure
struct yardstick *yardstick_create(const struct flat_scene *flat, unsigned threads);
void yardstick_destroy(struct yardstick *y);
// Returns the time in seconds. For shadow rays, primitive 0 means any hit.
double yardstick_trace(struct yardstick *y, bool shadow, const struct probe_ray *rays,
                       uint32_t count, struct probe_hit *hits);

// Makes camera rays in the order of generate_rays, with the `samples` rays of a pixel adjacent.
void rays_primary(const struct camera *camera, const double origin[3], uint32_t width,
                  uint32_t height, uint32_t samples, struct probe_ray *rays);
// Makes rays from the hits of `from`: with cosine-distributed directions about the normal, or
// segments to random points of the light, which is a parallelogram. Rays without a hit give none.
// Returns the number of rays.
uint32_t rays_diffuse(const struct flat_scene *flat, const struct probe_ray *from,
                      const struct probe_hit *hits, uint32_t count, struct probe_ray *rays);
uint32_t rays_shadow(const struct flat_scene *flat, const struct probe_ray *from,
                     const struct probe_hit *hits, uint32_t count, const float light[3][3],
                     struct probe_ray *rays);

#endif
