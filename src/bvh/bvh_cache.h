// Hierarchies kept in a folder, to be loaded where they would be built again. A file is named by a
// hash of all that the hierarchy depends on (vertices, boxes, method), so it is never out of date,
// and whoever needs room may remove it. What a file says is checked as far as a wrong picture, or
// worse, could come of it: one that is damaged, or another program's, is refused with a warning,
// and replaced.
#ifndef LAMPYRIS_BVH_BVH_CACHE_H
#define LAMPYRIS_BVH_BVH_CACHE_H

#include "bvh/bvh.h"

// Hierarchies of fewer primitives are built faster than a file is found, and not kept.
#define BVH_CACHE_LEAST 4096u

struct bvh_cache {
    const char *folder;     // made if its parent is there; NULL: nothing is kept
    bool is_unwritable;     // said so once, and not tried again
    uint32_t loaded, saved; // so far
};

// Builds as bvh_build() does. A folder that cannot be read or written is a warning. Several
// processes may use one folder at a time: files come into being whole.
bool bvh_build_cached(struct bvh_cache *cache, const struct bvh_params *params, struct arena *arena,
                      struct bvh *out, struct err *err);

// The parts of bvh_build_cached(). Loading fails with ERR_INPUT where a file is refused, with
// ERR_NONE where there is none.
bool bvh_cache_save(const char *path, const struct bvh_params *params, const struct bvh *bvh,
                    struct err *err);
bool bvh_cache_load(const char *path, const struct bvh_params *params, struct arena *arena,
                    struct bvh *out, struct err *err);
// Where the file of a hierarchy is. NULL when out of memory.
char *bvh_cache_path(const char *folder, const struct bvh_params *params, struct arena *arena);

#endif
