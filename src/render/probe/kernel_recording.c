#include "render/probe/kernel_recording.h"

#include "base/hash.h"
#include "base/memory.h"
#include "render/counters.h"
#include <inttypes.h>
#include <string.h>

#define SHADING                                                                                    \
    (1u << BINDING_PATHS | 1u << BINDING_RADIANCE | 1u << BINDING_SHADOW_RAYS |                    \
     1u << BINDING_QUEUES)

// Returns the bindings of the buffers that a kernel writes, as a bit mask.
static uint32_t written(enum kernel_id kernel)
{
    switch (kernel) {
    case KERNEL_generate_rays:
        return 1u << BINDING_PATHS | 1u << BINDING_RADIANCE | 1u << BINDING_QUEUES;
    case KERNEL_intersect_closest:
        return 1u << BINDING_PATHS | 1u << BINDING_QUEUES;
    case KERNEL_shade_miss:
    case KERNEL_intersect_shadow:
        return 1u << BINDING_RADIANCE | 1u << BINDING_QUEUES;
    case KERNEL_sort_count:
        return 1u << BINDING_PATHS | 1u << BINDING_SORT;
    case KERNEL_sort_scan:
    case KERNEL_sort_scatter:
        return 1u << BINDING_QUEUES | 1u << BINDING_SORT;
    case KERNEL_accumulate:
        return 1u << BINDING_FILM;
    case KERNEL_prepare_dispatch:
        return 1u << BINDING_QUEUES;
    case KERNEL_resolve:
        return 1u << BINDING_RESOLVED;
    default:
        return SHADING;
    }
}

static const struct gpu_buffer *buffer_of(const struct renderer *r,
                                          const struct kernel_recording *rec, uint32_t binding)
{
    return binding == BINDING_FILM ? &r->film[rec->wave.film_chunk] : &r->buffers[binding];
}

static bool is_kept(const struct renderer *r, const struct kernel_recording *rec, uint32_t binding)
{
    return (written(rec->step.kernel) >> binding & 1u) && buffer_of(r, rec, binding)->handle;
}

// --- output of a kernel --------------------------------------------------------------------------

static uint64_t mix(uint64_t x)
{
    // The finalizer of SplitMix64 (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number
    // generators").
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return x ^ x >> 31;
}

// Hashes a queue as a set, because the order of its slots depends on scheduling.
static uint64_t hash_queue(const uint32_t *slots, uint32_t count)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += mix(slots[i] + UINT64_C(1));
    return sum;
}

static uint64_t hash_queues(const struct renderer *r, const uint8_t *buffer, uint64_t hash)
{
    for (uint32_t queue = 0; queue < QUEUE_COUNT; queue++) {
        if (!(r->specialization.queues >> queue & 1u))
            continue;
        const uint32_t *slots = (const uint32_t *)(buffer + queue_offset(r, queue));
        uint32_t count = r->counters->queue[queue].count;
        uint64_t sum = hash_queue(slots, count < r->plan.wave_slots ? count : r->plan.wave_slots);
        hash = hash_bytes(hash, &sum, sizeof sum);
    }
    return hash;
}

// Hashes the counters without the members that depend on scheduling, that is, the record of a
// non-finite contribution.
static uint64_t hash_counters(const struct gpu_counters *counters, uint64_t hash)
{
    struct gpu_counters c = *counters;
    memset(c.steps, 0, sizeof c.steps);
    memset(c.nonfinite_record, 0, sizeof c.nonfinite_record);
    return hash_bytes(hash, &c, sizeof c);
}

// Hashes 64-bit words rather than bytes, because states are large.
static uint64_t hash_words(uint64_t hash, const uint64_t *words, uint64_t bytes)
{
    for (uint64_t i = 0; i < bytes / 8; i++)
        hash = (hash ^ mix(words[i] + i)) * UINT64_C(0x100000001b3);
    return hash;
}

