// Prepares a scene for tracing rays: flattens it and builds the hierarchies.
#ifndef LAMPYRIS_FLATTEN_GEOMETRY_H
#define LAMPYRIS_FLATTEN_GEOMETRY_H

#include "bvh/bvh.h"
#include "flatten/flatten.h"

struct geometry_params {
    const struct scene *scene;
    struct bvh_method bvh;
    enum instancing instancing;
    const char *bvh_cache; // folder of the cache of hierarchies; NULL: none
    const struct progress *progress;
    const struct camera *camera; // see struct flatten_params
};

// Geometry that several renderers may share.
struct geometry {
    struct arena flat_arena, bvh_arena;
    struct flat_scene flat;
    struct bvh bvh;
    struct bvh_method method; // method of the build
    uint64_t key;             // flatten_key() of the flattened scene
    double flatten_seconds;   // time of the last flattening; bvh.stats has the build time
};
bool geometry_create(const struct geometry_params *params, struct geometry *out, struct err *err);
void geometry_finish(struct geometry *geometry); // accepts NULL and {0}
// Must be called after any change of the scene; meshes' own arrays must not change. Does nothing if
// flattening would give the same result (flatten_key); otherwise flattens again, and keeps the
// hierarchy if all of its input has the same bits as before. That is so if only materials or lights
// changed, unless a shared mesh now emits, but not if objects were moved or hidden. No renderer may
// use the geometry meanwhile, and renderers that did must be created again. On failure the geometry
// is finished.
bool geometry_refresh(const struct geometry_params *params, struct geometry *geometry,
                      struct err *err);

// Prepares the geometry in `arena`. *bvh contains the tree of the world, whose leaves may lead to
// instances, and the trees of all shared meshes: one array of nodes, and one order of all flat
// triangles.
bool geometry_prepare(const struct geometry_params *params, struct arena *arena,
                      struct flat_scene *flat, struct bvh *bvh, struct err *err);

#endif
