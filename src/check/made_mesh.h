// Makes meshes for cases, because scene files cannot express them.
#ifndef LAMPYRIS_CHECK_MADE_MESH_H
#define LAMPYRIS_CHECK_MADE_MESH_H

#include "scene/core/scene.h"

// Adds a mesh of `triangles` triangles with unshared vertices, which are all at the origin, and an
// instance of it with the identity transform, which becomes the scene's last instance. The mesh has
// the scene's first material. Returns NULL when out of memory.
struct mesh *made_mesh_add(struct scene *scene, uint32_t triangles, struct err *err);
void made_mesh_set(struct mesh *mesh, uint32_t vertex, double x, double y, double z);

// Adds a mesh of two triangles: a square at height y that extends from -side to side along x and z.
struct mesh *made_mesh_add_square(struct scene *scene, double side, double y, struct err *err);
// Adds a mesh in the form of a cube that extends from -side to side along each axis. Its faces are
// counter-clockwise as seen from outside.
struct mesh *made_mesh_add_cube(struct scene *scene, double side, struct err *err);

// Gives the mesh a new material that is black and emits `emission` times (1, 2, 4).
bool made_mesh_blacken(struct scene *scene, struct mesh *mesh, double emission, struct err *err);

#endif
