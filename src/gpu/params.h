// Defines the parameters for opening a device, without including Vulkan's long header.
#ifndef LAMPYRIS_GPU_PARAMS_H
#define LAMPYRIS_GPU_PARAMS_H

#include <stdbool.h>
#include <stdint.h>

struct VkInstance_T; // the types to which VkInstance and VkPhysicalDevice point
struct VkPhysicalDevice_T;

// Limits below the device's own, to test fallbacks; 0 means the device's own limit. Members that
// are 0 or false are taken from the environment variable LAMPYRIS_LIMITS, so that every program and
// test can run with the fallbacks. The variable has words separated by commas: api-1.1, no-texel,
// no-ballot, no-rounding-mode, no-mapped-device, no-timestamps, shared-stack, sort-rays,
// storage-range=BYTES, storage-count=N, texel-count=N, texel-elements=N, allocation=BYTES,
// shared-memory=BYTES, memory=BYTES, memory-budget=BYTES, group-ns=N, watchdog-ms=N, waves=N. Any
// other word fails with ERR_USAGE.
struct gpu_limit_overrides {
    uint64_t storage_range;  // maxStorageBufferRange, bytes
    uint64_t storage_count;  // storage buffers that one kernel may bind
    uint64_t texel_count;    // uniform texel buffers that one kernel may bind
    uint64_t texel_elements; // maxTexelBufferElements
    uint64_t allocation;     // bytes of the largest VkDeviceMemory
    uint64_t shared_memory;  // maxComputeSharedMemorySize, bytes
    uint64_t memory; // bytes of all allocations together; an allocation beyond this total fails
    uint64_t memory_budget; // bytes that the driver reports as available at first
    bool api_1_1;           // Vulkan 1.1 only, with no information about the driver
    // A simulated slow device: the nanoseconds that a workgroup takes, and the milliseconds after
    // which a submission loses the device.
    uint64_t group_ns, watchdog_ms;
    uint64_t waves;        // waves in flight, 1 or 2; not an upper limit but the number itself
    bool no_texel;         // without texel buffers
    bool no_ballot;        // without ballot and arithmetic subgroup operations
    bool no_rounding_mode; // without a choice of the rounding mode
    bool no_mapped_device; // device memory is never mapped, so that uploads and downloads use
                           // staging memory
    bool no_timestamps;    // without timestamps, so that kernels are not timed
    bool shared_stack; // uses the traversal stack of GPUs on any device (shaders/lib/stack.glsl)
    bool sort_rays;    // sorts rays on any device, as on GPUs (shaders/lib/sort.glsl)
};

struct gpu_params {
    const char *device; // index or part of the name, ignoring case; NULL: the first device of the
                        // fastest kind
    bool validation;    // enables VK_LAYER_KHRONOS_validation with synchronization validation
    bool statistics;    // keeps statistics of compiled kernels for gpu_kernel_statistics()
    struct gpu_limit_overrides limits;
    // The following members are for programs with a window; all are 0 for compute only.
    bool graphics;                          // the queue must support graphics: see screen.h
    const char *const *instance_extensions; // the extensions that a window's surface needs
    uint32_t instance_extension_count;
    // Returns whether a queue family can present to the window; NULL if there is no window. If it
    // is set, the device is opened with VK_KHR_swapchain, and devices that cannot present are
    // unusable.
    bool (*can_present)(void *context, struct VkInstance_T *instance,
                        struct VkPhysicalDevice_T *device, uint32_t queue_family);
    void *present_context;
    // Faults for tests: on every device opened with these parameters the n-th allocation or
    // submission (counted from 1, staging included) fails. 0: none fails.
    uint32_t fail_allocation, lose_device_at_submit;
    uint32_t devices_to_lose; // after this many losses devices work; 0: every device opened is lost
};

#endif
