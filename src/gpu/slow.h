// A simulated slow device: for the overrides group_ns and watchdog_ms. Each workgroup counts as
// this many nanoseconds, which timestamps or, without these, the clock show; and a submission that
// takes longer than the watchdog permits loses the device.
#ifndef LAMPYRIS_GPU_SLOW_H
#define LAMPYRIS_GPU_SLOW_H

#include "gpu/gpu.h"

// The state of a submission; NULL when out of memory. The caller has a log of 16 bytes per
// dispatch, into which the arguments of indirect dispatches are copied before these run, because
// the kernels that write them may overwrite them later.
#define SLOW_DISPATCHES 16384u
struct gpu_slow *slow_create(void); // to be freed

// These accept NULL, and then do nothing.
void slow_begin(struct gpu_slow *slow);
void slow_dispatch(struct gpu_slow *slow, uint32_t groups);
// Returns where to log the arguments; UINT64_MAX: nowhere.
uint64_t slow_dispatch_indirect(struct gpu_slow *slow);
void slow_timestamp(struct gpu_slow *slow, uint32_t index);
// After the submission has ended: waits for the simulated time, if there are no timestamps. Returns
// VK_ERROR_DEVICE_LOST if the watchdog's time was exceeded.
VkResult slow_wait(const struct gpu *gpu, const struct gpu_slow *slow, const void *log);
// Replaces measured times by simulated ones.
void slow_timestamps(const struct gpu *gpu, const struct gpu_slow *slow, const void *log,
                     uint32_t count, double *ns);

#endif
