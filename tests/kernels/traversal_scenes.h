// Makes scenes and rays for the tests of the traversal kernels.
#ifndef LAMPYRIS_TESTS_TRAVERSAL_SCENES_H
#define LAMPYRIS_TESTS_TRAVERSAL_SCENES_H

#include "kernel_fixture.h"
#include "render/probe/ray_probe.h"

// --- scenes: added to one that scene_start() made ------------------------------------------------

// Adds triangles in a cube of edge length `extent` about `center`; their corners are up to `size`
// apart.
void add_soup(struct scene *scene, uint32_t count, double extent, double size,
              const double center[3], uint64_t seed);
// Adds triangles with a base of 1 and a height of 1 / aspect in a cube of edge length 2 about the
// origin.
void add_slivers(struct scene *scene, uint32_t count, double aspect, uint64_t seed);
void add_spheres_and_discs(struct scene *scene, uint32_t count, uint64_t seed);
// Adds the closed bumpy sphere of generate.h.
bool add_blob(struct scene *scene, uint32_t triangles, double scale, const double center[3]);
// Loads $LAMPYRIS_DATA/mesh/NAME. Returns false if there is no such file.
bool load_mesh_file(const char *name, struct scene *scene, struct err *err);

// --- rays ----------------------------------------------------------------------------------------

// Makes rays from points around and inside the scene's bounds. In alternation they go in random
// directions, along axes (with zeros of both signs), in coordinate planes, in directions with a
// tiny component, and towards edges: vertices of triangles and midpoints of their edges, and points
// just inside or outside the outlines of shapes.
void random_closest_rays(const struct flat_scene *flat, uint32_t count, uint64_t seed,
                         struct probe_ray *rays);
// Makes segments between random points. Some are along axes, some end at edges, and some are short
// ones through triangles.
void random_shadow_rays(const struct flat_scene *flat, uint32_t count, uint64_t seed,
                        struct probe_ray *rays);
// Returns whether rounding is likely to decide for the ray with this number, of either kind: such
// are rays at edges, and short ones.
bool ray_is_delicate(uint32_t ray);
// Computes the direction from one point to another, a unit vector except for rounding.
void aim(const float from[3], const float to[3], float direction[3]);

#endif
