// Determines on which devices of the machine a scene fits (info --device all).
#ifndef LAMPYRIS_CLI_INFO_DEVICE_FITS_H
#define LAMPYRIS_CLI_INFO_DEVICE_FITS_H

#include "cli/options.h"
#include "flatten/geometry.h"
#include "gpu/gpu.h"

#include <jansson.h>

struct device_fit {
    struct gpu_device_info device;
    uint64_t left;    // free bytes of its memory
    uint64_t bytes;   // planned bytes; 0 if the scene does not fit
    uint32_t wave;    // paths in flight
    char reason[512]; // why it does not fit or the device cannot be used; "" if it fits
};

struct device_fits {
    struct device_fit list[GPU_MAX_DEVICES];
    uint32_t count;
};

// Plans a render of the scene on each device, without allocating anything there. Fails only if the
// devices cannot be listed, or if it is stopped.
bool device_fits_find(const struct options *options, const struct scene *scene,
                      const struct geometry *geometry, uint32_t camera, struct device_fits *out,
                      struct err *err);
void device_fits_print(const struct device_fits *fits);
json_t *device_fits_json(const struct device_fits *fits);

#endif
