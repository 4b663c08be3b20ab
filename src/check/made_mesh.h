// Meshes and images that cases make up, which the text of a scene cannot say.
#ifndef LAMPYRIS_CHECK_MADE_MESH_H
#define LAMPYRIS_CHECK_MADE_MESH_H

#include "scene/core/scene.h"

// Adds a mesh of so many triangles whose vertices are their own, all at the origin so far, and one
// instance of it at the same coordinates, the scene's last. Of the scene's first material. NULL
// when out of memory.
struct mesh *made_mesh_add(struct scene *scene, uint32_t triangles, struct err *err);
void made_mesh_set(struct mesh *mesh, uint32_t vertex, double x, double y, double z);

// The same for a square of two triangles at height y, from -side to side along x and z; NULL
// likewise.
struct mesh *made_mesh_add_square(struct scene *scene, double side, double y, struct err *err);
// For a cube from -side to side, its faces wound outwards.
struct mesh *made_mesh_add_cube(struct scene *scene, double side, struct err *err);

// Gives the mesh a further material: black, and emitting so much of (1, 2, 4).
bool made_mesh_blacken(struct scene *scene, struct mesh *mesh, double emission, struct err *err);

#endif
