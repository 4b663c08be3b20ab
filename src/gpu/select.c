// Lists the devices, tests whether the renderer can use them, and selects one.
#include "base/memory.h"
#include "gpu/gpu_internal.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct device_properties {
    VkPhysicalDeviceIDProperties id;
    VkPhysicalDeviceProperties core;
    VkPhysicalDeviceSubgroupProperties subgroup;
    VkPhysicalDeviceMaintenance3Properties maintenance;
    VkPhysicalDeviceFloatControlsProperties floats; // 0 if the rounding mode is fixed
    VkPhysicalDeviceDriverProperties driver;        // empty if the driver is unnamed
    VkResult failure; // the error that occurred when the extensions were listed
};

bool device_has_extension(VkPhysicalDevice device, const char *name, VkResult *failure)
{
    uint32_t count = 0;
    VkExtensionProperties *list = NULL;
    bool found = false;
    VkResult result = vkEnumerateDeviceExtensionProperties(device, NULL, &count, NULL);
    if (result == VK_SUCCESS) {
        list = calloc(count + 1, sizeof *list);
        result = list ? vkEnumerateDeviceExtensionProperties(device, NULL, &count, list)
                      : VK_ERROR_OUT_OF_HOST_MEMORY;
    }
    for (uint32_t i = 0; result >= VK_SUCCESS && i < count; i++)
        found |= strcmp(list[i].extensionName, name) == 0;
    free(list);
    if (result < VK_SUCCESS && failure)
        *failure = result;
    return found;
}

// Reads the properties of a device. Only the core part is filled in for Vulkan versions below 1.1.
// With the override api-1.1 the version is 1.1, and extensions that only provide information are
// ignored.
static void properties_read(const struct gpu *gpu, VkPhysicalDevice device,
                            struct device_properties *out)
{
    bool is_1_1 = gpu->params.limits.api_1_1;
    *out = (struct device_properties){
        .subgroup.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES,
        .maintenance.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES,
        .floats.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FLOAT_CONTROLS_PROPERTIES,
        .driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES,
        .id.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES,
    };
    vkGetPhysicalDeviceProperties(device, &out->core);
    if (out->core.apiVersion < VK_API_VERSION_1_1)
        return;
    if (is_1_1)
        out->core.apiVersion = VK_API_VERSION_1_1;
    VkPhysicalDeviceProperties2 all = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
        .pNext = &out->subgroup,
    };
    out->subgroup.pNext = &out->id;
    out->id.pNext = &out->maintenance;
    if (!is_1_1 && device_has_extension(device, VK_KHR_DRIVER_PROPERTIES_EXTENSION_NAME, NULL))
        out->maintenance.pNext = &out->driver;
    if (device_has_extension(device, VK_KHR_SHADER_FLOAT_CONTROLS_EXTENSION_NAME, &out->failure)) {
        out->floats.pNext = out->maintenance.pNext;
        out->maintenance.pNext = &out->floats;
    }
    vkGetPhysicalDeviceProperties2(device, &all);
}

static bool family_suffices(const struct gpu *gpu, VkPhysicalDevice device, uint32_t family,
                            VkQueueFlags flags)
{
    const struct gpu_params *params = &gpu->params;
    const VkQueueFlags needs =
        VK_QUEUE_COMPUTE_BIT | (params->graphics ? (VkQueueFlags)VK_QUEUE_GRAPHICS_BIT : 0);
    return (flags & needs) == needs &&
           (!params->can_present ||
            params->can_present(params->present_context, gpu->instance, device, family));
}

// Returns the first queue family that has all required capabilities and supports graphics, which is
// the most capable one on GPUs, or else the first with the required capabilities.
static uint32_t queue_family_find(const struct gpu *gpu, VkPhysicalDevice device,
                                  uint32_t *timestamp_bits)
{
    VkQueueFamilyProperties families[32];
    uint32_t count = 32, found = UINT32_MAX;
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families);
    for (uint32_t i = count; i-- > 0;) {
        VkQueueFlags flags = families[i].queueFlags;
        bool found_draws =
            found != UINT32_MAX && (families[found].queueFlags & VK_QUEUE_GRAPHICS_BIT);
        if (((flags & VK_QUEUE_GRAPHICS_BIT) || !found_draws) &&
            family_suffices(gpu, device, i, flags))
            found = i;
    }
    *timestamp_bits = found == UINT32_MAX ? 0 : families[found].timestampValidBits;
    return found;
}

