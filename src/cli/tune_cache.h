// The file in the user's cache folder that keeps which sizes of waves and of workgroups were found
// to be the fastest, by device, driver and kernels. `bench --tune` writes it; what renders reads
// it.
#ifndef LAMPYRIS_CLI_TUNE_CACHE_H
#define LAMPYRIS_CLI_TUNE_CACHE_H

#include "base/arena.h"
#include "base/err.h"
#include "base/file_lock.h"
#include "gpu/gpu.h"
#include <jansson.h>

// 0: the device's default, which nothing was found to be faster than, or nothing is known.
struct tuned {
    uint32_t wave, workgroup;
};
json_t *tuned_size_json(uint32_t size); // null for 0

struct tune_cache {
    struct arena arena;
    const char *path; // NULL: neither XDG_CACHE_HOME nor HOME says where
    json_t *devices;  // array of what is kept; NULL: nothing
    struct file_lock lock;
};

// Reads what is there. Never fails: a file that cannot be used is one warning, and none at all is
// no matter. *out is to be finished.
void tune_cache_load(struct tune_cache *out);
void tune_cache_finish(struct tune_cache *cache); // accepts {0}

// What is kept for this device, its driver and the kernels of this program.
struct tuned tune_cache_find(const struct tune_cache *cache, const struct gpu *gpu);

// Creates the folder, locks the file and finds out whether it can be written, then reads it:
// instead of tune_cache_load, before work is done that is to be kept. ERR_OUTPUT.
bool tune_cache_open(struct tune_cache *out, struct err *err);
// Keeps `tuned` for the device, instead of what there was, and besides it what "about" says of how
// it was found (an object, whose reference is taken over; NULL is out of memory). What is kept for
// other devices stays. The cache must have been opened.
bool tune_cache_keep(struct tune_cache *cache, const struct gpu *gpu, struct tuned tuned,
                     json_t *about, struct err *err);

#endif
