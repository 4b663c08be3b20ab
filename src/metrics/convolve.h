// Separable filters for images with one float per pixel.
#ifndef LAMPYRIS_METRICS_CONVOLVE_H
#define LAMPYRIS_METRICS_CONVOLVE_H

#include "base/progress.h"
#include <stdbool.h>
#include <stdint.h>

// A filter in one dimension: the weights for the offsets -radius … radius.
struct kernel_1d {
    int radius;
    double weight[257]; // radius at most 128
};

#define KERNEL_RADIUS_MAX 128

// Filters a plane by `x` along rows and by `y` along columns. Beyond the border, the values at the
// border are repeated. `plane`, `scratch` and `out` are distinct and have width * height elements
// each. `progress` may be NULL. Returns false if it requests a stop; `out` is then incomplete.
bool convolve(const float *plane, uint32_t width, uint32_t height, const struct kernel_1d *x,
              const struct kernel_1d *y, const struct progress *progress, float *scratch,
              float *out);

#endif
