#include "check/path_items.h"

static bool run_part(struct renderer *r, const struct gpu_kernel *kernel, void *items,
                     uint32_t count, size_t bytes, struct err *err)
{
    struct gpu_buffer *buffer = &r->buffers[BINDING_PATHS];
    uint32_t workgroup = r->specialization.workgroup;
    r->push.first_item = 0;
    r->push.part_items = count;
    if (!gpu_upload(r->gpu, buffer, 0, items, count * bytes, err) ||
        !gpu_begin(r->gpu, &r->commands, err))
        return false;
    gpu_bind(r->gpu, &r->commands, &r->bindings[0]);
    gpu_push(r->gpu, &r->commands, &r->push, sizeof r->push);
    gpu_dispatch(r->gpu, &r->commands, kernel, (count + workgroup - 1) / workgroup);
    gpu_barrier(r->gpu, &r->commands);
    return gpu_submit(r->gpu, &r->commands, err) && gpu_wait(r->gpu, &r->commands, err) &&
           gpu_download(r->gpu, buffer, 0, items, count * bytes, err);
}

bool path_items_run(struct renderer *r, const struct gpu_kernel *kernel, void *items,
                    uint32_t count, size_t bytes, struct err *err)
{
    uint32_t most = (uint32_t)(r->buffers[BINDING_PATHS].bytes / bytes);
    bool ok = true;
    for (uint32_t first = 0, part; ok && first < count; first += part) {
        part = count - first < most ? count - first : most;
        ok = run_part(r, kernel, (char *)items + first * bytes, part, bytes, err);
    }
    return ok;
}