// Returns the index of the largest device-local heap, or UINT32_MAX if there is none.
static uint32_t largest_heap(const VkPhysicalDeviceMemoryProperties *memory)
{
    uint32_t found = UINT32_MAX;
    for (uint32_t i = 0; i < memory->memoryHeapCount; i++)
        if ((memory->memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) &&
            (found == UINT32_MAX || memory->memoryHeaps[i].size > memory->memoryHeaps[found].size))
            found = i;
    return found;
}

static uint64_t device_memory_bytes(VkPhysicalDevice device)
{
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(device, &memory);
    uint32_t heap = largest_heap(&memory);
    return heap == UINT32_MAX ? 0 : memory.memoryHeaps[heap].size;
}

static uint64_t left_of(uint64_t most, uint64_t used)
{
    return most > used ? most - used : 0;
}

static uint64_t heap_free(const struct gpu *gpu)
{
    VkPhysicalDeviceMemoryBudgetPropertiesEXT budget = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT,
    };
    VkPhysicalDeviceMemoryProperties2 memory = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2,
    };
    bool has_budget =
        !gpu->params.limits.api_1_1 &&
        device_has_extension(gpu->physical, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME, NULL);
    if (has_budget)
        memory.pNext = &budget;
    vkGetPhysicalDeviceMemoryProperties2(gpu->physical, &memory);
    uint32_t heap = largest_heap(&memory.memoryProperties);
    if (heap == UINT32_MAX)
        return 0;
    return has_budget
               ? left_of(budget.heapBudget[heap], budget.heapUsage[heap])
               : left_of(memory.memoryProperties.memoryHeaps[heap].size, gpu->allocated_bytes);
}

// CPU drivers report a heap of arbitrary size, so for them only the host's free memory counts.
static uint64_t all_memory_free(const struct gpu *gpu)
{
    uint64_t told = gpu->params.limits.memory_budget;
    uint64_t bytes = gpu->info.is_cpu ? UINT64_MAX : heap_free(gpu);
    if (told && left_of(told, gpu->allocated_bytes) < bytes)
        bytes = left_of(told, gpu->allocated_bytes);
    uint64_t host = gpu->info.shares_memory ? memory_available() : UINT64_MAX;
    return bytes < host ? bytes : host;
}

uint64_t gpu_memory_free(const struct gpu *gpu)
{
    const uint64_t bytes = all_memory_free(gpu);
    const uint64_t share =
        gpu->sharers > 1 ? left_of(gpu->share_bytes, gpu->allocated_bytes) : UINT64_MAX;
    return bytes < share ? bytes : share;
}

void gpu_share_memory(struct gpu *gpu, uint32_t sharers)
{
    gpu->sharers = sharers;
    gpu->share_bytes = all_memory_free(gpu) / sharers + gpu->allocated_bytes;
    gpu->host_share_bytes = memory_available() / sharers + gpu->allocated_bytes;
}

uint64_t gpu_host_memory_free(const struct gpu *gpu)
{
    const uint64_t bytes = memory_available();
    const uint64_t share = gpu->sharers > 1 && gpu->info.shares_memory
                               ? left_of(gpu->host_share_bytes, gpu->allocated_bytes)
                               : UINT64_MAX;
    return bytes < share ? bytes : share;
}

