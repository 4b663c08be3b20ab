#include "render/wave.h"

#include "base/clock.h"
#include "render/counters.h"
#include <math.h>
#include <string.h>

// Bounces that are recorded before the host checks whether any path is left. The number is small,
// so that little is recorded in vain, and large enough for waiting not to matter.
#define BOUNCES_A_SUBMIT 16u
#define QUEUES_OF_HITS ((1u << (QUEUE_MISS + 1)) - (1u << QUEUE_SURFACE))

// --- recording -----------------------------------------------------------------------------------

static bool is_of_shadow_rays(enum kernel_id kernel)
{
    return kernel == KERNEL_intersect_shadow || kernel == KERNEL_intersect_camera ||
           kernel == KERNEL_add_splats;
}

// Records a timestamp. The array of marks is in the order of timestamps. items: 0 for a kernel that
// does little work.
static void mark(struct renderer *r, enum kernel_id kernel, uint32_t items)
{
    uint32_t index = gpu_timestamp(r->gpu, &r->commands);
    uint32_t bounce = r->push.bounce;
    if (!r->gpu->has_timestamps && r->mark_count < GPU_MAX_TIMESTAMPS)
        index = r->mark_count;
    if (kernel == KERNEL_accumulate)
        bounce = 0;
    else if (is_of_shadow_rays(kernel) && bounce > 0)
        bounce--;
    if (bounce >= STATS_BOUNCES)
        bounce = STATS_BOUNCES - 1;
    if (index == UINT32_MAX)
        return;
    r->marks[index] = (struct mark){(uint8_t)kernel, (uint8_t)bounce, r->push.first_item, items};
    r->mark_count = index + 1;
}

static bool begin(struct renderer *r, const struct wave *wave, struct err *err)
{
    r->recording_ns = clock_ns();
    if (!gpu_begin(r->gpu, &r->commands, err))
        return false;
    gpu_bind(r->gpu, &r->commands, &r->bindings[wave->film_chunk]);
    r->mark_count = 0;
    r->pace.recorded_ns = 0.0;
    r->barrier_is_due = false;
    mark(r, KERNEL_COUNT, 0);
    return true;
}

// Makes the writes of earlier kernels visible to later ones. Kernels between two barriers may run
// at the same time; docs/architecture.md, "Kernels side by side", explains why that is correct.
static void barrier(struct renderer *r)
{
    if (r->barrier_is_due)
        gpu_barrier(r->gpu, &r->commands);
    r->barrier_is_due = false;
}

static void dispatch(struct renderer *r, enum kernel_id kernel, uint32_t groups, uint32_t items)
{
    gpu_push(r->gpu, &r->commands, &r->push, sizeof r->push);
    gpu_dispatch(r->gpu, &r->commands, &r->kernels[kernel], groups);
    mark(r, kernel, items);
    r->stats.kernels[kernel].launches++;
    r->barrier_is_due = true;
}

// --- recording of submissions with a limited duration
// ---------------------------------------------

struct loop {
    struct renderer *r;
    const struct wave *wave;
    const struct wave_observer *observer; // NULL: records as much as possible before running it
    bool is_paced;
    bool is_timed;       // gives every part a timestamp of its own
    uint32_t part_items; // items of a queue or a list that one dispatch processes
    bool is_light;       // the paths are light paths
    uint32_t bounce;     // the next bounce to record
    uint32_t last;       // the last possible bounce of paths
};

static bool run(struct renderer *r, struct err *err);

// Submits the recorded commands if the submission would become too long with the next part of a
// kernel, or if every part needs a timestamp and none is left.
static bool make_room(struct loop *l, enum kernel_id kernel, uint32_t items, struct err *err)
{
    struct renderer *r = l->r;
    bool is_full = (l->is_paced || l->is_timed) && r->mark_count == GPU_MAX_TIMESTAMPS;
    if (!is_full && (!l->is_paced || pace_takes(&r->pace, kernel, items)))
        return true;
    return run(r, err) && begin(r, l->wave, err) &&
           (!l->is_paced || pace_takes(&r->pace, kernel, items) ||
            err_set(err, ERR_BUG, "an empty submission that takes nothing"));
}

