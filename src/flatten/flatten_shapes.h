// The part of scene_flatten() for analytic shapes. Private to this folder, except for
// flat_shape_box(), flatten_place_shape() and FLAT_COORDINATE_MAX.
#ifndef LAMPYRIS_FLATTEN_FLATTEN_SHAPES_H
#define LAMPYRIS_FLATTEN_FLATTEN_SHAPES_H

#include "flatten/flatten.h"

// Appends all visible shapes to out->shapes, which has room, and adds those of finite extent to the
// bounds. Shapes that are too small for their distance from the origin are added to `coarse`.
struct coarse_objects;
bool flatten_shapes(const struct flatten_params *params, struct flat_scene *out,
                    struct coarse_objects *coarse, struct err *err);

// Computes a box that contains all points of the shape that the kernels may hit.
void flat_shape_box(const struct flat_shape *shape, float min[3], float max[3]);

// Returns a shape of the scene in the arrays' coordinates and unit, before rounding.
struct shape flatten_place_shape(const struct flat_scene *flat, const struct shape *shape);

// The limit of the kernels' coordinates in any unit. Their squares are finite in single precision.
#define FLAT_COORDINATE_MAX 1e18

// Adds the box to the scene's bounds.
void flatten_bound(struct flat_scene *flat, const float low[3], const float high[3]);

#endif
