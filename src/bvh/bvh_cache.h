// Hierarchies stored in a folder, to be loaded instead of built again. A file is named by a hash of
// everything that the hierarchy depends on (vertices, boxes, method), so it is never out of date,
// and may be deleted at any time. A file is validated as far as it could cause a wrong image, or
// worse: one that is damaged, or another program's, is rejected with a warning, and replaced.
#ifndef LAMPYRIS_BVH_BVH_CACHE_H
#define LAMPYRIS_BVH_BVH_CACHE_H

#include "bvh/bvh.h"

// Hierarchies of fewer primitives are built faster than a file is found, and are not stored.
#define BVH_CACHE_LEAST 4096u

struct bvh_cache {
    const char *folder;     // made if its parent is there; NULL: nothing is kept
    bool is_unwritable;     // said so once, and not tried again
    uint32_t loaded, saved; // so far
};

// Builds as bvh_build() does. A folder that cannot be read or written causes a warning. Several
// processes may use one folder at the same time: files are created atomically.
bool bvh_build_cached(struct bvh_cache *cache, const struct bvh_params *params, struct arena *arena,
                      struct bvh *out, struct err *err);

// The parts of bvh_build_cached(). Loading fails with ERR_INPUT if a file is rejected, with
// ERR_NONE if there is none.
bool bvh_cache_save(const char *path, const struct bvh_params *params, const struct bvh *bvh,
                    struct err *err);
bool bvh_cache_load(const char *path, const struct bvh_params *params, struct arena *arena,
                    struct bvh *out, struct err *err);
// Returns the path of a hierarchy's file. NULL when out of memory.
char *bvh_cache_path(const char *folder, const struct bvh_params *params, struct arena *arena);

#endif
