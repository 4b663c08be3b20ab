#include "render/wave_record.h"

#include "render/counters.h"

// Bounces that are recorded before the host checks whether any path is left. The number is small,
// so that little is recorded in vain, and large enough for waiting not to matter.
#define BOUNCES_A_SUBMIT 16u
#define QUEUES_OF_HITS ((1u << (QUEUE_MISS + 1)) - (1u << QUEUE_SURFACE))

// --- the loop ------------------------------------------------------------------------------------

static bool watched(struct wave_loop *l, wave_step_fn fn, enum kernel_id kernel, uint32_t queue,
                    struct err *err)
{
    const struct gpu_push *push = &l->r->push;
    uint32_t light_ray = kernel == KERNEL_intersect_shadow ? push->light_ray : 0;
    const struct wave_step step = {kernel, push->bounce, queue, light_ray, l->part_items};
    return record_run(l->r, err) && fn(l->observer->context, &step, err) &&
           record_begin(l->r, l->wave, err);
}

static bool before(struct wave_loop *l, enum kernel_id kernel, uint32_t queue, struct err *err)
{
    return !l->observer || !l->observer->before ||
           watched(l, l->observer->before, kernel, queue, err);
}

static bool after(struct wave_loop *l, enum kernel_id kernel, uint32_t queue, struct err *err)
{
    return !l->observer || !l->observer->after ||
           watched(l, l->observer->after, kernel, queue, err);
}

// Traces the rays of a queue. If rays may exceed their iteration budget, the host checks after each
// dispatch whether some are suspended, and continues them.
static bool trace_queue(struct wave_loop *l, enum kernel_id kernel, uint32_t queue, struct err *err)
{
    struct renderer *r = l->r;
    if (!before(l, kernel, queue, err))
        return false;
    if (!record_queue(l, kernel, queue, err))
        return false;
    if (r->specialization.features & FEATURE_SUSPEND) {
        for (uint32_t suspended = QUEUE_SUSPENDED;;
             suspended = 2 * QUEUE_SUSPENDED + 1 - suspended) {
            record_barrier(r);
            if (!record_prepare(l, 1u << suspended, err) || !record_run(r, err) ||
                !record_begin(r, l->wave, err))
                return false;
            if (r->counters->dispatch[suspended * DISPATCH_PARTS].items == 0)
                break;
            if (!record_queue(l, kernel, suspended, err))
                return false;
        }
    }
    return after(l, kernel, queue, err);
}

uint32_t wave_shadow_launches(const struct renderer *r, uint32_t bounce)
{
    const struct specialization *s = &r->specialization;
    bool is_beyond = s->light_choice == LIGHT_CHOICE_ALL && bounce > s->light_vertices;
    return is_beyond ? 1 : s->light_rays;
}

static void push_wave(struct renderer *r, const struct wave *wave)
{
    r->push.first_pixel = (uint32_t)wave->first_pixel;
    r->push.pixel_count = wave->pixel_count;
    r->push.sample_shift = wave->sample_shift;
    r->push.first_sample = (uint32_t)wave->first_sample;
    r->push.film_first_pixel = (uint32_t)(wave->film_chunk * r->plan.film_chunk_pixels);
    r->wave_items = wave->pixel_count << wave->sample_shift << r->specialization.split_lobes;
}

// Adds the contributions of light paths at the camera to each chunk of the film, in two dispatches:
// in the first, all splats claim the digits that they need (lib/splat.glsl).
static bool add_splats(struct wave_loop *l, struct err *err)
{
    struct renderer *r = l->r;
    const struct wave *own = l->wave;
    struct wave range = *own;
    bool ok = true;
    l->wave = &range; // new submissions bind its film chunk
    for (range.film_chunk = 0; ok && range.film_chunk < r->plan.film_chunks; range.film_chunk++) {
        gpu_bind(r->gpu, &r->commands, &r->bindings[range.film_chunk]);
        r->push.film_first_pixel = (uint32_t)(range.film_chunk * r->plan.film_chunk_pixels);
        for (r->push.light_ray = 0; ok && r->push.light_ray < 2; r->push.light_ray++) {
            record_barrier(r);
            ok = record_queue(l, KERNEL_add_splats, QUEUE_SHADOW, err);
        }
    }
    l->wave = own;
    push_wave(r, own);
    if (ok)
        gpu_bind(r->gpu, &r->commands, &r->bindings[own->film_chunk]);
    return ok;
}