void device_find_lacks(const VkPhysicalDeviceProperties *device, uint32_t queue_family, char *out,
                       size_t size)
{
    const VkPhysicalDeviceLimits *l = &device->limits;
    // The number of buffers that are bound at once is checked for each kernel: see layout.c.
    const struct {
        const char *name;
        uint32_t value, need;
    } limits[] = {
        {"maxPerStageResources", l->maxPerStageResources, GPU_MAX_BINDINGS},
        {"maxPushConstantsSize", l->maxPushConstantsSize, GPU_PUSH_BYTES},
        {"maxComputeWorkGroupInvocations", l->maxComputeWorkGroupInvocations, GPU_MIN_INVOCATIONS},
        {"maxComputeWorkGroupSize[0]", l->maxComputeWorkGroupSize[0], GPU_MIN_INVOCATIONS},
    };
    out[0] = '\0';
    if (device->apiVersion < VK_API_VERSION_1_1) {
        snprintf(out, size, "it supports Vulkan %u.%u, expected at least 1.1",
                 VK_API_VERSION_MAJOR(device->apiVersion),
                 VK_API_VERSION_MINOR(device->apiVersion));
        return;
    }
    if (queue_family == UINT32_MAX) {
        snprintf(out, size, "no queue family supports compute");
        return;
    }
    for (size_t i = 0, used = 0; i < sizeof limits / sizeof limits[0] && used < size; i++)
        if (limits[i].value < limits[i].need)
            used +=
                (size_t)snprintf(out + used, size - used, "%s%s is %u, expected at least %u",
                                 used ? "; " : "", limits[i].name, limits[i].value, limits[i].need);
}

// Tests the additional requirements of a program with a window.
static void find_window_lacks(const struct gpu *gpu, VkPhysicalDevice device, uint32_t queue_family,
                              char *out, size_t size)
{
    const struct gpu_params *params = &gpu->params;
    if (params->can_present &&
        !device_has_extension(device, VK_KHR_SWAPCHAIN_EXTENSION_NAME, NULL)) {
        snprintf(out, size,
                 "the extension " VK_KHR_SWAPCHAIN_EXTENSION_NAME
                 " is missing, which windows need");
    } else if (queue_family == UINT32_MAX && (params->graphics || params->can_present)) {
        const char *draws = !params->graphics     ? ""
                            : params->can_present ? ", graphics"
                                                  : " and graphics";
        snprintf(out, size, "no queue family supports compute%s%s", draws,
                 params->can_present ? " and presentation to a window" : "");
    }
}

static const char *kind_name(VkPhysicalDeviceType type)
{
    switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
        return "discrete GPU";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
        return "integrated GPU";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
        return "virtual GPU";
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
        return "CPU";
    default:
        return "other";
    }
}

static void info_read(const struct gpu *gpu, VkPhysicalDevice device, uint32_t index,
                      struct gpu_device_info *out)
{
    struct device_properties p;
    properties_read(gpu, device, &p);
    uint32_t timestamp_bits;
    uint32_t family = queue_family_find(gpu, device, &timestamp_bits);
    *out = (struct gpu_device_info){
        .index = index,
        .kind = kind_name(p.core.deviceType),
        .is_cpu = p.core.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU,
        .shares_memory = p.core.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU ||
                         p.core.deviceType == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU,
        .api_version = p.core.apiVersion,
        .memory_bytes = device_memory_bytes(device),
    };
    if (!out->shares_memory)
        memcpy(out->memory_id, p.id.deviceUUID, sizeof out->memory_id);
    snprintf(out->name, sizeof out->name, "%s", p.core.deviceName);
    // The encoding of driverVersion depends on the vendor, so the text driverInfo is preferred.
    if (p.driver.driverInfo[0])
        snprintf(out->driver, sizeof out->driver, "%s %s", p.driver.driverName,
                 p.driver.driverInfo);
    else
        snprintf(out->driver, sizeof out->driver, "%s%sversion 0x%x", p.driver.driverName,
                 p.driver.driverName[0] ? " " : "", p.core.driverVersion);
    find_window_lacks(gpu, device, family, out->unusable, sizeof out->unusable);
    if (!out->unusable[0])
        device_find_lacks(&p.core, family, out->unusable, sizeof out->unusable);
}

