#include "render/pace.h"

#include "shared/types.h"
#include <math.h>

// The number of samples of the first wave. Its dispatches have 1,024 items; even if an item took as
// long as 1 us, that is far below the dangerous duration.
#define FIRST_SAMPLES 65536u
#define LEAST_SAMPLES 4096u
// The maximum factor by which the size grows from one wave to the next, because times of few items
// are inexact.
#define GROWTH 4u

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

void pace_begin_others(struct pace *pace, const struct gpu *gpu)
{
    *pace = (struct pace){.is_on = !gpu->info.is_cpu || gpu->params.limits.group_ns > 0};
}

void pace_begin(struct pace *pace, const struct gpu *gpu, const struct memory_plan *plan)
{
    pace_begin_others(pace, gpu);
    pace->part_items = plan->part_items;
    pace->samples = least(FIRST_SAMPLES, plan->wave_samples);
}

uint32_t pace_samples(const struct pace *pace, const struct memory_plan *plan)
{
    return pace->is_on ? least(pace->samples, plan->wave_samples) : plan->wave_samples;
}

// Returns the time a single item takes in the slowest kernel, in nanoseconds; 0 if none is known.
static double worst_ns(const struct pace *pace)
{
    double worst = 0.0;
    for (int i = 0; i < PACE_KERNELS; i++)
        worst = fmax(worst, pace->ns[i]);
    return worst;
}

static uint32_t items_within(double ns, double item_ns, uint32_t most)
{
    return item_ns > 0.0 && ns / item_ns < most ? (uint32_t)(ns / item_ns) : most;
}

// Until a time is known, a dispatch has as few items as the number of prepared dispatches permits.
void pace_choose_part(struct pace *pace, const struct memory_plan *plan, uint32_t workgroup,
                      uint32_t slots)
{
    if (!pace->is_on)
        return;
    uint32_t smallest = (slots + DISPATCH_PARTS - 1) / DISPATCH_PARTS;
    smallest = (smallest + workgroup - 1) / workgroup * workgroup;
    double worst = worst_ns(pace);
    uint32_t part = worst > 0.0 ? items_within(PACE_DISPATCH_NS, worst, plan->part_items) : 0;
    part = part / workgroup * workgroup;
    pace->part_items = least(part > smallest ? part : smallest, plan->part_items);
}

bool pace_takes(struct pace *pace, uint32_t kernel, uint32_t items)
{
    double ns = pace->ns[kernel] * items;
    bool is_first = pace->recorded_ns == 0.0;
    bool is_known = pace->ns[kernel] > 0.0 || items == 0;
    if (!is_first && (!is_known || pace->recorded_ns + ns > PACE_SUBMISSION_NS))
        return false;
    pace->recorded_ns += is_known ? ns : INFINITY; // time unknown: nothing else may join this
                                                   // submission
    return true;
}

uint32_t pace_items(const struct pace *pace, uint32_t kernel, uint32_t most)
{
    if (!pace->is_on)
        return most;
    if (pace->ns[kernel] == 0.0)
        return least(LEAST_SAMPLES, most);
    uint32_t items = items_within(PACE_DISPATCH_NS, pace->ns[kernel], most);
    return items > 0 ? items : 1;
}

void pace_learn(struct pace *pace, uint32_t kernel, uint32_t items, double ns)
{
    if (!pace->is_on || items == 0)
        return;
    double item_ns = fmax(ns / items, 1e-6); // not 0, even if the clock did not advance
    pace->ns[kernel] = fmax(pace->ns[kernel], item_ns);
    pace->wave_ns[kernel] = fmax(pace->wave_ns[kernel], item_ns);
}

void pace_end_round(struct pace *pace)
{
    for (int i = 0; i < PACE_KERNELS; i++) {
        if (pace->wave_ns[i] > 0.0)
            pace->ns[i] = fmax(pace->wave_ns[i], 0.5 * pace->ns[i]);
        pace->wave_ns[i] = 0.0;
    }
}

void pace_end_wave(struct pace *pace, const struct memory_plan *plan)
{
    if (!pace->is_on)
        return;
    pace_end_round(pace);
    // The next wave has as many samples as fill all its dispatches with the longest permitted time.
    // A sample may have several slots.
    double worst = worst_ns(pace) * (plan->wave_slots / plan->wave_samples);
    uint32_t most = least(GROWTH * least(pace->samples, UINT32_MAX / GROWTH), plan->wave_samples);
    uint32_t fits = items_within(DISPATCH_PARTS * PACE_DISPATCH_NS, worst, most);
    pace->samples = least(fits > LEAST_SAMPLES ? fits : LEAST_SAMPLES, plan->wave_samples);
}
