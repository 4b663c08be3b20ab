#include "render/probe/ray_probe.h"

#include "base/clock.h"
#include "render/counters.h"
#include "render/wave.h"
#include <string.h>

// Value of a slot before tracing; it remains if the ray hits nothing, because kernels write only
// hits.
#define UNTOUCHED NO_PRIMITIVE

// Records of rays or hits. `stride` is in uvec4 words. With instances, one more word follows the
// struct of a record.
struct records {
    uint32_t (*words)[4];
    uint32_t stride;
};

static bool reserve(struct records *records, uint32_t stride, uint32_t count, struct arena *scratch,
                    struct err *err)
{
    *records = (struct records){arena_alloc(scratch, (size_t)count * stride, 16), stride};
    return records->words || err_memory(err, "rays", (size_t)count * stride * 16);
}

static uint64_t bytes_of(const struct records *records, uint32_t count)
{
    return (uint64_t)count * records->stride * sizeof *records->words;
}

static uint32_t (*record_of(const struct records *records, uint32_t i))[4]
{
    return records->words + (size_t)i * records->stride;
}

// Finds the primitive words from which rays start. The kernels name triangles by their positions in
// leaf order, the caller by their indices in the flat scene.
static bool find_starts(const struct renderer *r, const struct probe_ray *rays, uint32_t count,
                        struct arena *scratch, uint32_t **starts, struct err *err)
{
    uint32_t *places = ARENA_NEW(scratch, uint32_t, r->flat.triangle_count);
    *starts = ARENA_NEW(scratch, uint32_t, count);
    if (!places || !*starts)
        return err_memory(err, "rays", ((uint64_t)r->flat.triangle_count + count) * sizeof *places);
    for (uint32_t place = 0; place < r->bvh.reference_count; place++)
        places[r->bvh.triangle_order[place]] = place;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t from = rays[i].from;
        (*starts)[i] = !rays[i].leaves          ? NO_PRIMITIVE
                       : from & PRIMITIVE_SHAPE ? from
                                                : places[from];
    }
    return true;
}

static bool upload_closest(struct renderer *r, const struct probe_ray *rays, uint32_t count,
                           struct arena *scratch, struct err *err)
{
    struct records records;
    uint32_t *starts;
    if (!find_starts(r, rays, count, scratch, &starts, err) ||
        !reserve(&records, PATH_WORDS_OF(r->specialization.geometry, r->specialization.integrator),
                 count, scratch, err))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t(*words)[4] = record_of(&records, i);
        struct gpu_path path = {.ignore = starts[i], .primitive = UNTOUCHED};
        memcpy(path.origin, rays[i].origin, sizeof rays[i].origin);
        memcpy(path.direction, rays[i].direction, sizeof rays[i].direction);
        memcpy(words, &path, sizeof path);
        if (records.stride > PATH_INSTANCE) {
            words[PATH_INSTANCE][0] = NO_INSTANCE;
            words[PATH_INSTANCE][1] = rays[i].leaves ? rays[i].from_instance : NO_INSTANCE;
        }
    }
    return gpu_upload(r->gpu, &r->buffers[BINDING_PATHS], 0, records.words,
                      bytes_of(&records, count), err);
}

// Uploads the first shadow ray of each slot. Its contribution is 1, so the slot's radiance
// afterwards shows whether the ray was occluded.
static bool upload_shadow(struct renderer *r, const struct probe_ray *rays, uint32_t count,
                          struct arena *scratch, struct err *err)
{
    struct records records;
    uint32_t *starts;
    float(*radiance)[4] = arena_alloc(scratch, count, sizeof *radiance);
    const struct specialization *s = &r->specialization;
    if (!radiance)
        return err_memory(err, "rays", count * sizeof *radiance);
    if (!find_starts(r, rays, count, scratch, &starts, err) ||
        !reserve(&records, s->light_rays * SHADOW_WORDS_OF(s->geometry), count, scratch, err))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t(*words)[4] = record_of(&records, i);
        struct gpu_shadow_ray ray = {
            .ignore_from = starts[i], .ignore_to = NO_PRIMITIVE, .radiance = {1.0f}};
        memcpy(ray.origin, rays[i].origin, sizeof rays[i].origin);
        memcpy(ray.direction, rays[i].direction, sizeof rays[i].direction);
        memcpy(words, &ray, sizeof ray);
        if (s->geometry & GEOMETRY_INSTANCES)
            words[SHADOW_INSTANCE][0] = rays[i].leaves ? rays[i].from_instance : NO_INSTANCE;
    }
    return gpu_upload(r->gpu, &r->buffers[BINDING_RADIANCE], 0, radiance, count * sizeof *radiance,
                      err) &&
           gpu_upload(r->gpu, &r->buffers[BINDING_SHADOW_RAYS], 0, records.words,
                      bytes_of(&records, count), err);
}

