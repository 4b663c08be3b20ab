// Stores hierarchies in a folder, so that they can be loaded instead of built again. A file is
// named by a hash of everything that the hierarchy depends on (vertices, boxes, method), so it is
// never out of date, and may be deleted at any time. A loaded file is fully validated: a damaged
// file, or one of another program, is rejected with a warning, and replaced.
#ifndef LAMPYRIS_BVH_BVH_CACHE_H
#define LAMPYRIS_BVH_BVH_CACHE_H

#include "bvh/bvh.h"

// Hierarchies of fewer primitives are not stored, because building them is faster than finding a
// file.
#define BVH_CACHE_LEAST 4096u

struct bvh_cache {
    const char *folder;     // created if its parent exists; NULL: no cache
    bool is_unwritable;     // set after the first failure to write, which is reported once
    uint32_t loaded, saved; // number of hierarchies so far
};

// As bvh_build(), but tries the cache first. A folder that cannot be read or written causes a
// warning. Several processes may use one folder at the same time, because files are created
// atomically.
bool bvh_build_cached(struct bvh_cache *cache, const struct bvh_params *params, struct arena *arena,
                      struct bvh *out, struct err *err);

// The two halves of bvh_build_cached(). Loading fails with ERR_INPUT if the file is rejected, and
// with ERR_NONE if there is no file.
bool bvh_cache_save(const char *path, const struct bvh_params *params, const struct bvh *bvh,
                    struct err *err);
bool bvh_cache_load(const char *path, const struct bvh_params *params, struct arena *arena,
                    struct bvh *out, struct err *err);
// Returns the path of a hierarchy's file, or NULL when out of memory.
char *bvh_cache_path(const char *folder, const struct bvh_params *params, struct arena *arena);

#endif
