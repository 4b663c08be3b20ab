#include "render/counters.h"

#include <string.h>

bool counters_create(struct renderer *r, struct err *err)
{
    struct gpu_buffer *live = &r->buffers[BINDING_COUNTERS];
    counters_finish(r);
    const struct planned_buffer *planned = &r->plan.buffers[BINDING_COUNTERS];
    return gpu_buffer_create(r->gpu, planned->name, planned->bytes, GPU_DEVICE, false, live, err) &&
           (live->mapped || gpu_buffer_create(r->gpu, "counters read back", sizeof *r->counters,
                                              GPU_READBACK, false, &r->counters_copy, err));
}

void counters_finish(struct renderer *r)
{
    gpu_buffer_finish(r->gpu, &r->buffers[BINDING_COUNTERS]);
    gpu_buffer_finish(r->gpu, &r->counters_copy);
}

void counters_record_copy(struct renderer *r)
{
    if (r->counters_copy.handle)
        gpu_copy(r->gpu, &r->commands, &r->buffers[BINDING_COUNTERS], 0, &r->counters_copy, 0,
                 sizeof *r->counters);
}

void counters_read(struct renderer *r)
{
    const struct gpu_buffer *live = &r->buffers[BINDING_COUNTERS];
    memcpy(r->counters, live->mapped ? live->mapped : r->counters_copy.mapped, sizeof *r->counters);
}

bool counters_write(struct renderer *r, struct err *err)
{
    return gpu_upload(r->gpu, &r->buffers[BINDING_COUNTERS], 0, r->counters, sizeof *r->counters,
                      err);
}

bool counters_clear(struct renderer *r, struct err *err)
{
    static const uint32_t none[SORT_KEYS];
    memset(r->counters, 0, sizeof *r->counters);
    return counters_write(r, err) &&
           (!r->specialization.sort_rays ||
            gpu_upload(r->gpu, &r->buffers[BINDING_COUNTERS],
                       sizeof *r->counters + offsetof(struct gpu_sort, count), none, sizeof none,
                       err));
}