// Traces the shadow rays of each slot in consecutive dispatches, so that contributions are added in
// the order of lights.
static bool trace_shadow_rays(struct wave_loop *l, struct err *err)
{
    struct renderer *r = l->r;
    if (l->is_light)
        return trace_queue(l, KERNEL_intersect_camera, QUEUE_SHADOW, err) && add_splats(l, err);
    if (!specialization_needs_kernel(&r->specialization, KERNEL_intersect_shadow))
        return true;
    uint32_t rays = wave_shadow_launches(r, l->bounce);
    for (uint32_t ray = 0; ray < rays; ray++) {
        r->push.light_ray = ray;
        if (ray > 0)
            record_barrier(r);
        if (!trace_queue(l, KERNEL_intersect_shadow, QUEUE_SHADOW, err))
            return false;
    }
    return true;
}

// Records a kernel over a queue, if the scene needs the kernel.
static bool consume(struct wave_loop *l, enum kernel_id kernel, uint32_t queue, struct err *err)
{
    if (!specialization_needs_kernel(&l->r->specialization, kernel))
        return true;
    if (!before(l, kernel, queue, err))
        return false;
    return record_queue(l, kernel, queue, err) && after(l, kernel, queue, err);
}

static bool shade_misses(struct wave_loop *l, struct err *err)
{
    if (l->is_light || !(l->r->specialization.queues >> QUEUE_MISS & 1u))
        return true;
    return consume(l, KERNEL_shade_miss, QUEUE_MISS, err) &&
           consume(l, KERNEL_shade_whitted, QUEUE_MISS, err);
}

// Surfaces of all classes share one kernel for light paths.
static bool shade_light(struct wave_loop *l, struct err *err)
{
    uint32_t queues = l->r->specialization.queues;
    for (uint32_t c = 0; c < CLASS_COUNT; c++)
        if ((queues >> (QUEUE_SURFACE + c) & 1u) &&
            !consume(l, KERNEL_shade_light, QUEUE_SURFACE + c, err))
            return false;
    return true;
}

static bool shade_surfaces(struct wave_loop *l, struct err *err)
{
    if (l->is_light)
        return shade_light(l, err);
    for (uint32_t c = 0; c < CLASS_COUNT; c++)
        if (!consume(l, (enum kernel_id)(KERNEL_shade_diffuse + c), QUEUE_SURFACE + c, err))
            return false;
    return consume(l, KERNEL_shade_surface, QUEUE_SURFACE, err) &&
           consume(l, KERNEL_shade_ao, QUEUE_SURFACE, err) &&
           consume(l, KERNEL_shade_whitted, QUEUE_SURFACE, err);
}

// Chooses l->part_items, the maximum number of items of a dispatch. Dispatches that
// prepare_dispatch has prepared assume the present number, so call this only after all of them were
// recorded.
static void choose_part(struct wave_loop *l)
{
    struct renderer *r = l->r;
    pace_choose_part(&r->pace, &r->plan, r->specialization.workgroup, r->wave_items);
    l->part_items = l->is_paced ? r->pace.part_items : r->plan.part_items;
}

// --- stages of a bounce: kernels between two barriers --------------------------------------------

static uint32_t queue_of_rays(const struct wave_loop *l)
{
    return QUEUE_RAYS + (l->bounce & 1u);
}

