// Simulates a slow device, for the limits group_ns and watchdog_ms. Each workgroup counts as taking
// group_ns. Timestamps show the simulated time; without timestamps, the host waits for it. A
// submission that takes longer than watchdog_ms loses the device.
#ifndef LAMPYRIS_GPU_SLOW_H
#define LAMPYRIS_GPU_SLOW_H

#include "gpu/gpu.h"

// Creates the state of a submission, to be freed by the caller; returns NULL when out of memory.
// The caller provides a log of 16 bytes per dispatch, to which the arguments of indirect dispatches
// are copied before these run, because later kernels may overwrite the arguments.
#define SLOW_DISPATCHES 16384u
struct gpu_slow *slow_create(void);

// The slow_begin, slow_dispatch and slow_timestamp functions do nothing if `slow` is NULL.
void slow_begin(struct gpu_slow *slow);
void slow_dispatch(struct gpu_slow *slow, uint32_t groups);
// Returns the offset in the log, in bytes, at which to store the arguments of an indirect dispatch,
// or UINT64_MAX if they are not to be stored.
uint64_t slow_dispatch_indirect(struct gpu_slow *slow);
void slow_timestamp(struct gpu_slow *slow, uint32_t index);
// Call this after the submission has ended. Without timestamps it waits for the simulated time.
// Returns VK_ERROR_DEVICE_LOST if the simulated time exceeds watchdog_ms.
VkResult slow_wait(const struct gpu *gpu, const struct gpu_slow *slow, const void *log);
// Replaces the measured times, in nanoseconds, by simulated ones.
void slow_timestamps(const struct gpu *gpu, const struct gpu_slow *slow, const void *log,
                     uint32_t count, double *ns);

#endif
