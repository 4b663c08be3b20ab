// Parameters of a device, without Vulkan's long header.
#ifndef LAMPYRIS_GPU_PARAMS_H
#define LAMPYRIS_GPU_PARAMS_H

#include <stdbool.h>
#include <stdint.h>

struct VkInstance_T; // VkInstance and VkPhysicalDevice point to these
struct VkPhysicalDevice_T;

// Lower limits than the device's, to test fallbacks; 0 means the device's own. Members that are 0
// or false are taken from the environment variable LAMPYRIS_LIMITS, so that any program and any
// test can be run with the fallbacks: words separated by commas, out of api-1.1, no-texel,
// no-ballot, no-rounding-mode, no-mapped-device, no-timestamps, shared-stack, sort-rays,
// storage-range=BYTES, storage-count=N, texel-count=N, texel-elements=N, allocation=BYTES,
// shared-memory=BYTES, memory=BYTES, memory-budget=BYTES, group-ns=N, watchdog-ms=N, waves=N. Other
// words are ERR_USAGE.
struct gpu_limit_overrides {
    uint64_t storage_range;  // maxStorageBufferRange, bytes
    uint64_t storage_count;  // storage buffers that a kernel may bind
    uint64_t texel_count;    // uniform texel buffers likewise
    uint64_t texel_elements; // maxTexelBufferElements
    uint64_t allocation;     // largest VkDeviceMemory, bytes
    uint64_t shared_memory;  // maxComputeSharedMemorySize, bytes
    uint64_t memory;         // sum of all allocations: allocations that exceed it fail
    uint64_t memory_budget;  // the budget that the driver reports before anything is allocated
    bool api_1_1;            // a device of Vulkan 1.1 that does not say its driver's name
    // A simulated slow device: the time of a workgroup, and the longest time of a submission before
    // the device is lost.
    uint64_t group_ns, watchdog_ms;
    uint64_t
        waves; // in flight, 1 or 2: no limit, but a choice of the device's that is taken from it
    bool no_texel;         // SSBO reads only
    bool no_ballot;        // without subgroup ballot
    bool no_rounding_mode; // without a choice of how sums are rounded
    bool no_mapped_device; // device memory is never mapped: uploads and downloads are staged
    bool no_timestamps;    // times of kernels are not measured
    bool shared_stack;     // traversal as on GPUs (shaders/lib/stack.glsl), on any device
    bool sort_rays;        // rays are sorted as on GPUs (shaders/lib/sort.glsl), on any device
};

struct gpu_params {
    const char *device; // index or part of a name, case-insensitive; NULL: the fastest kind
    bool validation;    // VK_LAYER_KHRONOS_validation with synchronization validation
    bool statistics;    // statistics of compiled kernels are kept: see gpu_kernel_statistics
    struct gpu_limit_overrides limits;
    // For a program with a window; all zero: compute only.
    bool graphics;                          // the queue also draws: see screen.h
    const char *const *instance_extensions; // for surfaces
    uint32_t instance_extension_count;
    // Returns whether a queue family can present; NULL: not needed. With it, the device has
    // VK_KHR_swapchain. Devices that cannot present are unusable, and report why.
    bool (*can_present)(void *context, struct VkInstance_T *instance,
                        struct VkPhysicalDevice_T *device, uint32_t queue_family);
    void *present_context;
    // Faults for tests: fail the n-th (from 1) allocation / submission, including staging, of every
    // device that is opened with these parameters; 0: never.
    uint32_t fail_allocation, lose_device_at_submit;
    uint32_t devices_to_lose; // after this many losses, devices work; 0: none is lost
};

#endif
