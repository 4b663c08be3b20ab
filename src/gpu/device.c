// Opens and closes a device.
#include "base/memory.h"
#include "gpu/gpu_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool device_create(struct gpu *gpu, struct err *err)
{
    // The specification requires that VK_KHR_portability_subset is enabled where a device offers
    // it.
    const char *const portability = "VK_KHR_portability_subset";
    const char *extensions[4];
    uint32_t extension_count = 0;
    VkResult failure = VK_SUCCESS;
    if (device_has_extension(gpu->physical, portability, &failure))
        extensions[extension_count++] = portability;
    if (failure < VK_SUCCESS)
        return gpu_fail(gpu, "vkEnumerateDeviceExtensionProperties", failure, err);
    if (gpu->params.can_present)
        extensions[extension_count++] = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
    if (gpu->rounds_to_nearest)
        extensions[extension_count++] = VK_KHR_SHADER_FLOAT_CONTROLS_EXTENSION_NAME;
    const VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR statistics = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR,
        .pipelineExecutableInfo = VK_TRUE,
    };
    if (gpu->params.statistics)
        extensions[extension_count++] = VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME;
    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queue = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
        .queueFamilyIndex = gpu->queue_family,
        .queueCount = 1,
        .pQueuePriorities = &priority,
    };
    const VkDeviceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
        .pNext = gpu->params.statistics ? &statistics : NULL,
        .queueCreateInfoCount = 1,
        .pQueueCreateInfos = &queue,
        .enabledExtensionCount = extension_count,
        .ppEnabledExtensionNames = extensions,
    };
    if (!VK(gpu, err, vkCreateDevice(gpu->physical, &info, NULL, &gpu->device)))
        return false;
    vkGetDeviceQueue(gpu->device, gpu->queue_family, 0, &gpu->queue);
    return true;
}

// Drivers compile kernels within this process. Mesa's CPU driver (22.3) does not return an error if
// the address space is too small, but ends the process by a signal: with `ulimit -v` from 300 to
// 700 MB, but not with 800 MB.
static bool check_address_space(struct err *err)
{
    const uint64_t least = UINT64_C(720) << 20;
    uint64_t left = memory_limits_left();
    return left >= least ||
           err_set(err, ERR_GPU,
                   "the limits of this process (ulimit -v, ulimit -d) leave %s; expected at least "
                   "%s, which a driver may need to compile kernels",
                   memory_print(left).text, memory_print(least).text);
}

bool gpu_open(const struct gpu_params *params, struct gpu *out, struct err *err)
{
    *out = (struct gpu){0};
    if (params)
        out->params = *params;
    if (!check_address_space(err) || !limits_from_environment(&out->params.limits, err) ||
        !instance_create(out, err) || !device_select(out, err))
        goto fail;
    if (!device_read_limits(out, err) || !device_create(out, err) || !layouts_create(out, err) ||
        !pipeline_cache_create(out, err)) {
        err_prepend(err, "%s", out->info.name);
        goto fail;
    }
    // These pointers belong to the caller, who may free what they point to after this call.
    out->params.device = NULL;
    out->params.instance_extensions = NULL;
    out->params.present_context = NULL;
    return true;
fail:
    gpu_close(out);
    return false;
}

bool gpu_reopen(struct gpu *gpu, struct err *err)
{
    char index[16];
    struct gpu_params params = gpu->params;
    const struct gpu_device_info info = gpu->info;
    const uint32_t messages = gpu->validation_messages, sharers = gpu->sharers;
    const uint64_t share_bytes = gpu->share_bytes, host_share_bytes = gpu->host_share_bytes;
    snprintf(index, sizeof index, "%u", info.index);
    params.device = index;
    if (params.devices_to_lose > 0 && --params.devices_to_lose == 0)
        params.lose_device_at_submit = 0;
    gpu_close(gpu);
    bool ok = gpu_open(&params, gpu, err);
    if (ok && strcmp(gpu->info.name, info.name) != 0) {
        ok = err_set(err, ERR_GPU, "device %s cannot be opened again: its index now belongs to %s",
                     info.name, gpu->info.name);
        gpu_close(gpu);
    }
    if (!ok) {
        gpu->info = info;
        gpu->lost = true;
    }
    gpu->validation_messages += messages;
    gpu->sharers = sharers;
    gpu->share_bytes = share_bytes;
    gpu->host_share_bytes = host_share_bytes;
    return ok;
}

void gpu_close(struct gpu *gpu)
{
    if (!gpu)
        return;
    if (gpu->device)
        gpu_settle(gpu);
    transfers_destroy(gpu);
    if (gpu->abandoned) {
        layouts_destroy(gpu);
        *gpu = (struct gpu){.validation_messages = gpu->validation_messages};
        return;
    }
    if (gpu->device) {
        kernels_destroy(gpu);
        layouts_destroy(gpu);
        vkDestroyDevice(gpu->device, NULL);
    }
    instance_destroy(gpu);
    *gpu = (struct gpu){.validation_messages = gpu->validation_messages};
}