struct device_list {
    VkPhysicalDevice handles[GPU_MAX_DEVICES];
    struct gpu_device_info infos[GPU_MAX_DEVICES];
    uint32_t count;
};

static bool list_read(struct gpu *gpu, struct device_list *out, struct err *err)
{
    out->count = GPU_MAX_DEVICES;
    VkResult result = vkEnumeratePhysicalDevices(gpu->instance, &out->count, out->handles);
    // Loaders report a failed initialization if none of the drivers has found a device.
    if (result == VK_ERROR_INITIALIZATION_FAILED || (result == VK_SUCCESS && out->count == 0))
        return err_set(err, ERR_NO_VULKAN, "the Vulkan drivers that are installed have no device");
    if (result != VK_SUCCESS && result != VK_INCOMPLETE)
        return gpu_fail(gpu, "vkEnumeratePhysicalDevices", result, err);
    for (uint32_t i = 0; i < out->count; i++)
        info_read(gpu, out->handles[i], i, &out->infos[i]);
    return true;
}

bool gpu_list_devices(struct gpu_device_info out[GPU_MAX_DEVICES], uint32_t *count, struct err *err)
{
    struct gpu gpu = {0};
    struct device_list list;
    bool ok = instance_create(&gpu, err) && list_read(&gpu, &list, err);
    *count = ok ? list.count : 0;
    if (ok)
        memcpy(out, list.infos, list.count * sizeof *out);
    instance_destroy(&gpu);
    return ok;
}

// Returns a rank of the kind of device: the lower, the faster.
static int kind_rank(const struct gpu_device_info *info)
{
    static const char *const order[] = {"discrete GPU", "integrated GPU", "virtual GPU", "CPU"};
    int rank = 0;
    while (rank < 4 && strcmp(info->kind, order[rank]) != 0)
        rank++;
    return rank;
}

static bool contains_ignoring_case(const char *text, const char *part)
{
    for (; *text; text++) {
        size_t i = 0;
        while (part[i] && tolower((unsigned char)text[i]) == tolower((unsigned char)part[i]))
            i++;
        if (!part[i])
            return true;
    }
    return !*part;
}

// Returns whether `wanted` means this device: as its index if it is a number below `count`, or as a
// part of its name. A number of one or two digits is only an index, because most names contain
// digits; "4090" is part of a name.
static bool wants(const char *wanted, const struct gpu_device_info *info, uint32_t count)
{
    if (!wanted)
        return true;
    char *end;
    unsigned long index = strtoul(wanted, &end, 10);
    if (isdigit((unsigned char)wanted[0]) && !*end && (index < count || end - wanted <= 2))
        return index == info->index;
    return contains_ignoring_case(info->name, wanted);
}

// Returns the index of the best matching device: usable ones first, then by kind, then in the
// loader's order. Returns UINT32_MAX if none matches.
static uint32_t list_choose(const struct device_list *list, const char *wanted)
{
    uint32_t best = UINT32_MAX;
    int best_score = 0;
    for (uint32_t i = 0; i < list->count; i++) {
        const struct gpu_device_info *info = &list->infos[i];
        int score = kind_rank(info) + (info->unusable[0] ? 100 : 0);
        if (wants(wanted, info, list->count) && (best == UINT32_MAX || score < best_score)) {
            best = i;
            best_score = score;
        }
    }
    return best;
}

static bool unknown_device(const struct device_list *list, const char *wanted, struct err *err)
{
    char names[400] = "";
    for (uint32_t i = 0; i < list->count; i++) {
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%u: %s", i ? ", " : "", i,
                 list->infos[i].name);
    }
    return err_set(err, ERR_USAGE, "no device has the index or name '%s'; the devices are: %s",
                   wanted, names);
}

bool device_select(struct gpu *gpu, struct err *err)
{
    struct device_list list;
    if (!list_read(gpu, &list, err))
        return false;
    uint32_t chosen = list_choose(&list, gpu->params.device);
    if (chosen == UINT32_MAX)
        return unknown_device(&list, gpu->params.device, err);
    gpu->info = list.infos[chosen];
    gpu->physical = list.handles[chosen];
    if (gpu->info.unusable[0])
        return err_set(err, ERR_GPU, "%s cannot be used: %s", gpu->info.name, gpu->info.unusable);
    return true;
}

