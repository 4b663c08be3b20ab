// Runs a kernel of the check on items that are stored in the buffer of paths.
#ifndef LAMPYRIS_CHECK_PATH_ITEMS_H
#define LAMPYRIS_CHECK_PATH_ITEMS_H

#include "render/render.h"

// Replaces the items, of `bytes` bytes each, by the kernel's output: one thread per item, in
// batches that fit the buffer and a wave. The renderer's push constants are changed, so it must not
// render any more.
bool path_items_run(struct renderer *renderer, const struct gpu_kernel *kernel, void *items,
                    uint32_t count, size_t bytes, struct err *err);

#endif