// Records a kernel over `items` items, in parts. work: the number of items of other kernels that
// take as long as one item of this kernel.
static bool record_items(struct loop *l, enum kernel_id kernel, uint32_t items, uint32_t work,
                         struct err *err)
{
    struct renderer *r = l->r;
    uint32_t workgroup = r->specialization.workgroup;
    uint32_t most = l->is_paced && l->part_items / work > workgroup
                        ? l->part_items / work / workgroup * workgroup
                    : l->is_paced ? workgroup
                                  : l->part_items;
    for (uint32_t first = 0; first < items; first += most) {
        uint32_t left = items - first;
        uint32_t part = left < most ? left : most;
        if (!make_room(l, kernel, part * work, err))
            return false;
        r->push.part_items = most;
        r->push.first_item = first;
        dispatch(r, kernel, (part + workgroup - 1) / workgroup, part * work);
    }
    return true;
}

// Records a kernel over a queue whose length only the device knows, in as many parts as it may
// need, without a barrier after it. Synchronization validation assumes that a kernel reads and
// writes every buffer that is bound to it; with that layer no two dispatches run at the same time.
static bool record_queue(struct loop *l, enum kernel_id kernel, uint32_t queue, struct err *err)
{
    struct renderer *r = l->r;
    for (uint32_t part = 0; part * (uint64_t)l->part_items < r->wave_items; part++) {
        size_t at = offsetof(struct gpu_counters, dispatch) +
                    (queue * DISPATCH_PARTS + part) * sizeof(struct gpu_dispatch);
        uint32_t first = part * l->part_items, left = r->wave_items - first;
        uint32_t items = left < l->part_items ? left : l->part_items;
        if (!make_room(l, kernel, items, err))
            return false;
        r->push.queue = queue;
        r->push.part_items = l->part_items;
        r->push.first_item = first;
        gpu_push(r->gpu, &r->commands, &r->push, sizeof r->push);
        gpu_dispatch_indirect(r->gpu, &r->commands, &r->kernels[kernel],
                              &r->buffers[BINDING_QUEUES], at);
        r->barrier_is_due = true;
        if (r->gpu->params.validation)
            barrier(r);
        r->stats.kernels[kernel].launches++;
        mark(r, kernel, items);
    }
    return true;
}

static bool record_prepare(struct loop *l, uint32_t queue_mask, struct err *err)
{
    struct renderer *r = l->r;
    if (!make_room(l, KERNEL_prepare_dispatch, 0, err))
        return false;
    r->push.queue = queue_mask;
    r->push.part_items = l->part_items;
    // The smallest workgroups have fewer threads than there are queues.
    uint32_t workgroup = r->specialization.workgroup;
    dispatch(r, KERNEL_prepare_dispatch, (QUEUE_COUNT + workgroup - 1) / workgroup, 0);
    return true;
}

// Records the single workgroup of a sort: see lib/sort.glsl.
static bool record_scan(struct loop *l, uint32_t queue, struct err *err)
{
    if (!make_room(l, KERNEL_sort_scan, 0, err))
        return false;
    l->r->push.queue = queue;
    dispatch(l->r, KERNEL_sort_scan, 1, 0);
    return true;
}

// --- running -------------------------------------------------------------------------------------

static void add_times(struct renderer *r, const double *ns)
{
    for (uint32_t i = 1; i < r->mark_count; i++) {
        struct kernel_stats *kernel = &r->stats.kernels[r->marks[i].kernel];
        double ms = (ns[i] - ns[i - 1]) * 1e-6;
        kernel->ms += ms;
        r->stats.bounce_ms[r->marks[i].bounce][r->marks[i].kernel] += ms;
        if (ms > kernel->longest_ms)
            kernel->longest_ms = ms;
    }
}

// Returns the number of items that a dispatch processed, for the queue that was prepared last.
static uint32_t items_found(const struct renderer *r, const struct mark *m)
{
    uint32_t queue = r->push.queue;
    if (m->kernel == KERNEL_generate_rays || m->kernel == KERNEL_generate_light_rays ||
        m->kernel == KERNEL_accumulate)
        return m->items;
    bool is_hits = queue >= QUEUE_SURFACE && queue <= QUEUE_MISS;
    uint32_t count = is_hits ? r->counters->queue[queue].count
                             : r->counters->dispatch[queue * DISPATCH_PARTS].items;
    uint32_t left = count > m->first ? count - m->first : 0;
    return left < m->items ? left : m->items;
}

// Passes a kernel's time to the pace. A kernel whose time is not known was submitted alone, so the
// number of items that it really processed is known. Later the number includes empty items; the
// fullest bounces of a wave then determine the time of an item.
static void learn(struct renderer *r, const struct mark *m, double ns)
{
    bool is_known = r->pace.ns[m->kernel] > 0.0;
    pace_learn(&r->pace, m->kernel, is_known ? m->items : items_found(r, m), ns);
}