static bool prepare_rays(struct wave_loop *l, struct err *err)
{
    uint32_t mask = 1u << queue_of_rays(l) | 1u << QUEUE_SHADOW;
    choose_part(l);
    return before(l, KERNEL_prepare_dispatch, mask, err) && record_prepare(l, mask, err);
}

static bool sorts_rays(const struct wave_loop *l)
{
    return l->r->specialization.sort_rays && l->bounce >= SORT_FIRST_BOUNCE;
}

// Returns the queue that holds the rays to trace: if rays are sorted, this is the other queue of
// rays, because shading fills the usual one.
static uint32_t queue_to_trace(const struct wave_loop *l)
{
    return sorts_rays(l) ? 2 * QUEUE_RAYS + 1 - queue_of_rays(l) : queue_of_rays(l);
}

static bool sort_count(struct wave_loop *l, struct err *err)
{
    return !sorts_rays(l) || consume(l, KERNEL_sort_count, queue_of_rays(l), err);
}

static bool sort_scan(struct wave_loop *l, struct err *err)
{
    uint32_t queue = queue_of_rays(l);
    return !sorts_rays(l) || (before(l, KERNEL_sort_scan, queue, err) &&
                              record_scan(l, queue, err) && after(l, KERNEL_sort_scan, queue, err));
}

static bool sort_scatter(struct wave_loop *l, struct err *err)
{
    return !sorts_rays(l) || consume(l, KERNEL_sort_scatter, queue_of_rays(l), err);
}

// Traces the rays of a bounce. The shadow rays of the preceding bounce come first, so that
// contributions are added in the order of bounces.
static bool trace(struct wave_loop *l, struct err *err)
{
    return (l->bounce == 0 || trace_shadow_rays(l, err)) &&
           trace_queue(l, KERNEL_intersect_closest, queue_to_trace(l), err);
}

static bool prepare_hits(struct wave_loop *l, struct err *err)
{
    const struct specialization *s = &l->r->specialization;
    bool has_queues = s->features & (FEATURE_CLASSES | FEATURE_ENVIRONMENT);
    return !has_queues || record_prepare(l, s->queues & QUEUES_OF_HITS, err);
}

static bool shade_hits(struct wave_loop *l, struct err *err)
{
    return shade_misses(l, err) && shade_surfaces(l, err);
}

static bool (*const stages[])(struct wave_loop *l, struct err *err) = {
    prepare_rays, sort_count, sort_scan, sort_scatter, trace, prepare_hits, shade_hits};

// --- bounces of waves ----------------------------------------------------------------------------

void wave_exchange(struct renderer *r)
{
    struct other_wave other = {
        .bindings = r->bindings,
        .counters = r->counters,
        .counters_copy = r->counters_copy,
    };
    for (uint32_t b = 0; b < BINDING_COUNT; b++) {
        if (!memory_plan_is_of_wave(&r->specialization, b))
            continue;
        other.buffers[b] = r->buffers[b];
        r->buffers[b] = r->other.buffers[b];
    }
    r->bindings = r->other.bindings;
    r->counters = r->other.counters;
    r->counters_copy = r->other.counters_copy;
    r->other = other;
}

// Switches to the other wave, whose kernels are then recorded.
static void turn_to(struct wave_loop *l)
{
    struct renderer *r = l->r;
    wave_exchange(r);
    push_wave(r, l->wave);
    r->push.bounce = l->bounce;
    gpu_bind(r->gpu, &r->commands, &r->bindings[l->wave->film_chunk]);
}

static bool generate_rays(struct wave_loop *l, struct err *err)
{
    struct renderer *r = l->r;
    enum kernel_id kernel = l->is_light ? KERNEL_generate_light_rays : KERNEL_generate_rays;
    r->push.bounce = 0;
    if (!before(l, kernel, 0, err))
        return false;
    choose_part(l);
    if (!record_items(l, kernel, l->wave->pixel_count << l->wave->sample_shift, 1, err))
        return false;
    record_barrier(r);
    return after(l, kernel, 0, err);
}

