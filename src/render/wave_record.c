#include "render/wave_record.h"

#include "base/clock.h"
#include "render/counters.h"
#include <math.h>

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

bool record_begin(struct renderer *r, const struct wave *wave, struct err *err)
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

void record_barrier(struct renderer *r)
{
    if (r->barrier_is_due)
        gpu_barrier(r->gpu, &r->commands);
    r->barrier_is_due = false;
}

void record_dispatch(struct renderer *r, enum kernel_id kernel, uint32_t groups, uint32_t items)
{
    gpu_push(r->gpu, &r->commands, &r->push, sizeof r->push);
    gpu_dispatch(r->gpu, &r->commands, &r->kernels[kernel], groups);
    mark(r, kernel, items);
    r->stats.kernels[kernel].launches++;
    r->barrier_is_due = true;
}

// --- submissions with a limited duration ---------------------------------------------------------

// Submits the recorded commands if the submission would become too long with the next part of a
// kernel, or if every part needs a timestamp and none is left.
static bool make_room(struct wave_loop *l, enum kernel_id kernel, uint32_t items, struct err *err)
{
    struct renderer *r = l->r;
    bool is_full = (l->is_paced || l->is_timed) && r->mark_count == GPU_MAX_TIMESTAMPS;
    if (!is_full && (!l->is_paced || pace_takes(&r->pace, kernel, items)))
        return true;
    return record_run(r, err) && record_begin(r, l->wave, err) &&
           (!l->is_paced || pace_takes(&r->pace, kernel, items) ||
            err_set(
                err, ERR_BUG,
                "an empty submission has no room for a dispatch; expected room for any dispatch"));
}

bool record_items(struct wave_loop *l, enum kernel_id kernel, uint32_t items, uint32_t work,
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
        record_dispatch(r, kernel, (part + workgroup - 1) / workgroup, part * work);
    }
    return true;
}

bool record_queue(struct wave_loop *l, enum kernel_id kernel, uint32_t queue, struct err *err)
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
            record_barrier(r);
        r->stats.kernels[kernel].launches++;
        mark(r, kernel, items);
    }
    return true;
}

bool record_prepare(struct wave_loop *l, uint32_t queue_mask, struct err *err)
{
    struct renderer *r = l->r;
    if (!make_room(l, KERNEL_prepare_dispatch, 0, err))
        return false;
    r->push.queue = queue_mask;
    r->push.part_items = l->part_items;
    // The smallest workgroups have fewer threads than there are queues.
    uint32_t workgroup = r->specialization.workgroup;
    record_dispatch(r, KERNEL_prepare_dispatch, (QUEUE_COUNT + workgroup - 1) / workgroup, 0);
    return true;
}

bool record_scan(struct wave_loop *l, uint32_t queue, struct err *err)
{
    if (!make_room(l, KERNEL_sort_scan, 0, err))
        return false;
    l->r->push.queue = queue;
    record_dispatch(l->r, KERNEL_sort_scan, 1, 0);
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

// Passes the times of a submission to the pace. ns: the times at which marks were passed; NULL:
// only the total time is known, which is then divided in proportion to the expected times.
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
bool record_run(struct renderer *r, struct err *err)
{
    struct host_stats *host = &r->stats.host;
    uint64_t recorded = clock_ns();
    host->recording += (double)(recorded - r->recording_ns) * 1e-6;
    record_barrier(r);
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
