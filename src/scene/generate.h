// Procedural meshes for tests and benchmarks that need size without a file.
#ifndef LAMPYRIS_SCENE_GENERATE_H
#define LAMPYRIS_SCENE_GENERATE_H

#include "scene.h"

// Appends a closed, bumpy sphere ("blob") about the origin with mean radius 1, normals included:
// latitude-longitude grid with about `triangles` triangles (at least 8), radius modulated by sums
// of sines so that curvature and triangle size vary. Deterministic.
bool generate_blob(struct scene *scene, uint32_t triangles, uint32_t material, uint32_t *mesh,
                   struct err *err);

#endif
