// A slow device, simulated: for the overrides group_ns and watchdog_ms. Each workgroup that runs is
// taken for so many nanoseconds, which timestamps and, without these, the clock show; and a
// submission that takes longer than a watchdog allows loses the device.
#ifndef LAMPYRIS_GPU_SLOW_H
#define LAMPYRIS_GPU_SLOW_H

#include "gpu/gpu.h"

// Of a submission. NULL without memory for it. Who records it has a log of 16 bytes a dispatch,
// into which the arguments of indirect dispatches are copied before these run: the kernels that
// write them may write others later.
#define SLOW_DISPATCHES 16384u
struct gpu_slow *slow_create(void); // to be freed

// These accept NULL and do nothing then.
void slow_begin(struct gpu_slow *slow);
void slow_dispatch(struct gpu_slow *slow, uint32_t groups);
// Where in the log its arguments belong; UINT64_MAX: nowhere.
uint64_t slow_dispatch_indirect(struct gpu_slow *slow);
void slow_timestamp(struct gpu_slow *slow, uint32_t index);
// After the submission has ended: waits, without timestamps. VK_ERROR_DEVICE_LOST by the watchdog.
VkResult slow_wait(const struct gpu *gpu, const struct gpu_slow *slow, const void *log);
// Puts the simulated times in place of measured ones.
void slow_timestamps(const struct gpu *gpu, const struct gpu_slow *slow, const void *log,
                     uint32_t count, double *ns);

#endif