// ns: the times at which marks were passed; NULL: only the total time is known, which is then
// divided in proportion to the expected times.
static void learn_all(struct renderer *r, const double *ns, double total_ns)
{
    double expected = r->pace.recorded_ns;
    for (uint32_t i = 1; i < r->mark_count; i++) {
        const struct mark *m = &r->marks[i];
        if (m->items == 0)
            continue;
        double known = r->pace.ns[m->kernel] * m->items;
        double share = known > 0.0 && expected > 0.0 ? fmin(known / expected, 1.0) : 1.0;
        learn(r, m, ns ? ns[i] - ns[i - 1] : total_ns * share);
    }
}

// Submits the recorded commands, waits, and reads back times and counters.
static bool run(struct renderer *r, struct err *err)
{
    struct host_stats *host = &r->stats.host;
    uint64_t recorded = clock_ns();
    host->recording += (double)(recorded - r->recording_ns) * 1e-6;
    barrier(r);
    counters_record_copy(r);
    if (!gpu_submit(r->gpu, &r->commands, err) || !gpu_wait(r->gpu, &r->commands, err))
        return false;
    uint64_t waited = clock_ns();
    host->submitting += (double)(waited - recorded) * 1e-6;
    double ns[GPU_MAX_TIMESTAMPS];
    if (r->gpu->has_timestamps) {
        if (!gpu_timestamps_ns(r->gpu, &r->commands, ns, err))
            return false;
        add_times(r, ns);
        host->submitting -= ns[r->mark_count - 1] * 1e-6;
    }
    counters_read(r);
    if (r->pace.is_on)
        learn_all(r, r->gpu->has_timestamps ? ns : NULL, (double)(waited - recorded));
    host->reading_back += (double)(clock_ns() - waited) * 1e-6;
    return true;
}

// --- the loop ------------------------------------------------------------------------------------

static bool watched(struct loop *l, wave_step_fn fn, enum kernel_id kernel, uint32_t queue,
                    struct err *err)
{
    const struct gpu_push *push = &l->r->push;
    uint32_t light_ray = kernel == KERNEL_intersect_shadow ? push->light_ray : 0;
    const struct wave_step step = {kernel, push->bounce, queue, light_ray, l->part_items};
    return run(l->r, err) && fn(l->observer->context, &step, err) && begin(l->r, l->wave, err);
}

static bool before(struct loop *l, enum kernel_id kernel, uint32_t queue, struct err *err)
{
    return !l->observer || !l->observer->before ||
           watched(l, l->observer->before, kernel, queue, err);
}

static bool after(struct loop *l, enum kernel_id kernel, uint32_t queue, struct err *err)
{
    return !l->observer || !l->observer->after ||
           watched(l, l->observer->after, kernel, queue, err);
}