static bool hash_state(struct renderer *r, const struct kernel_recording *rec, uint64_t *hash,
                       struct err *err)
{
    struct arena scratch = {0};
    bool ok = true;
    *hash = HASH_INIT;
    for (uint32_t b = 0; b < BINDING_COUNT && ok; b++) {
        const struct gpu_buffer *buffer = buffer_of(r, rec, b);
        if (!is_kept(r, rec, b))
            continue;
        uint64_t *copy = arena_alloc(&scratch, buffer->bytes / 8 + 1, sizeof *copy);
        if (!copy)
            ok = err_memory(err, "a kernel's results", buffer->bytes);
        ok = ok && gpu_download(r->gpu, buffer, 0, copy, buffer->bytes, err);
        if (ok && b == BINDING_QUEUES) // the counters were read back after the submission
            *hash = hash_counters(r->counters, hash_queues(r, (const uint8_t *)copy, *hash));
        else if (ok)
            *hash = hash_words(*hash, copy, buffer->bytes);
        arena_finish(&scratch);
    }
    return ok;
}

// --- saving the state ----------------------------------------------------------------------------

static bool submit(struct renderer *r, struct err *err)
{
    return gpu_submit(r->gpu, &r->commands, err) && gpu_wait(r->gpu, &r->commands, err);
}

static void record_copies(struct renderer *r, const struct kernel_recording *rec, bool back)
{
    for (uint32_t b = 0; b < BINDING_COUNT; b++) {
        const struct gpu_buffer *live = buffer_of(r, rec, b), *kept = &rec->kept[b];
        if (kept->handle)
            gpu_copy(r->gpu, &r->commands, back ? kept : live, 0, back ? live : kept, 0,
                     live->bytes);
    }
    gpu_barrier(r->gpu, &r->commands);
}

static bool check_memory(const struct renderer *r, struct kernel_recording *rec, struct err *err)
{
    for (uint32_t b = 0; b < BINDING_COUNT; b++)
        rec->bytes += is_kept(r, rec, b) ? buffer_of(r, rec, b)->bytes : 0;
    uint64_t free = gpu_memory_free(r->gpu);
    return rec->bytes <= free ||
           err_set(err, ERR_GPU,
                   "saving the buffers that %s writes takes %s, but %s has only %s left; expected "
                   "a smaller --wave",
                   r->kernels[rec->step.kernel].name, memory_print(rec->bytes).text,
                   r->gpu->info.name, memory_print(free).text);
}

// Copies the buffers that the kernel writes. Call it while no commands are being recorded.
static bool keep(struct renderer *r, struct kernel_recording *rec, struct err *err)
{
    if (!check_memory(r, rec, err))
        return false;
    for (uint32_t b = 0; b < BINDING_COUNT; b++)
        if (is_kept(r, rec, b) && !gpu_buffer_create(r->gpu, "kept", buffer_of(r, rec, b)->bytes,
                                                     GPU_DEVICE, false, &rec->kept[b], err))
            return false;
    if (!gpu_begin(r->gpu, &r->commands, err))
        return false;
    record_copies(r, rec, false);
    return submit(r, err);
}

// --- running -------------------------------------------------------------------------------------

// Runs the kernel once. The state is restored in a submission of its own.
static bool run(struct renderer *r, const struct kernel_recording *rec, double *ms, struct err *err)
{
    if (!gpu_begin(r->gpu, &r->commands, err))
        return false;
    record_copies(r, rec, true);
    return submit(r, err) && wave_run_step(r, &rec->wave, &rec->step, ms, err);
}

// --- recording -----------------------------------------------------------------------------------

struct recording {
    struct renderer *r;
    struct kernel_recording *rec;
    bool done; // the kernel has run, or has no items
};

static bool is_it(const struct recording *c, const struct wave_step *step)
{
    // Whitted's integrator uses one kernel for the queues of surfaces and of misses.
    return step->kernel == c->rec->step.kernel && step->bounce == c->rec->step.bounce &&
           !(step->kernel == KERNEL_shade_whitted && step->queue == QUEUE_MISS);
}

