// Bounds of a scene's objects in world space, in double precision.
#ifndef LAMPYRIS_SCENE_CORE_BOUNDS_H
#define LAMPYRIS_SCENE_CORE_BOUNDS_H

#include "scene/core/scene.h"

// Part of a scene: a range of instances and a range of shapes.
struct scene_part {
    uint32_t first_instance, instance_count;
    uint32_t first_shape, shape_count;
};

struct bounds {
    double min[3], max[3]; // min > max if empty
};

extern const struct bounds BOUNDS_EMPTY;

struct scene_part scene_whole(const struct scene *scene);

// Gets the position of a vertex in its mesh's space, from the exact positions if the mesh has them.
void mesh_vertex(const struct mesh *mesh, uint32_t vertex, double out[3]);

void bounds_add_point(struct bounds *bounds, const double point[3]);
// Adds the bounding box of a shape. Planes are infinite and add nothing.
void bounds_add_shape(struct bounds *bounds, const struct shape *shape);
// Computes how far a shape extends from its centre along each axis of the world. Returns false if
// the shape is infinite.
bool shape_reach(const struct shape *shape, double reach[3]);
// Returns the largest n.(v - centre) over the points v of the shape; n may have any length.
double shape_extent(const struct shape *shape, const double n[3]);
bool bounds_is_empty(const struct bounds *bounds);
bool bounds_are_a_point(const struct bounds *bounds); // also true for empty bounds

// Computes the bounds of a part, without vertices that no triangle uses. If scene->progress asks to
// stop, this and the two functions below return an incomplete result, and the caller must ask
// scene->progress afterwards.
struct bounds bounds_of_part(const struct scene *scene, const struct scene_part *part);
// Computes for each normal n the largest n.v over the points v of the part; -INFINITY if the part
// is empty. Planes are ignored.
void bounds_support(const struct scene *scene, const struct scene_part *part, uint32_t count,
                    const double (*normals)[3], double *out);
// Returns the largest distance from `center` to any point of the part; 0 if the part is empty.
double bounds_radius(const struct scene *scene, const struct scene_part *part,
                     const double center[3]);

#endif
