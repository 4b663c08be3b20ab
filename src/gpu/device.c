// Opening and closing a device.
#include "gpu_internal.h"
#include <stdlib.h>
#include <string.h>

// Sets *found; a device that offers this extension obliges us to enable it.
static bool portability_subset_find(struct gpu *gpu, bool *found, struct err *err)
{
    *found = false;
    uint32_t count = 0;
    if (!VK(gpu, err, vkEnumerateDeviceExtensionProperties(gpu->physical, NULL, &count, NULL)))
        return false;
    VkExtensionProperties *list = calloc(count + 1, sizeof *list);
    if (!list)
        return err_memory(err, "the list of device extensions", count * sizeof *list);
    bool ok = VK(gpu, err, vkEnumerateDeviceExtensionProperties(gpu->physical, NULL, &count, list));
    for (uint32_t i = 0; ok && i < count; i++)
        *found |= strcmp(list[i].extensionName, "VK_KHR_portability_subset") == 0;
    free(list);
    return ok;
}

static bool device_create(struct gpu *gpu, struct err *err)
{
    bool portability;
    if (!portability_subset_find(gpu, &portability, err))
        return false;
    const char *extensions[] = {"VK_KHR_portability_subset"};
    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queue = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
        .queueFamilyIndex = gpu->queue_family,
        .queueCount = 1,
        .pQueuePriorities = &priority,
    };
    const VkDeviceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
        .queueCreateInfoCount = 1,
        .pQueueCreateInfos = &queue,
        .enabledExtensionCount = portability ? 1 : 0,
        .ppEnabledExtensionNames = extensions,
    };
    if (!VK(gpu, err, vkCreateDevice(gpu->physical, &info, NULL, &gpu->device)))
        return false;
    vkGetDeviceQueue(gpu->device, gpu->queue_family, 0, &gpu->queue);
    return true;
}

bool gpu_open(const struct gpu_params *params, struct gpu *out, struct err *err)
{
    *out = (struct gpu){0};
    if (params)
        out->params = *params;
    if (!limits_from_environment(&out->params.limits, err) || !instance_create(out, err) ||
        !device_select(out, err))
        goto fail;
    out->params.device = NULL; // the caller's string, not needed any more
    device_read_limits(out);
    if (!device_create(out, err) || !layouts_create(out, err)) {
        err_prepend(err, "%s", out->info.name);
        goto fail;
    }
    return true;
fail:
    gpu_close(out);
    return false;
}

void gpu_close(struct gpu *gpu)
{
    if (!gpu)
        return;
    if (gpu->device) {
        vkDeviceWaitIdle(gpu->device); // fails on a lost device, which is as idle as can be
        kernels_destroy(gpu);
        layouts_destroy(gpu);
        vkDestroyDevice(gpu->device, NULL);
    }
    instance_destroy(gpu);
    *gpu = (struct gpu){.validation_messages = gpu->validation_messages};
}
