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

// Results live in `arena`. *bvh is of the world, whose leaves lead to instances too, and of every
// shared mesh: one array of nodes, and one order of all flat triangles.
bool geometry_prepare(const struct geometry_params *params, struct arena *arena,
                      struct flat_scene *flat, struct bvh *bvh, struct err *err);

#endif
