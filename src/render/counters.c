#include "render/counters.h"

#include <string.h>

uint64_t queue_offset(const struct renderer *r, uint32_t queue)
{
    uint32_t below = r->specialization.queues & ((1u << queue) - 1u);
    uint64_t row = r->plan.wave_slots * sizeof(uint32_t);
    return QUEUES_OFFSET + (uint64_t)__builtin_popcount(below) * row;
}

bool counters_create(struct renderer *r, struct err *err)
{
    return r->buffers[BINDING_QUEUES].mapped || r->counters_copy.handle ||
           gpu_buffer_create(r->gpu, "counters read back", sizeof *r->counters, GPU_READBACK, false,
                             &r->counters_copy, err);
}

void counters_finish(struct renderer *r)
{
    gpu_buffer_finish(r->gpu, &r->counters_copy);
}

void counters_record_copy(struct renderer *r)
{
    if (r->counters_copy.handle)
        gpu_copy(r->gpu, &r->commands, &r->buffers[BINDING_QUEUES], 0, &r->counters_copy, 0,
                 sizeof *r->counters);
}

void counters_read(struct renderer *r)
{
    const struct gpu_buffer *live = &r->buffers[BINDING_QUEUES];
    memcpy(r->counters, live->mapped ? live->mapped : r->counters_copy.mapped, sizeof *r->counters);
}

bool counters_write(struct renderer *r, struct err *err)
{
    return gpu_upload(r->gpu, &r->buffers[BINDING_QUEUES], 0, r->counters, sizeof *r->counters,
                      err);
}

bool counters_clear(struct renderer *r, struct err *err)
{
    static const uint32_t none[SORT_KEYS];
    memset(r->counters, 0, sizeof *r->counters);
    return counters_write(r, err) &&
           (!r->specialization.sort_rays ||
            gpu_upload(r->gpu, &r->buffers[BINDING_SORT], offsetof(struct gpu_sort, count), none,
                       sizeof none, err));
}
