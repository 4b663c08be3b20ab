// Decides whether a scene has spheres that need more than single precision.
#ifndef LAMPYRIS_FLATTEN_LARGE_SPHERES_H
#define LAMPYRIS_FLATTEN_LARGE_SPHERES_H

#include "flatten/flatten.h"

// Points on a sphere that are computed in single precision have errors of up to 14 roundings of its
// radius (lib/shape_surface.glsl), some 1e-6 of it. A sphere is large if this error exceeds a
// thousandth of a length that is visible next to the sphere: the distance from the camera to its
// surface, the size of the smallest other shape, or the extent of the triangles. Intersections with
// all spheres are then computed with twice the digits (lib/large_sphere.glsl).
bool has_large_spheres(const struct flat_scene *flat, const struct camera *camera);

// The two halves of the test. The first does not depend on the camera and takes time proportional
// to the number of triangles; the second depends on the camera.
bool has_large_spheres_anyway(const struct flat_scene *flat);
bool is_close_to_large_sphere(const struct flat_scene *flat, const struct camera *camera);

#endif
