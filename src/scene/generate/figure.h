// Figures without a file, for tests, benchmarks and pictures that want a scan's size and detail: a
// skull, a dragon, a monkey's head. A field of smoothly joined parts is made a mesh, subdivided and
// displaced by scales, sutures, wrinkles and pits. Only exactly rounded operations are used: the
// same on every machine, and below 50000 triangles with every meshoptimizer of one version.
#ifndef LAMPYRIS_SCENE_GENERATE_FIGURE_H
#define LAMPYRIS_SCENE_GENERATE_FIGURE_H

#include "scene/core/scene.h"

#define FIGURE_TRIANGLES_MIN 300u
#define FIGURE_TRIANGLES_MAX 20000000u

enum figure { FIGURE_SKULL, FIGURE_DRAGON, FIGURE_MONKEY, FIGURE_COUNT };
extern const char *const figure_names[FIGURE_COUNT + 1]; // ended by NULL
// The numbers of triangles of the scans that the figures stand for: 10000, 900000, 500.
extern const uint32_t figure_triangles[FIGURE_COUNT];

// Appends a closed mesh with normals of about `triangles` triangles (FIGURE_TRIANGLES_MIN to _MAX;
// within a tenth). y is up. The heads look along +z and are about 2 high; the dragon looks along
// +x, is about 4 long and stands on y = 0.
bool generate_figure(struct scene *scene, enum figure figure, uint32_t triangles, uint32_t material,
                     uint32_t *index, struct err *err);
uint64_t generate_figure_bytes(uint32_t triangles); // that it takes, with what it needs meanwhile

#endif
