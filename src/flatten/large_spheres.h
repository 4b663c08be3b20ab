// Which scenes have spheres that need more digits than a float has.
#ifndef LAMPYRIS_FLATTEN_LARGE_SPHERES_H
#define LAMPYRIS_FLATTEN_LARGE_SPHERES_H

#include "flatten/flatten.h"

// Points on a sphere that single precision alone finds are off by up to 14 roundings of its radius
// (lib/shape_surface.glsl), some 1e-6 of it. A sphere is large where that is more than a thousandth
// of what there is to see next to it: of the distance from the camera to its surface, of the
// smallest other shape's size, or of the extent of all triangles. Then all spheres' crossings are
// found with twice the digits (lib/large_sphere.glsl).
bool has_large_spheres(const struct flat_scene *flat, const struct camera *camera);

// The two parts of the answer: wherever the camera is, which takes as long as there are triangles,
// and because of where it is.
bool has_large_spheres_anyway(const struct flat_scene *flat);
bool is_close_to_large_sphere(const struct flat_scene *flat, const struct camera *camera);

#endif
