// From a scene to what kernels trace rays through: flattened, with hierarchies built.
#ifndef LAMPYRIS_FLATTEN_GEOMETRY_H
#define LAMPYRIS_FLATTEN_GEOMETRY_H

#include "bvh/bvh.h"
#include "flatten/flatten.h"

struct geometry_params {
    const struct scene *scene;
    struct bvh_method bvh;
    enum instancing instancing;
    const char *bvh_cache; // folder in which hierarchies are kept; NULL: none
    const struct progress *progress;
    const struct camera *camera; // see struct flatten_params
};

// Geometry that several renderers may share.
struct geometry {
    struct arena flat_arena, bvh_arena;
    struct flat_scene flat;
    struct bvh bvh;
    struct bvh_method method; // by which it was built
    uint64_t key;             // flatten_key() of what was flattened
    double flatten_seconds;   // the last time; the hierarchy's are in its statistics
};
bool geometry_create(const struct geometry_params *params, struct geometry *out, struct err *err);
void geometry_finish(struct geometry *geometry); // accepts NULL and {0}
// After anything in the scene changed but its meshes' own arrays: does nothing where flattening
// would make the same (flatten_key), else flattens anew, and keeps the hierarchy where all that it
// is made of has the same bits as before. So it is when materials or lights changed, but for one
// that makes a shared mesh emit; not when something was moved or hidden. No renderer may use the
// geometry meanwhile, and those that did are to be created anew. A failure leaves the geometry
// finished.
bool geometry_refresh(const struct geometry_params *params, struct geometry *geometry,
                      struct err *err);

// Results live in `arena`. *bvh is of the world, whose leaves lead to instances too, and of every
// shared mesh: one array of nodes, and one order of all flat triangles.
bool geometry_prepare(const struct geometry_params *params, struct arena *arena,
                      struct flat_scene *flat, struct bvh *bvh, struct err *err);

#endif
