// Bounds of what a scene places in the world, in double precision.
#ifndef LAMPYRIS_SCENE_CORE_BOUNDS_H
#define LAMPYRIS_SCENE_CORE_BOUNDS_H

#include "scene/core/scene.h"

// A run of instances and one of shapes.
struct scene_part {
    uint32_t first_instance, instance_count;
    uint32_t first_shape, shape_count;
};

struct bounds {
    double min[3], max[3]; // min > max when empty
};

extern const struct bounds BOUNDS_EMPTY;

struct scene_part scene_whole(const struct scene *scene);

// Position of a vertex in its mesh's space, as exact as is known.
void mesh_vertex(const struct mesh *mesh, uint32_t vertex, double out[3]);

void bounds_add_point(struct bounds *bounds, const double point[3]);
// Planes, which have no end, have no bounds.
void bounds_add_shape(struct bounds *bounds, const struct shape *shape);
// How far a shape reaches from its centre along each axis; false where that is without end.
bool shape_reach(const struct shape *shape, double reach[3]);
// From its centre along n, which may have any length: the largest n.(v - centre) of its points v.
double shape_extent(const struct shape *shape, const double n[3]);
bool bounds_is_empty(const struct bounds *bounds);
bool bounds_are_a_point(const struct bounds *bounds); // or empty

// Vertices that no triangle uses do not count. When scene->progress asks to stop, these two do,
// with part of the result: ask it again afterwards.
struct bounds bounds_of_part(const struct scene *scene, const struct scene_part *part);
// For each normal n the largest n.v of the part's points v; -INFINITY when it is empty. Planes do
// not count.
void bounds_support(const struct scene *scene, const struct scene_part *part, uint32_t count,
                    const double (*normals)[3], double *out);
// The largest distance from `center` to anything in the part; 0 when that is empty.
double bounds_radius(const struct scene *scene, const struct scene_part *part,
                     const double center[3]);

#endif