// Fills a queue with slots 0 to count - 1, as prepare_dispatch would have left it.
static bool upload_queue(struct renderer *r, uint32_t queue, uint32_t count, struct arena *scratch,
                         struct err *err)
{
    uint32_t *slots = ARENA_NEW(scratch, uint32_t, count);
    if (!slots)
        return err_memory(err, "queue", count * sizeof *slots);
    for (uint32_t i = 0; i < count; i++)
        slots[i] = i;
    memset(r->counters, 0, sizeof *r->counters);
    r->counters->dispatch[queue * DISPATCH_PARTS].items = count;
    return gpu_upload(r->gpu, &r->buffers[BINDING_QUEUES], queue_offset(r, queue), slots,
                      count * sizeof *slots, err) &&
           counters_write(r, err);
}

// Runs a kernel on a part of the queue, in a submission of its own.
static bool run_part(struct renderer *r, enum kernel_id kernel, uint32_t first, uint32_t count,
                     double *part_ns, struct err *err)
{
    uint32_t workgroup = r->specialization.workgroup;
    struct gpu_commands *commands = &r->commands;
    double ns[GPU_MAX_TIMESTAMPS] = {0};
    r->push.first_item = first;
    r->push.part_items = count;
    if (!gpu_begin(r->gpu, commands, err))
        return false;
    gpu_bind(r->gpu, commands, &r->bindings[0]);
    gpu_push(r->gpu, commands, &r->push, sizeof r->push);
    gpu_timestamp(r->gpu, commands);
    gpu_dispatch(r->gpu, commands, &r->kernels[kernel], (count + workgroup - 1) / workgroup);
    gpu_barrier(r->gpu, commands);
    gpu_timestamp(r->gpu, commands);
    counters_record_copy(r);
    uint64_t start = clock_ns();
    if (!gpu_submit(r->gpu, commands, err) || !gpu_wait(r->gpu, commands, err))
        return false;
    double waited_ns = (double)(clock_ns() - start);
    if (r->gpu->has_timestamps && !gpu_timestamps_ns(r->gpu, commands, ns, err))
        return false;
    *part_ns = ns[1] - ns[0];
    pace_learn(&r->pace, kernel, count, r->gpu->has_timestamps ? *part_ns : waited_ns);
    counters_read(r);
    return true;
}

// Runs a kernel on the whole queue, in parts that are as large as the device permits.
static bool dispatch(struct renderer *r, enum kernel_id kernel, uint32_t queue, uint32_t count,
                     double *ms, struct err *err)
{
    r->push.queue = queue;
    *ms = 0.0;
    for (uint32_t first = 0, part; first < count; first += part) {
        double ns;
        part = pace_items(&r->pace, kernel, count - first);
        if (!run_part(r, kernel, first, part, &ns, err))
            return false;
        *ms += ns * 1e-6;
    }
    return true;
}

static bool download_closest(struct renderer *r, struct probe_hit *hits, uint32_t count,
                             struct arena *scratch, struct err *err)
{
    struct records records;
    if (!reserve(&records, PATH_WORDS_OF(r->specialization.geometry, r->specialization.integrator),
                 count, scratch, err) ||
        !gpu_download(r->gpu, &r->buffers[BINDING_PATHS], 0, records.words,
                      bytes_of(&records, count), err))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t(*words)[4] = record_of(&records, i);
        struct gpu_path path;
        memcpy(&path, words, sizeof path);
        uint32_t word = path.primitive;
        uint32_t instance = records.stride > PATH_INSTANCE ? words[PATH_INSTANCE][0] : NO_INSTANCE;
        bool is_shape = word != NO_PRIMITIVE && (word & PRIMITIVE_SHAPE);
        hits[i] = (struct probe_hit){path.t, path.u, path.v, word, instance};
        if (word != NO_PRIMITIVE && !is_shape)
            hits[i].primitive = r->bvh.triangle_order[word];
    }
    return true;
}

static bool download_shadow(struct renderer *r, struct probe_hit *hits, uint32_t count,
                            struct arena *scratch, struct err *err)
{
    float(*radiance)[4] = arena_alloc(scratch, count, sizeof *radiance);
    if (!radiance)
        return err_memory(err, "hits", count * sizeof *radiance);
    if (!gpu_download(r->gpu, &r->buffers[BINDING_RADIANCE], 0, radiance, count * sizeof *radiance,
                      err))
        return false;
    for (uint32_t i = 0; i < count; i++)
        hits[i] = (struct probe_hit){.primitive = radiance[i][0] > 0.0f ? NO_PRIMITIVE : 0};
    return true;
}

bool ray_probe_trace(struct renderer *r, enum kernel_id kernel, const struct probe_ray *rays,
                     uint32_t count, struct probe_hit *hits, double *ms, bool *complete,
                     struct err *err)
{
    struct arena scratch = {0};
    bool shadow = kernel == KERNEL_intersect_shadow;
    uint32_t queue = shadow ? QUEUE_SHADOW : QUEUE_RAYS;
    bool ok = wave_forget_ahead(r, err) &&
              (shadow ? upload_shadow(r, rays, count, &scratch, err)
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
