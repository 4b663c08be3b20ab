// lampyris devices: lists the Vulkan devices, and marks the one that would be used.
#include "cli/commands.h"

#include "base/log.h"
#include "gpu/gpu.h"
#include "report/json_out.h"
#include <stdio.h>

struct device_list {
    struct gpu_device_info devices[GPU_MAX_DEVICES];
    uint32_t count;
    uint32_t chosen; // index; UINT32_MAX if no device can be used
};

// Finds the device that would be used by opening it as `render` does, so that it is certain to
// work.
static bool find_chosen(const struct options *options, struct device_list *list, struct err *err)
{
    struct gpu gpu = {0};
    list->chosen = UINT32_MAX;
    if (!gpu_open(&options->device.gpu, &gpu, err))
        return false;
    list->chosen = gpu.info.index;
    gpu_close(&gpu);
    return true;
}

static void print_text(const struct device_list *list)
{
    for (uint32_t i = 0; i < list->count; i++) {
        const struct gpu_device_info *device = &list->devices[i];
        printf("%c %u: %s (%s)\n", device->index == list->chosen ? '*' : ' ', device->index,
               device->name, device->kind);
        printf("     driver %s, Vulkan %u.%u.%u, %.1f GiB\n", device->driver,
               VK_API_VERSION_MAJOR(device->api_version), VK_API_VERSION_MINOR(device->api_version),
               VK_API_VERSION_PATCH(device->api_version),
               (double)device->memory_bytes / (double)(UINT64_C(1) << 30));
        if (device->unusable[0])
            printf("     cannot be used: %s\n", device->unusable);
    }
    if (list->chosen != UINT32_MAX)
        printf("* would be used%s\n",
               list->devices[list->chosen].is_cpu ? "; it runs on the processor" : "");
}

static json_t *device_json(const struct gpu_device_info *device, bool chosen)
{
    char version[32];
    snprintf(version, sizeof version, "%u.%u.%u", VK_API_VERSION_MAJOR(device->api_version),
             VK_API_VERSION_MINOR(device->api_version), VK_API_VERSION_PATCH(device->api_version));
    return json_pack("{s:i, s:o, s:o, s:s, s:b, s:s, s:I, s:o, s:b}", "index", (int)device->index,
                     "name", json_words(device->name), "driver", json_words(device->driver), "kind",
                     device->kind, "cpu", device->is_cpu, "vulkan", version, "memory_bytes",
                     (json_int_t)device->memory_bytes, "unusable",
                     device->unusable[0] ? json_words(device->unusable) : json_null(), "chosen",
                     chosen);
}

static int print_json(const struct device_list *list)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < list->count; i++)
        json_array_append_new(
            array, device_json(&list->devices[i], list->devices[i].index == list->chosen));
    return command_print(json_pack("{s:o}", "devices", array));
}

int cmd_devices(const struct options *options)
{
    struct device_list list = {0};
    struct err err = {0};
    if (!gpu_list_devices(list.devices, &list.count, &err))
        return command_fail(&err);
    if (!find_chosen(options, &list, &err)) {
        // The list is useful even if no device can be used, so this is no error unless a device was
        // requested.
        if (options->device.gpu.device)
            return command_fail(&err);
        log_warn("no device can be used: %s", err.msg);
    }
    if (options->json)
        return print_json(&list);
    print_text(&list);
    return EXIT_CODE_OK;
}
