#include "single_kernel.h"

#include <string.h>

// What marks a slot whose ray hit nothing: the kernels write hits only.
#define UNTOUCHED NO_PRIMITIVE

static bool upload_closest(struct renderer *r, const struct single_ray *rays, uint32_t count,
                           struct arena *scratch, struct err *err)
{
    struct gpu_path *paths = ARENA_NEW(scratch, struct gpu_path, count);
    if (!paths)
        return err_memory(err, "rays", count * sizeof *paths);
    for (uint32_t i = 0; i < count; i++) {
        memcpy(paths[i].origin, rays[i].origin, sizeof rays[i].origin);
        memcpy(paths[i].direction, rays[i].direction, sizeof rays[i].direction);
        paths[i].ignore = NO_PRIMITIVE;
        paths[i].primitive = UNTOUCHED;
    }
    return gpu_upload(r->gpu, &r->buffers[BINDING_PATHS], 0, paths, count * sizeof *paths, err);
}

// Shadow rays carry a contribution of 1: what arrives in the slot's radiance was not occluded.
static bool upload_shadow(struct renderer *r, const struct single_ray *rays, uint32_t count,
                          struct arena *scratch, struct err *err)
{
    struct gpu_shadow_ray *records = ARENA_NEW(scratch, struct gpu_shadow_ray, count);
    float(*radiance)[4] = arena_alloc(scratch, count, sizeof *radiance);
    if (!records || !radiance)
        return err_memory(err, "rays", count * sizeof *records);
    for (uint32_t i = 0; i < count; i++) {
        memcpy(records[i].origin, rays[i].origin, sizeof rays[i].origin);
        memcpy(records[i].direction, rays[i].direction, sizeof rays[i].direction);
        records[i].ignore_from = records[i].ignore_to = NO_PRIMITIVE;
        records[i].radiance[0] = 1.0f;
    }
    return gpu_upload(r->gpu, &r->buffers[BINDING_RADIANCE], 0, radiance, count * sizeof *radiance,
                      err) &&
           gpu_upload(r->gpu, &r->buffers[BINDING_SHADOW_RAYS], 0, records, count * sizeof *records,
                      err);
}

// The queue holds slots 0 … count - 1, as prepare_dispatch would have left it.
static bool upload_queue(struct renderer *r, uint32_t queue, uint32_t count, struct arena *scratch,
                         struct err *err)
{
    uint32_t *slots = ARENA_NEW(scratch, uint32_t, count);
    if (!slots)
        return err_memory(err, "queue", count * sizeof *slots);
    for (uint32_t i = 0; i < count; i++)
        slots[i] = i;
    uint32_t row = (uint32_t)__builtin_popcount(r->specialization.queues & ((1u << queue) - 1u));
    memset(r->counters, 0, sizeof *r->counters);
    r->counters->dispatch[queue * DISPATCH_PARTS].items = count;
    return gpu_upload(r->gpu, &r->buffers[BINDING_QUEUES],
                      (uint64_t)row * r->plan.wave_slots * sizeof *slots, slots,
                      count * sizeof *slots, err) &&
           gpu_upload(r->gpu, &r->buffers[BINDING_COUNTERS], 0, r->counters, sizeof *r->counters,
                      err);
}

static bool dispatch(struct renderer *r, enum kernel_id kernel, uint32_t queue, uint32_t count,
                     double *ms, struct err *err)
{
    uint32_t workgroup = r->specialization.workgroup;
    struct gpu_commands *commands = &r->commands;
    double ns[GPU_MAX_TIMESTAMPS] = {0};
    r->push.queue = queue;
    r->push.first_item = 0;
    r->push.part_items = count;
    if (!gpu_begin(r->gpu, commands, err))
        return false;
    gpu_bind(r->gpu, commands, &r->bindings[0]);
    gpu_push(r->gpu, commands, &r->push, sizeof r->push);
    gpu_timestamp(r->gpu, commands);
    gpu_dispatch(r->gpu, commands, &r->kernels[kernel], (count + workgroup - 1) / workgroup);
    gpu_barrier(r->gpu, commands);
    gpu_timestamp(r->gpu, commands);
    if (!gpu_submit(r->gpu, commands, err) || !gpu_wait(r->gpu, commands, err) ||
        (r->gpu->has_timestamps && !gpu_timestamps_ns(r->gpu, commands, ns, err)))
        return false;
    *ms = (ns[1] - ns[0]) * 1e-6;
    return gpu_download(r->gpu, &r->buffers[BINDING_COUNTERS], 0, r->counters, sizeof *r->counters,
                        err);
}

static bool download_closest(struct renderer *r, struct single_hit *hits, uint32_t count,
                             struct arena *scratch, struct err *err)
{
    struct gpu_path *paths = ARENA_NEW(scratch, struct gpu_path, count);
    if (!paths)
        return err_memory(err, "hits", count * sizeof *paths);
    if (!gpu_download(r->gpu, &r->buffers[BINDING_PATHS], 0, paths, count * sizeof *paths, err))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t word = paths[i].primitive;
        bool is_shape = word != NO_PRIMITIVE && (word & PRIMITIVE_SHAPE);
        hits[i] = (struct single_hit){paths[i].t, paths[i].u, paths[i].v, word};
        if (word != NO_PRIMITIVE && !is_shape)
            hits[i].primitive = r->bvh.triangle_order[word];
    }
    return true;
}

static bool download_shadow(struct renderer *r, struct single_hit *hits, uint32_t count,
                            struct arena *scratch, struct err *err)
{
    float(*radiance)[4] = arena_alloc(scratch, count, sizeof *radiance);
    if (!radiance)
        return err_memory(err, "hits", count * sizeof *radiance);
    if (!gpu_download(r->gpu, &r->buffers[BINDING_RADIANCE], 0, radiance, count * sizeof *radiance,
                      err))
        return false;
    for (uint32_t i = 0; i < count; i++)
        hits[i] = (struct single_hit){.primitive = radiance[i][0] > 0.0f ? NO_PRIMITIVE : 0};
    return true;
}

bool single_kernel_trace(struct renderer *r, enum kernel_id kernel, const struct single_ray *rays,
                         uint32_t count, struct single_hit *hits, double *ms, bool *complete,
                         struct err *err)
{
    struct arena scratch = {0};
    bool shadow = kernel == KERNEL_intersect_shadow;
    uint32_t queue = shadow ? QUEUE_SHADOW : QUEUE_RAYS;
    bool ok = (shadow ? upload_shadow(r, rays, count, &scratch, err)
                      : upload_closest(r, rays, count, &scratch, err)) &&
              upload_queue(r, queue, count, &scratch, err) &&
              dispatch(r, kernel, queue, count, ms, err);
    *complete = ok && r->counters->unfinished == 0;
    if (ok && hits)
        ok = shadow ? download_shadow(r, hits, count, &scratch, err)
                    : download_closest(r, hits, count, &scratch, err);
    arena_finish(&scratch);
    return ok;
}
