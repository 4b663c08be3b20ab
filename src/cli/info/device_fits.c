#include "cli/info/device_fits.h"

#include "base/memory.h"
#include "cli/scene_options.h"
#include "render/render.h"
#include "report/json_out.h"
#include "report/text_out.h"
#include <stdio.h>

static bool prepare(const struct options *options, const struct scene *scene,
                    const struct geometry *geometry, uint32_t camera, struct device_fit *fit,
                    struct err *err)
{
    char index[16];
    struct gpu gpu = {0};
    struct renderer renderer = {0};
    struct gpu_params of_gpu = options->device.gpu;
    snprintf(index, sizeof index, "%u", fit->device.index);
    of_gpu.device = index;
    bool ok = gpu_open(&of_gpu, &gpu, err);
    if (ok) {
        fit->left = gpu_memory_free(&gpu);
        struct renderer_params params =
            options_renderer_params(&options->device, &gpu, scene, camera);
        params.geometry = geometry;
        params.progress = options->progress;
        ok = renderer_prepare(&params, &renderer, err);
    }
    if (ok) {
        fit->bytes = renderer.plan.total_bytes;
        fit->wave = renderer.plan.wave_slots;
    }
    renderer_finish(&renderer);
    gpu_close(&gpu);
    return ok;
}

bool device_fits_find(const struct options *options, const struct scene *scene,
                      const struct geometry *geometry, uint32_t camera, struct device_fits *out,
                      struct err *err)
{
    struct gpu_device_info devices[GPU_MAX_DEVICES];
    if (!gpu_list_devices(devices, &out->count, err))
        return false;
    for (uint32_t i = 0; i < out->count; i++) {
        struct device_fit *fit = &out->list[i];
        struct err failure = {0};
        *fit = (struct device_fit){.device = devices[i]};
        if (prepare(options, scene, geometry, camera, fit, &failure))
            continue;
        if (failure.code == ERR_STOPPED) {
            *err = failure;
            return false;
        }
        snprintf(fit->reason, sizeof fit->reason, "%s", failure.msg);
    }
    return true;
}

void device_fits_print(const struct device_fits *fits)
{
    for (uint32_t i = 0; i < fits->count; i++) {
        const struct device_fit *fit = &fits->list[i];
        printf("%s%2u: ", i == 0 ? "devices   " : "          ", fit->device.index);
        print_words(fit->device.name);
        if (fit->reason[0]) {
            fputs(": does not fit: ", stdout);
            print_words(fit->reason);
            putchar('\n');
            continue;
        }
        printf(": fits, %s", memory_print(fit->bytes).text);
        printf(" of %s that are left, wave of %u paths\n", memory_print(fit->left).text, fit->wave);
    }
}

json_t *device_fits_json(const struct device_fits *fits)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < fits->count; i++) {
        const struct device_fit *fit = &fits->list[i];
        json_array_append_new(
            array, json_pack("{s:i, s:o, s:o, s:I, s:I, s:b, s:I, s:i, s:o}", "index",
                             (int)fit->device.index, "name", json_words(fit->device.name), "driver",
                             json_words(fit->device.driver), "memory_bytes",
                             (json_int_t)fit->device.memory_bytes, "left_bytes",
                             (json_int_t)fit->left, "fits", !fit->reason[0], "bytes",
                             (json_int_t)fit->bytes, "wave", (int)fit->wave, "reason",
                             fit->reason[0] ? json_words(fit->reason) : json_null()));
    }
    return array;
}
