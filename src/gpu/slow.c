#include "gpu/slow.h"

#include "base/clock.h"
#include <stdlib.h>

struct gpu_slow {
    uint32_t count;
    uint32_t groups[SLOW_DISPATCHES]; // workgroups of each dispatch; UINT32_MAX: the log has the
                                      // number
    uint32_t before[GPU_MAX_TIMESTAMPS];
};

struct gpu_slow *slow_create(void)
{
    return calloc(1, sizeof(struct gpu_slow));
}

void slow_begin(struct gpu_slow *slow)
{
    if (slow)
        slow->count = 0;
}

void slow_dispatch(struct gpu_slow *slow, uint32_t groups)
{
    if (slow && slow->count < SLOW_DISPATCHES)
        slow->groups[slow->count++] = groups;
}

uint64_t slow_dispatch_indirect(struct gpu_slow *slow)
{
    if (!slow || slow->count == SLOW_DISPATCHES)
        return UINT64_MAX;
    slow->groups[slow->count] = UINT32_MAX;
    return slow->count++ * UINT64_C(16);
}

void slow_timestamp(struct gpu_slow *slow, uint32_t index)
{
    if (slow)
        slow->before[index] = slow->count;
}

// Returns the simulated time, in nanoseconds, of the first `count` dispatches.
static double total_ns(const struct gpu *gpu, const struct gpu_slow *slow, const void *log_data,
                       uint32_t count)
{
    const uint32_t(*log)[4] = log_data;
    uint64_t groups = 0;
    for (uint32_t i = 0; i < count; i++)
        groups += slow->groups[i] == UINT32_MAX ? log[i][0] : slow->groups[i];
    return (double)groups * (double)gpu->params.limits.group_ns;
}

VkResult slow_wait(const struct gpu *gpu, const struct gpu_slow *slow, const void *log)
{
    if (!slow)
        return VK_SUCCESS;
    const struct gpu_limit_overrides *limits = &gpu->params.limits;
    double ns = total_ns(gpu, slow, log, slow->count);
    if (limits->watchdog_ms && ns > 1e6 * (double)limits->watchdog_ms)
        return VK_ERROR_DEVICE_LOST;
    if (!gpu->has_timestamps)
        clock_sleep(ns * 1e-9);
    return VK_SUCCESS;
}

void slow_timestamps(const struct gpu *gpu, const struct gpu_slow *slow, const void *log,
                     uint32_t count, double *ns)
{
    for (uint32_t i = 0; slow && i < count; i++)
        ns[i] = total_ns(gpu, slow, log, slow->before[i]);
}
