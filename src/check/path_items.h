// Running a kernel of the check's own on items that stand in the buffer of paths.
#ifndef LAMPYRIS_CHECK_PATH_ITEMS_H
#define LAMPYRIS_CHECK_PATH_ITEMS_H

#include "render/render.h"

// Replaces the items, of so many bytes each, by what the kernel makes of them: one thread an item,
// as many at a time as the buffer holds and a wave has threads. The renderer's push constants are
// changed; it is not to render any more.
bool path_items_run(struct renderer *renderer, const struct gpu_kernel *kernel, void *items,
                    uint32_t count, size_t bytes, struct err *err);

#endif