// Begins the next wave when half of this wave's bounces have been recorded. The remaining bounces
// have few paths, and leave room on a wide device for the many paths of the next wave's first
// bounces.
static bool begin_ahead(struct wave_loop *l, struct wave_loop *ahead, struct err *err)
{
    struct renderer *r = l->r;
    uint32_t usual = r->bounces ? r->bounces : BOUNCES_A_SUBMIT;
    uint32_t all = l->last < usual ? l->last + 1 : usual;
    if (r->ahead.is_begun || l->bounce < all / 2)
        return true;
    turn_to(ahead);
    r->ahead.is_begun = true;
    r->ahead.before = *r->counters;
    r->stats.waves_ahead++;
    bool ok = generate_rays(ahead, err);
    turn_to(l);
    return ok;
}

// Traces the next bounce of a wave, and at the same time that of the wave begun ahead.
static bool trace_bounce(struct wave_loop *l, struct wave_loop *ahead, struct err *err)
{
    struct renderer *r = l->r;
    bool both = r->ahead.is_begun;
    r->push.bounce = l->bounce;
    for (size_t i = 0; i < sizeof stages / sizeof stages[0]; i++) {
        if (!stages[i](l, err))
            return false;
        if (both) {
            turn_to(ahead);
            bool ok = stages[i](ahead, err);
            turn_to(l);
            if (!ok)
                return false;
        }
        record_barrier(r);
    }
    l->bounce++;
    r->ahead.bounce = both ? ++ahead->bounce : 0;
    return true;
}

// Traces all paths of a wave until they end. Some recorded commands may not have run yet when it
// returns. ahead: the following wave, which is begun meanwhile; or NULL.
static bool trace_paths(struct wave_loop *l, struct wave_loop *ahead, struct err *err)
{
    struct renderer *r = l->r;
    if (!record_begin(r, l->wave, err) || (l->bounce == 0 && !generate_rays(l, err)))
        return false;
    if (!specialization_needs_kernel(&r->specialization, KERNEL_intersect_closest))
        return true;
    while (l->bounce <= l->last) {
        if ((ahead && !begin_ahead(l, ahead, err)) || !trace_bounce(l, ahead, err))
            return false;
        if (l->bounce % BOUNCES_A_SUBMIT != 0)
            continue;
        if (!record_run(r, err) || !record_begin(r, l->wave, err))
            return false;
        if (r->counters->queue[queue_of_rays(l)].count == 0 &&
            r->counters->queue[QUEUE_SHADOW].count == 0)
            break;
    }
    r->bounces = l->bounce;
    return true;
}

// Traces light paths before camera paths, because splats are assigned to half-buffers by the number
// of samples that the film has so far.
static bool trace_light_paths(const struct wave_loop *camera, struct err *err)
{
    struct wave_loop l = *camera;
    l.is_light = true;
    l.observer = NULL;
    return l.r->specialization.integrator != INTEGRATOR_BIDIR ||
           (trace_paths(&l, NULL, err) && record_run(l.r, err));
}

static struct wave_loop make_loop(struct renderer *r, const struct wave *wave,
                                  const struct wave_observer *observer)
{
    push_wave(r, wave);
    // With postponed rays a path is a tree, which takes as many bounces as the tree has rays.
    uint32_t last = r->specialization.pending_rays ? UINT32_MAX - 1 : r->frame.max_bounces;
    return (struct wave_loop){
        .r = r,
        .wave = wave,
        .observer = observer,
        .is_paced = r->pace.is_on,
        .part_items = r->pace.is_on ? r->pace.part_items : r->plan.part_items,
        .last = last,
    };
}