static uint64_t count_items(const struct renderer *r, const struct wave *wave,
                            const struct wave_step *step)
{
    uint32_t queue = step->queue;
    switch (step->kernel) {
    case KERNEL_generate_rays:
        return (uint64_t)wave->pixel_count << wave->sample_shift;
    case KERNEL_accumulate:
    case KERNEL_resolve:
        return wave->pixel_count;
    case KERNEL_prepare_dispatch:
        return (uint32_t)__builtin_popcount(queue & r->specialization.queues);
    default:
        return queue >= QUEUE_SURFACE && queue <= QUEUE_MISS
                   ? r->counters->queue[queue].count
                   : r->counters->dispatch[queue * DISPATCH_PARTS].items;
    }
}

static bool check_finished(const struct renderer *r, struct err *err)
{
    return r->counters->unfinished == 0 ||
           err_set(err, ERR_GPU,
                   "some rays need more than %u steps through the BVH, and so several dispatches; "
                   "expected rays that one dispatch can trace",
                   r->specialization.iteration_budget);
}

// The callbacks fail without an error in order to end the wave at the step that is recorded.
static bool before(void *context, const struct wave_step *step, struct err *err)
{
    struct recording *c = context;
    struct kernel_recording *rec = c->rec;
    if (!is_it(c, step) || step->light_ray > 0)
        return true;
    if (!check_finished(c->r, err))
        return false;
    rec->step = *step;
    rec->items = count_items(c->r, &rec->wave, step) * rec->launches;
    if (rec->items > 0 && !keep(c->r, rec, err))
        return false;
    c->done = rec->items == 0 || step->kernel == KERNEL_prepare_dispatch;
    return !c->done;
}

static bool after(void *context, const struct wave_step *step, struct err *err)
{
    struct recording *c = context;
    struct renderer *r = c->r;
    if (!is_it(c, step) || step->light_ray + 1 < c->rec->launches)
        return true;
    c->done = check_finished(r, err) && hash_state(r, c->rec, &c->rec->hash, err);
    return false;
}

// Returns a wave like those of renderer_render(), but from the middle of the image instead of its
// top.
static struct wave middle_wave(const struct renderer *r, uint64_t samples)
{
    uint32_t shift = USUAL_SAMPLE_SHIFT, most = pace_samples(&r->pace, &r->plan);
    while (shift > 0 && (UINT64_C(1) << shift > samples || 1u << shift > most))
        shift--;
    uint64_t pixels = (uint64_t)r->frame.width * r->frame.height;
    uint64_t fits = most >> shift, chunk_pixels = r->plan.film_chunk_pixels;
    uint64_t count = pixels < fits ? pixels : fits;
    struct wave wave = {.sample_shift = shift, .first_pixel = (pixels - count) / 2};
    wave.film_chunk = (uint32_t)(wave.first_pixel / chunk_pixels);
    uint64_t left = (wave.film_chunk + 1) * chunk_pixels - wave.first_pixel;
    wave.pixel_count = (uint32_t)(count < left ? count : left);
    return wave;
}

// Traces waves until they have reached their largest size. On a device with a watchdog they begin
// small.
static bool grow_wave(struct renderer *r, struct kernel_recording *rec, uint64_t samples,
                      struct err *err)
{
    uint32_t before = 0, now;
    rec->wave = middle_wave(r, samples);
    while (r->pace.is_on && (now = pace_samples(&r->pace, &r->plan)) > before &&
           now < r->plan.wave_samples && now >> rec->wave.sample_shift <= rec->wave.pixel_count) {
        if (!wave_trace_steps(r, &rec->wave, NULL, err) || !wave_clear_counters(r, err))
            return false;
        pace_end_wave(&r->pace, &r->plan);
        before = now;
        rec->wave = middle_wave(r, samples);
    }
    return true;
}

// Keeps the input of kernels that run after a wave, or that are not part of one.
static bool keep_end(struct renderer *r, struct kernel_recording *rec, struct err *err)
{
    if (rec->step.kernel == KERNEL_resolve) {
        uint64_t pixels = (uint64_t)r->frame.width * r->frame.height;
        uint64_t most = r->plan.resolve_pixels;
        rec->wave = (struct wave){.pixel_count = (uint32_t)(pixels < most ? pixels : most)};
    }
    rec->items = count_items(r, &rec->wave, &rec->step);
    return check_finished(r, err) && keep(r, rec, err);
}

