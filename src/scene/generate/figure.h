// Procedural figures (a skull, a dragon, a monkey's head) for tests, benchmarks and images that
// need the size and detail of a scan. A field of smoothly joined parts is converted to a mesh,
// which is subdivided and displaced by scales, sutures, wrinkles and pits. Only correctly rounded
// operations are used, so that the mesh is the same on every machine; below 50000 triangles it also
// depends on the version of meshoptimizer.
#ifndef LAMPYRIS_SCENE_GENERATE_FIGURE_H
#define LAMPYRIS_SCENE_GENERATE_FIGURE_H

#include "scene/core/scene.h"

#define FIGURE_TRIANGLES_MIN 300u
#define FIGURE_TRIANGLES_MAX 20000000u

enum figure { FIGURE_SKULL, FIGURE_DRAGON, FIGURE_MONKEY, FIGURE_COUNT };
extern const char *const figure_names[FIGURE_COUNT + 1]; // ended by NULL
// The numbers of triangles of the scans that the figures replace: 10000, 900000, 500.
extern const uint32_t figure_triangles[FIGURE_COUNT];

// Appends a closed mesh with normals and about `triangles` triangles (FIGURE_TRIANGLES_MIN to
// FIGURE_TRIANGLES_MAX; the result is within a tenth of it). y is up. The heads face +z and are
// about 2 high; the dragon faces +x, is about 4 long and stands on y = 0.
bool generate_figure(struct scene *scene, enum figure figure, uint32_t triangles, uint32_t material,
                     uint32_t *index, struct err *err);
// Returns an upper bound of the memory of the mesh in bytes. Its generation takes more memory.
uint64_t generate_figure_bytes(uint32_t triangles);

#endif