static uint64_t count_since(const uint32_t now[2], const uint32_t before[2])
{
    return ((uint64_t)now[1] << 32 | now[0]) - ((uint64_t)before[1] << 32 | before[0]);
}

static void add_counts(struct renderer *r, const struct gpu_counters *before)
{
    for (int i = 0; i < STEPS_COUNT; i++)
        r->stats.steps[i] += count_since(r->counters->steps[i], before->steps[i]);
    r->stats.closest_rays += count_since(r->counters->closest_rays, before->closest_rays);
    r->stats.shadow_rays += count_since(r->counters->shadow_rays, before->shadow_rays);
    r->stats.suspended += r->counters->suspended - before->suspended;
    r->stats.media_lost += r->counters->media_lost - before->media_lost;
    r->stats.sparse += r->counters->sparse - before->sparse;
    r->stats.branches += r->counters->branches - before->branches;
    r->stats.clamped += r->counters->clamped - before->clamped;
    r->stats.clamped_light +=
        (double)count_since(r->counters->clamped_light, before->clamped_light) /
        (double)CLAMP_UNITS * (double)r->frame.clamp_limit;
    // The queues still have the hits of the wave's last bounce.
    for (uint32_t c = 0; c < CLASS_COUNT; c++)
        r->stats.surface_hits[c] +=
            count_since(r->counters->surface_hits[c], before->surface_hits[c]) +
            r->counters->queue[QUEUE_SURFACE + c].count - before->queue[QUEUE_SURFACE + c].count;
}

// Adds the numbers of non-finite contributions, and keeps the lowest contribution that the device
// has recorded.
static void add_nonfinite(struct renderer *r, const struct gpu_counters *before)
{
    struct nonfinite_stats *stats = &r->stats.nonfinite;
    for (int site = 0; site < SITE_COUNT; site++)
        stats->count[site] += r->counters->nonfinite[site] - before->nonfinite[site];
    for (uint32_t i = before->nonfinite_records;
         i < r->counters->nonfinite_records && i < NONFINITE_RECORDS; i++) {
        const uint32_t *record = &r->counters->nonfinite_record[i * 4];
        if (stats->recorded &&
            (record[0] > stats->pixel || (record[0] == stats->pixel && record[1] >= stats->sample)))
            continue;
        stats->recorded = true;
        stats->pixel = record[0];
        stats->sample = record[1];
        stats->site = record[2];
        stats->bounce = record[3];
    }
}

bool wave_render(struct renderer *r, const struct wave *wave, const struct wave *next,
                 const struct wave_observer *observer, bool *voided, struct err *err)
{
    const bool is_begun = r->ahead.is_begun;
    if (is_begun)
        wave_exchange(r);
    struct wave_loop loop = make_loop(r, wave, observer);
    struct gpu_counters before = is_begun ? r->ahead.before : *r->counters;
    loop.bounce = is_begun ? r->ahead.bounce : 0;
    r->ahead = (struct wave_ahead){0};
    struct wave_loop ahead = loop;
    if (next) {
        r->ahead.wave = *next;
        ahead.wave = &r->ahead.wave;
        ahead.bounce = 0;
    }
    if (!trace_light_paths(&loop, err) || !trace_paths(&loop, next ? &ahead : NULL, err))
        return false;
    if (!record_items(&loop, KERNEL_accumulate, wave->pixel_count, 1u << wave->sample_shift, err) ||
        !record_run(r, err))
        return false;
    pace_end_wave(&r->pace, &r->plan);
    *voided = r->counters->unfinished != 0; // the kernel accumulate has then not changed the film
    if (*voided) {
        r->stats.voided_waves++;
        return true;
    }
    r->stats.waves++;
    add_counts(r, &before);
    r->stats.paths += (uint64_t)wave->pixel_count << wave->sample_shift;
    add_nonfinite(r, &before);
    return true;
}