// Traces the rays of a queue. If rays may exceed their iteration budget, the host checks after each
// dispatch whether some are suspended, and continues them.
static bool trace_queue(struct loop *l, enum kernel_id kernel, uint32_t queue, struct err *err)
{
    struct renderer *r = l->r;
    if (!before(l, kernel, queue, err))
        return false;
    if (!record_queue(l, kernel, queue, err))
        return false;
    if (r->specialization.features & FEATURE_SUSPEND) {
        for (uint32_t suspended = QUEUE_SUSPENDED;;
             suspended = 2 * QUEUE_SUSPENDED + 1 - suspended) {
            barrier(r);
            if (!record_prepare(l, 1u << suspended, err) || !run(r, err) || !begin(r, l->wave, err))
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
static bool add_splats(struct loop *l, struct err *err)
{
    struct renderer *r = l->r;
    const struct wave *own = l->wave;
    struct wave range = *own;
    bool ok = true;
    l->wave = &range; // bound by new submissions
    for (range.film_chunk = 0; ok && range.film_chunk < r->plan.film_chunks; range.film_chunk++) {
        gpu_bind(r->gpu, &r->commands, &r->bindings[range.film_chunk]);
        r->push.film_first_pixel = (uint32_t)(range.film_chunk * r->plan.film_chunk_pixels);
        for (r->push.light_ray = 0; ok && r->push.light_ray < 2; r->push.light_ray++) {
            barrier(r);
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
static bool trace_shadow_rays(struct loop *l, struct err *err)
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
            barrier(r);
        if (!trace_queue(l, KERNEL_intersect_shadow, QUEUE_SHADOW, err))
            return false;
    }
    return true;
}

// Records a kernel over a queue, if the scene needs the kernel.
static bool consume(struct loop *l, enum kernel_id kernel, uint32_t queue, struct err *err)
{
    if (!specialization_needs_kernel(&l->r->specialization, kernel))
        return true;
    if (!before(l, kernel, queue, err))
        return false;
    return record_queue(l, kernel, queue, err) && after(l, kernel, queue, err);
}

static bool shade_misses(struct loop *l, struct err *err)
{
    if (l->is_light || !(l->r->specialization.queues >> QUEUE_MISS & 1u))
        return true;
    return consume(l, KERNEL_shade_miss, QUEUE_MISS, err) &&
           consume(l, KERNEL_shade_whitted, QUEUE_MISS, err);
}

// Surfaces of all classes share one kernel for light paths.
static bool shade_light(struct loop *l, struct err *err)
{
    uint32_t queues = l->r->specialization.queues;
    for (uint32_t c = 0; c < CLASS_COUNT; c++)
        if ((queues >> (QUEUE_SURFACE + c) & 1u) &&
            !consume(l, KERNEL_shade_light, QUEUE_SURFACE + c, err))
            return false;
    return true;
}

static bool shade_surfaces(struct loop *l, struct err *err)
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
static void choose_part(struct loop *l)
{
    struct renderer *r = l->r;
    pace_choose_part(&r->pace, &r->plan, r->specialization.workgroup, r->wave_items);
    l->part_items = l->is_paced ? r->pace.part_items : r->plan.part_items;
}

// --- stages of a bounce: kernels between two barriers --------------------------------------------

static uint32_t queue_of_rays(const struct loop *l)
{
    return QUEUE_RAYS + (l->bounce & 1u);
}

static bool prepare_rays(struct loop *l, struct err *err)
{
    uint32_t mask = 1u << queue_of_rays(l) | 1u << QUEUE_SHADOW;
    choose_part(l);
    return before(l, KERNEL_prepare_dispatch, mask, err) && record_prepare(l, mask, err);
}

static bool sorts_rays(const struct loop *l)
{
    return l->r->specialization.sort_rays && l->bounce >= SORT_FIRST_BOUNCE;
}

// Returns the queue that holds the rays to trace: if rays are sorted, this is the other queue of
// rays, because shading fills the usual one.
static uint32_t queue_to_trace(const struct loop *l)
{
    return sorts_rays(l) ? 2 * QUEUE_RAYS + 1 - queue_of_rays(l) : queue_of_rays(l);
}

static bool sort_count(struct loop *l, struct err *err)
{
    return !sorts_rays(l) || consume(l, KERNEL_sort_count, queue_of_rays(l), err);
}

static bool sort_scan(struct loop *l, struct err *err)
{
    uint32_t queue = queue_of_rays(l);
    return !sorts_rays(l) || (before(l, KERNEL_sort_scan, queue, err) &&
                              record_scan(l, queue, err) && after(l, KERNEL_sort_scan, queue, err));
}

static bool sort_scatter(struct loop *l, struct err *err)
{
    return !sorts_rays(l) || consume(l, KERNEL_sort_scatter, queue_of_rays(l), err);
}

// Traces the rays of a bounce. The shadow rays of the preceding bounce come first, so that
// contributions are added in the order of bounces.
static bool trace(struct loop *l, struct err *err)
{
    return (l->bounce == 0 || trace_shadow_rays(l, err)) &&
           trace_queue(l, KERNEL_intersect_closest, queue_to_trace(l), err);
}

static bool prepare_hits(struct loop *l, struct err *err)
{
    const struct specialization *s = &l->r->specialization;
    bool has_queues = s->features & (FEATURE_CLASSES | FEATURE_ENVIRONMENT);
    return !has_queues || record_prepare(l, s->queues & QUEUES_OF_HITS, err);
}

static bool shade_hits(struct loop *l, struct err *err)
{
    return shade_misses(l, err) && shade_surfaces(l, err);
}

static bool (*const stages[])(struct loop *l, struct err *err) = {
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
static void turn_to(struct loop *l)
{
    struct renderer *r = l->r;
    wave_exchange(r);
    push_wave(r, l->wave);
    r->push.bounce = l->bounce;
    gpu_bind(r->gpu, &r->commands, &r->bindings[l->wave->film_chunk]);
}

static bool generate_rays(struct loop *l, struct err *err)
{
    struct renderer *r = l->r;
    enum kernel_id kernel = l->is_light ? KERNEL_generate_light_rays : KERNEL_generate_rays;
    r->push.bounce = 0;
    if (!before(l, kernel, 0, err))
        return false;
    choose_part(l);
    if (!record_items(l, kernel, l->wave->pixel_count << l->wave->sample_shift, 1, err))
        return false;
    barrier(r);
    return after(l, kernel, 0, err);
}

// Begins the next wave when half of this wave's bounces have been recorded. The remaining bounces
// have few paths, and leave room on a wide device for the many paths of the next wave's first
// bounces.
static bool begin_ahead(struct loop *l, struct loop *ahead, struct err *err)
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
static bool trace_bounce(struct loop *l, struct loop *ahead, struct err *err)
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
        barrier(r);
    }
    l->bounce++;
    r->ahead.bounce = both ? ++ahead->bounce : 0;
    return true;
}

// Traces all paths of a wave until they end. Some recorded commands may not have run yet when it
// returns. ahead: the following wave, which is begun meanwhile; or NULL.
static bool trace_paths(struct loop *l, struct loop *ahead, struct err *err)
{
    struct renderer *r = l->r;
    if (!begin(r, l->wave, err) || (l->bounce == 0 && !generate_rays(l, err)))
        return false;
    if (!specialization_needs_kernel(&r->specialization, KERNEL_intersect_closest))
        return true;
    while (l->bounce <= l->last) {
        if ((ahead && !begin_ahead(l, ahead, err)) || !trace_bounce(l, ahead, err))
            return false;
        if (l->bounce % BOUNCES_A_SUBMIT != 0)
            continue;
        if (!run(r, err) || !begin(r, l->wave, err))
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
static bool trace_light_paths(const struct loop *camera, struct err *err)
{
    struct loop l = *camera;
    l.is_light = true;
    l.observer = NULL;
    return l.r->specialization.integrator != INTEGRATOR_BIDIR ||
           (trace_paths(&l, NULL, err) && run(l.r, err));
}

static struct loop make_loop(struct renderer *r, const struct wave *wave,
                             const struct wave_observer *observer)
{
    push_wave(r, wave);
    // With postponed rays a path is a tree, which takes as many bounces as the tree has rays.
    uint32_t last = r->specialization.pending_rays ? UINT32_MAX - 1 : r->frame.max_bounces;
    return (struct loop){
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
    struct loop loop = make_loop(r, wave, observer);
    struct gpu_counters before = is_begun ? r->ahead.before : *r->counters;
    loop.bounce = is_begun ? r->ahead.bounce : 0;
    r->ahead = (struct wave_ahead){0};
    struct loop ahead = loop;
    if (next) {
        r->ahead.wave = *next;
        ahead.wave = &r->ahead.wave;
        ahead.bounce = 0;
    }
    if (!trace_light_paths(&loop, err) || !trace_paths(&loop, next ? &ahead : NULL, err))
        return false;
    if (!record_items(&loop, KERNEL_accumulate, wave->pixel_count, 1u << wave->sample_shift, err) ||
        !run(r, err))
        return false;
    pace_end_wave(&r->pace, &r->plan);
    *voided = r->counters->unfinished != 0; // accumulate has not changed the film then
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
    struct loop loop = make_loop(r, wave, observer);
    return trace_paths(&loop, NULL, err) && run(r, err);
}

static bool record_step(struct loop *l, const struct wave_step *step, struct err *err)
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
    struct loop loop = make_loop(r, wave, NULL);
    bool is_shadow = step->kernel == KERNEL_intersect_shadow;
    uint32_t launches = is_shadow ? wave_shadow_launches(r, step->bounce) : 1;
    const double *device_ms = &r->stats.kernels[step->kernel].ms, before = *device_ms;
    const double *host_ms = &r->stats.host.submitting, host_before = *host_ms;
    loop.is_timed = true;
    if (step->part_items > 0)
        loop.part_items = step->part_items;
    if (!begin(r, wave, err))
        return false;
    r->push.bounce = step->bounce;
    for (r->push.light_ray = 0; r->push.light_ray < launches; r->push.light_ray++) {
        barrier(r);
        if (!record_step(&loop, step, err))
            return false;
    }
    if (!run(r, err))
        return false;
    *ms = r->gpu->has_timestamps ? *device_ms - before : *host_ms - host_before;
    return true;
}

// --- compiling -----------------------------------------------------------------------------------

// Zeroes all counters, so that kernels find no work. The kernels below are compiled that way.
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
    if (!wave_clear_counters(r, err) || !begin(r, &none, err))
        return false;
    for (int id = 0; id < KERNEL_COUNT; id++) {
        barrier(r);
        if (r->kernels[id].pipeline)
            dispatch(r, (enum kernel_id)id, 1, 0);
    }
    bool ok = run(r, err);
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
