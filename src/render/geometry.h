// From a scene to what kernels trace rays through: flattened, with hierarchies built.
#ifndef LAMPYRIS_RENDER_GEOMETRY_H
#define LAMPYRIS_RENDER_GEOMETRY_H

#include "bvh.h"
#include "flatten.h"

struct geometry_params {
    const struct scene *scene;
    struct bvh_method bvh;
    enum instancing instancing;
    const char *bvh_cache; // folder in which hierarchies are kept; NULL: none
    const struct progress *progress;
};

// As several renderers share it.
struct geometry {
    struct arena arena;
    struct flat_scene flat;
    struct bvh bvh;
    double flatten_seconds;
};
bool geometry_create(const struct geometry_params *params, struct geometry *out, struct err *err);
void geometry_finish(struct geometry *geometry); // accepts NULL and {0}
// After materials or lights changed, but no place and no visibility of anything: flattens anew and
// keeps the hierarchy. No renderer may use it meanwhile, and those that did are to be created anew.
// A failure leaves the geometry finished.
bool geometry_refresh(const struct geometry_params *params, struct geometry *geometry,
                      struct err *err);

// Results live in `arena`. *bvh is of the world, whose leaves lead to instances too, and of every
// shared mesh: one array of nodes, and one order of all flat triangles.
bool geometry_prepare(const struct geometry_params *params, struct arena *arena,
                      struct flat_scene *flat, struct bvh *bvh, struct err *err);

#endif
