// Places an instance's triangles in the arrays' coordinates, before rounding. Part of flatten.c.
#ifndef LAMPYRIS_FLATTEN_FLATTEN_PLACEMENT_H
#define LAMPYRIS_FLATTEN_FLATTEN_PLACEMENT_H

#include "flatten/flatten.h"

// An instance's transform, prepared for its triangles.
struct placement {
    const struct mesh *mesh;
    const struct instance *instance;
    double origin[3];     // origin of the flat scene
    double scale;         // scale of the flat scene
    double normals[3][3]; // inverse transpose up to a positive factor
    bool is_mirrored;
};

struct placement placement_create(const struct scene *scene, const struct instance *instance,
                                  const double origin[3], double scale);
void placement_vertex(const struct placement *placement, uint32_t vertex, double out[3]);
void placement_corners(const struct placement *placement, uint32_t triangle, double corners[3][3]);

#endif
