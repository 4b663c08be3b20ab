// Scenes and rays for the tests of the traversal kernels.
#ifndef LAMPYRIS_TESTS_TRAVERSAL_SCENES_H
#define LAMPYRIS_TESTS_TRAVERSAL_SCENES_H

#include "kernel_fixture.h"
#include "render/probe/ray_probe.h"

// --- scenes: added to one that scene_start() made ------------------------------------------------

// Triangles in a cube of edge `extent` about `center`; their corners are up to `size` apart.
void add_soup(struct scene *scene, uint32_t count, double extent, double size,
              const double center[3], uint64_t seed);
// Triangles of edge 1 and height 1 / aspect in a cube of edge 2 about the origin.
void add_slivers(struct scene *scene, uint32_t count, double aspect, uint64_t seed);
void add_spheres_and_discs(struct scene *scene, uint32_t count, uint64_t seed);
// The closed bumpy sphere of generate.h.
bool add_blob(struct scene *scene, uint32_t triangles, double scale, const double center[3]);
// Loads $LAMPYRIS_DATA/mesh/NAME; false where there is none.
bool load_mesh_file(const char *name, struct scene *scene, struct err *err);

// --- rays ----------------------------------------------------------------------------------------

// Makes rays from points around and inside the scene's bounds. By turns they go in random
// directions, along axes (with zeros of both signs), in planes of two axes, in directions with a
// tiny component, and towards edges: triangles' vertices and midpoints of edges, and points just
// inside or outside the outlines of shapes.
void random_closest_rays(const struct flat_scene *flat, uint32_t count, uint64_t seed,
                         struct probe_ray *rays);
// Segments between random points, among them ones along axes; some end at edges,
// and short ones through triangles.
void random_shadow_rays(const struct flat_scene *flat, uint32_t count, uint64_t seed,
                        struct probe_ray *rays);
// Returns whether rounding may well decide about the ray of that number, of either kind: those at
// edges and the short ones.
bool ray_is_delicate(uint32_t ray);
// Unit direction (but for rounding) from a point to another.
void aim(const float from[3], const float to[3], float direction[3]);

#endif
