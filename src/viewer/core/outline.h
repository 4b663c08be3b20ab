// Computes the outline of an object in the image: the convex hull of its bounds' projection.
#ifndef LAMPYRIS_VIEWER_CORE_OUTLINE_H
#define LAMPYRIS_VIEWER_CORE_OUTLINE_H

#include "scene/core/bounds.h"
#include "scene/core/scene.h"

#define OUTLINE_POINTS_MAX 1024u

struct outline {
    // Corners in order, as fractions of the image's width and height from its upper left corner.
    // They may be outside of the image.
    double points[OUTLINE_POINTS_MAX][2];
    uint32_t count; // 0: there is no outline
};

// Computes the bounds of a mesh in its own space, from all of its vertices.
struct bounds outline_mesh_bounds(const struct mesh *mesh);
// Computes the outline of an object. `bounds` are those of its mesh if it is an instance. `aspect`
// is the width of the image divided by its height. There is no outline for infinite planes, for
// panoramic cameras, and for objects behind the camera.
void outline_of_object(const struct scene *scene, uint32_t object, const struct bounds *bounds,
                       const struct camera *camera, double aspect, struct outline *out);
// Clips a line to a rectangle: left, top, right, bottom. Returns false if no part is inside.
bool outline_clip(const double rect[4], double from[2], double to[2]);

#endif