bool wave_trace_steps(struct renderer *r, const struct wave *wave,
                      const struct wave_observer *observer, struct err *err)
{
    if (!wave_forget_ahead(r, err))
        return false;
    struct wave_loop loop = make_loop(r, wave, observer);
    return trace_paths(&loop, NULL, err) && record_run(r, err);
}

static bool record_step(struct wave_loop *l, const struct wave_step *step, struct err *err)
{
    const struct wave *wave = l->wave;
    switch (step->kernel) {
    case KERNEL_generate_rays:
    case KERNEL_generate_light_rays:
        return record_items(l, step->kernel, wave->pixel_count << wave->sample_shift, 1, err);
    case KERNEL_accumulate:
        return record_items(l, step->kernel, wave->pixel_count, 1u << wave->sample_shift, err);
    case KERNEL_resolve:
        return record_items(l, step->kernel, wave->pixel_count, 1, err);
    case KERNEL_prepare_dispatch:
        return record_prepare(l, step->queue, err);
    case KERNEL_sort_scan:
        return record_scan(l, step->queue, err);
    default:
        return record_queue(l, step->kernel, step->queue, err);
    }
}

bool wave_run_step(struct renderer *r, const struct wave *wave, const struct wave_step *step,
                   double *ms, struct err *err)
{
    struct wave_loop loop = make_loop(r, wave, NULL);
    bool is_shadow = step->kernel == KERNEL_intersect_shadow;
    uint32_t launches = is_shadow ? wave_shadow_launches(r, step->bounce) : 1;
    const double *device_ms = &r->stats.kernels[step->kernel].ms, before = *device_ms;
    const double *host_ms = &r->stats.host.submitting, host_before = *host_ms;
    loop.is_timed = true;
    if (step->part_items > 0)
        loop.part_items = step->part_items;
    if (!record_begin(r, wave, err))
        return false;
    r->push.bounce = step->bounce;
    for (r->push.light_ray = 0; r->push.light_ray < launches; r->push.light_ray++) {
        record_barrier(r);
        if (!record_step(&loop, step, err))
            return false;
    }
    if (!record_run(r, err))
        return false;
    *ms = r->gpu->has_timestamps ? *device_ms - before : *host_ms - host_before;
    return true;
}

// --- compiling -----------------------------------------------------------------------------------

// Zeroes all counters, so that kernels find no work. run_on_nothing() relies on this.
bool wave_clear_counters(struct renderer *r, struct err *err)
{
    r->ahead.is_begun = false;
    if (!counters_clear(r, err))
        return false;
    if (r->plan.waves < 2)
        return true;
    wave_exchange(r);
    bool ok = counters_clear(r, err);
    wave_exchange(r);
    return ok;
}

bool wave_forget_ahead(struct renderer *r, struct err *err)
{
    return !r->ahead.is_begun || wave_clear_counters(r, err);
}

static bool run_on_nothing(struct renderer *r, struct err *err)
{
    struct wave none = {0};
    push_wave(r, &none);
    pace_begin(&r->pace, r->gpu, &r->plan);
    wave_size_begin(&r->wave_size, r->tunes_wave, r->plan.wave_samples);
    r->push.queue = 0;
    r->push.part_items = 0;
    struct render_stats kept = r->stats; // the time of compiling must not count as run time
    if (!wave_clear_counters(r, err) || !record_begin(r, &none, err))
        return false;
    for (int id = 0; id < KERNEL_COUNT; id++) {
        record_barrier(r);
        if (r->kernels[id].pipeline)
            record_dispatch(r, (enum kernel_id)id, 1, 0);
    }
    bool ok = record_run(r, err);
    r->stats = kept;
    return ok;
}

bool wave_compile(struct renderer *r, struct err *err)
{
    return wave_create_kernels(r, err) && run_on_nothing(r, err);
}

bool wave_count_steps(struct renderer *r, bool on, struct err *err)
{
    specialization_count_steps(&r->specialization, on);
    return wave_compile(r, err);
}
