// Separable filters on planes of floats.
#ifndef LAMPYRIS_METRICS_CONVOLVE_H
#define LAMPYRIS_METRICS_CONVOLVE_H

#include "base/progress.h"
#include <stdbool.h>
#include <stdint.h>

// Weights for the offsets -radius … radius.
struct kernel_1d {
    int radius;
    double weight[257]; // radius at most 128
};

#define KERNEL_RADIUS_MAX 128

// Computes out = the plane filtered by `x` along rows and by `y` along columns; the outermost
// values are extended beyond the border. `scratch` and `out` have width * height elements, and
// neither may be `plane`. Returns false if `progress`, which may be NULL, requests a stop; `out` is
// then incomplete.
bool convolve(const float *plane, uint32_t width, uint32_t height, const struct kernel_1d *x,
              const struct kernel_1d *y, const struct progress *progress, float *scratch,
              float *out);

#endif
