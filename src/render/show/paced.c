#include "render/show/paced.h"

#include "base/clock.h"
#include <math.h>
#include <string.h>

bool paced_create(struct gpu *gpu, struct paced *out, struct err *err)
{
    *out = (struct paced){.gpu = gpu};
    pace_begin_others(&out->pace, gpu);
    return gpu_commands_create(gpu, &out->commands, err);
}

void paced_finish(struct paced *p)
{
    if (p->gpu)
        gpu_commands_finish(p->gpu, &p->commands);
}

// Marks are also recorded if there are no timestamps.
static void mark(struct paced *p, uint32_t kernel, uint32_t items)
{
    gpu_timestamp(p->gpu, &p->commands);
    if (p->mark_count < GPU_MAX_TIMESTAMPS)
        p->marks[p->mark_count++] = (struct paced_mark){kernel, items};
}

static bool begin(struct paced *p, struct err *err)
{
    p->mark_count = 0;
    p->pace.recorded_ns = 0.0;
    if (!gpu_begin(p->gpu, &p->commands, err))
        return false;
    mark(p, 0, 0);
    return true;
}

bool paced_begin(struct paced *p, struct err *err)
{
    memset(p->ns, 0, sizeof p->ns);
    return begin(p, err);
}

// Learns from the times of a submission. ns: the times at which marks were passed; NULL: only the
// total time is known, which is then divided in proportion to the expected times.
static void learn(struct paced *p, const double *ns, double total_ns)
{
    double expected = p->pace.recorded_ns;
    for (uint32_t i = 1; i < p->mark_count; i++) {
        const struct paced_mark *m = &p->marks[i];
        double known = p->pace.ns[m->kernel] * m->items;
        double share = known > 0.0 && expected > 0.0 ? fmin(known / expected, 1.0) : 1.0;
        pace_learn(&p->pace, m->kernel, m->items, ns ? ns[i] - ns[i - 1] : total_ns * share);
        if (ns)
            p->ns[m->kernel] += ns[i] - ns[i - 1];
    }
}

static bool run(struct paced *p, struct err *err)
{
    double ns[GPU_MAX_TIMESTAMPS];
    uint64_t start = clock_ns();
    if (!gpu_submit(p->gpu, &p->commands, err) || !gpu_wait(p->gpu, &p->commands, err))
        return false;
    double waited_ns = (double)(clock_ns() - start);
    if (p->gpu->has_timestamps && !gpu_timestamps_ns(p->gpu, &p->commands, ns, err))
        return false;
    learn(p, p->gpu->has_timestamps ? ns : NULL, waited_ns);
    return true;
}

static bool make_room(struct paced *p, uint32_t kernel, uint32_t items, struct err *err)
{
    bool is_full = p->mark_count == GPU_MAX_TIMESTAMPS;
    if (!is_full && (!p->pace.is_on || pace_takes(&p->pace, kernel, items)))
        return true;
    return run(p, err) && begin(p, err) &&
           (!p->pace.is_on || pace_takes(&p->pace, kernel, items) ||
            err_set(
                err, ERR_BUG,
                "an empty submission has no room for a dispatch; expected room for any dispatch"));
}

bool paced_dispatch(struct paced *p, const struct paced_work *w, struct err *err)
{
    uint32_t part;
    for (uint64_t first = 0; first < w->groups; first += part) {
        uint64_t left = w->groups - first;
        uint32_t most = left < p->gpu->max_groups ? (uint32_t)left : p->gpu->max_groups;
        part = pace_items(&p->pace, w->number, most * w->workgroup) / w->workgroup;
        part = part > 0 ? part : 1;
        if (!make_room(p, w->number, part * w->workgroup, err))
            return false;
        *w->first = (uint32_t)first * w->first_unit;
        gpu_bind(p->gpu, &p->commands, w->bindings);
        gpu_push(p->gpu, &p->commands, w->push, w->push_bytes);
        gpu_dispatch(p->gpu, &p->commands, w->kernel, part);
        mark(p, w->number, part * w->workgroup);
    }
    gpu_barrier(p->gpu, &p->commands);
    return true;
}

bool paced_end(struct paced *p, struct err *err)
{
    if (!run(p, err))
        return false;
    pace_end_round(&p->pace);
    return true;
}