static uint64_t lowered(uint64_t limit, uint64_t override)
{
    return override && override < limit ? override : limit;
}

// Returns how many bindings of a kind are usable: the least of the renderer's maximum, the device's
// limits per stage and per set, and the override.
static uint32_t binding_count(uint32_t most, uint32_t a_stage, uint32_t a_set, uint64_t override)
{
    return (uint32_t)lowered(lowered(lowered(most, a_stage), a_set), override);
}

// Returns whether the rounding mode for 32 bits can be set separately from that for other widths.
static bool can_round_to_nearest(const VkPhysicalDeviceFloatControlsProperties *p)
{
    return p->shaderRoundingModeRTEFloat32 &&
           p->roundingModeIndependence != VK_SHADER_FLOAT_CONTROLS_INDEPENDENCE_NONE;
}

bool device_read_limits(struct gpu *gpu, struct err *err)
{
    struct device_properties p;
    properties_read(gpu, gpu->physical, &p);
    // An unknown rounding mode could change the bits of images, so this is an error.
    if (p.failure < VK_SUCCESS)
        return gpu_fail(gpu, "vkEnumerateDeviceExtensionProperties", p.failure, err);
    const VkPhysicalDeviceLimits *limits = &p.core.limits;
    const struct gpu_limit_overrides *lower = &gpu->params.limits;
    const VkSubgroupFeatureFlags ballot =
        VK_SUBGROUP_FEATURE_BASIC_BIT | VK_SUBGROUP_FEATURE_VOTE_BIT |
        VK_SUBGROUP_FEATURE_ARITHMETIC_BIT | VK_SUBGROUP_FEATURE_BALLOT_BIT;

    gpu->max_storage_range = lowered(limits->maxStorageBufferRange, lower->storage_range);
    gpu->max_texel_elements =
        lower->no_texel ? 0 : lowered(limits->maxTexelBufferElements, lower->texel_elements);
    gpu->storage_count =
        binding_count(GPU_MAX_STORAGE, limits->maxPerStageDescriptorStorageBuffers,
                      limits->maxDescriptorSetStorageBuffers, lower->storage_count);
    // Uniform texel buffers count as sampled images (Vulkan specification, "Required Limits").
    gpu->texel_count = binding_count(GPU_MAX_TEXEL, limits->maxPerStageDescriptorSampledImages,
                                     limits->maxDescriptorSetSampledImages, lower->texel_count);
    gpu->max_allocation = lowered(p.maintenance.maxMemoryAllocationSize, lower->allocation);
    gpu->storage_alignment = limits->minStorageBufferOffsetAlignment;
    gpu->max_groups = limits->maxComputeWorkGroupCount[0];
    gpu->max_invocations = limits->maxComputeWorkGroupInvocations;
    if (limits->maxComputeWorkGroupSize[0] < gpu->max_invocations)
        gpu->max_invocations = limits->maxComputeWorkGroupSize[0];
    gpu->max_shared_bytes = lowered(limits->maxComputeSharedMemorySize, lower->shared_memory);
    gpu->subgroup_size = p.subgroup.subgroupSize;
    gpu->has_ballot = !lower->no_ballot &&
                      (p.subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) &&
                      (p.subgroup.supportedOperations & ballot) == ballot;
    gpu->rounds_to_nearest = !lower->no_rounding_mode && can_round_to_nearest(&p.floats);

    uint32_t timestamp_bits;
    gpu->queue_family = queue_family_find(gpu, gpu->physical, &timestamp_bits);
    gpu->has_timestamps = timestamp_bits > 0 && !lower->no_timestamps;
    gpu->timestamp_ns = (double)limits->timestampPeriod;
    gpu->timestamp_mask = timestamp_bits >= 64 ? UINT64_MAX : (UINT64_C(1) << timestamp_bits) - 1;
    return true;
}
