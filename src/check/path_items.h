// Runs a kernel on items that are stored in the renderer's buffer of paths.
#ifndef LAMPYRIS_CHECK_PATH_ITEMS_H
#define LAMPYRIS_CHECK_PATH_ITEMS_H

#include "render/render.h"

// Replaces the items, of `bytes` bytes each, by the kernel's output. There is one thread per item.
// Items that do not fit into the buffer at once are run in several batches. This changes the
// renderer's push constants, so the renderer must not render any more.
bool path_items_run(struct renderer *renderer, const struct gpu_kernel *kernel, void *items,
                    uint32_t count, size_t bytes, struct err *err);

#endif