static bool record(struct recording *c, struct err *err)
{
    struct renderer *r = c->r;
    struct kernel_recording *rec = c->rec;
    bool at_end = rec->step.kernel == KERNEL_accumulate || rec->step.kernel == KERNEL_resolve;
    const struct wave_observer observer = {.before = before, .after = after, .context = c};
    bool ok = wave_trace_steps(r, &rec->wave, at_end ? NULL : &observer, err) || c->done;
    if (!ok || !(at_end ? keep_end(r, rec, err) : true))
        return false;
    double ms;
    // The observer does not see the render's output of these kernels, so a first run provides the
    // hash.
    bool first = at_end || rec->step.kernel == KERNEL_prepare_dispatch;
    return !first || rec->items == 0 ||
           (run(r, rec, &ms, err) && hash_state(r, rec, &rec->hash, err));
}

// --- interface -----------------------------------------------------------------------------------

bool kernel_recording_create(struct renderer *r, const struct kernel_recording_params *params,
                             struct kernel_recording *out, struct err *err)
{
    enum kernel_id kernel = params->kernel;
    bool shadow = kernel == KERNEL_intersect_shadow;
    *out = (struct kernel_recording){
        .renderer = r,
        .step = {.kernel = kernel, .bounce = params->depth + shadow},
        .launches = shadow ? wave_shadow_launches(r, params->depth + 1) : 1,
    };
    if (kernel == KERNEL_generate_rays)
        out->step.bounce = 0;
    if (!r->kernels[kernel].pipeline)
        return err_set(err, ERR_USAGE, "the scene does not need this kernel");
    if (r->specialization.features & FEATURE_SUSPEND)
        return err_set(err, ERR_GPU,
                       "traversals may take several dispatches; expected a scene whose rays "
                       "one dispatch can trace");
    return grow_wave(r, out, params->samples, err) &&
           record(&(struct recording){.r = r, .rec = out}, err);
}

bool kernel_recording_run(const struct kernel_recording *rec, double *ms, struct err *err)
{
    struct renderer *r = rec->renderer;
    uint64_t hash;
    if (!run(r, rec, ms, err) || !hash_state(r, rec, &hash, err))
        return false;
    return hash == rec->hash || err_set(err, ERR_BUG, "the output differs from that in the render");
}

bool kernel_recording_count_steps(const struct kernel_recording *rec, uint64_t *nodes,
                                  uint64_t *primitives, struct err *err)
{
    struct renderer *r = rec->renderer;
    double ms;
    uint32_t which = rec->step.kernel == KERNEL_intersect_shadow ? STEPS_SHADOW : STEPS_CLOSEST;
    bool ok = wave_count_steps(r, true, err) && kernel_recording_run(rec, &ms, err);
    const uint32_t(*steps)[2] = (const uint32_t(*)[2]) & r->counters->steps[which];
    *nodes = (uint64_t)steps[0][1] << 32 | steps[0][0];
    *primitives = (uint64_t)steps[1][1] << 32 | steps[1][0];
    return ok && wave_count_steps(r, false, err);
}

bool kernel_recording_finish(struct kernel_recording *rec, struct err *err)
{
    struct renderer *r = rec->renderer;
    bool ok = true;
    if (!r)
        return true;
    if (rec->kept[BINDING_FILM].handle)
        ok = gpu_begin(r->gpu, &r->commands, err);
    if (ok && rec->kept[BINDING_FILM].handle) {
        record_copies(r, rec, true);
        ok = submit(r, err);
    }
    for (uint32_t b = 0; b < BINDING_COUNT; b++)
        gpu_buffer_finish(r->gpu, &rec->kept[b]);
    *rec = (struct kernel_recording){0};
    return ok && wave_clear_counters(r, err);
}
