// Separable filters on planes of floats.
#ifndef LAMPYRIS_METRICS_CONVOLVE_H
#define LAMPYRIS_METRICS_CONVOLVE_H

#include "base/progress.h"
#include <stdbool.h>
#include <stdint.h>

// Weights of the offsets -radius … radius.
struct kernel_1d {
    int radius;
    double weight[257]; // radius at most 128
};

#define KERNEL_RADIUS_MAX 128

// out = the plane filtered by `x` along rows and by `y` along columns; beyond the border the
// outermost values go on. `scratch` and `out`: width * height, neither may be `plane`. False where
// `progress`, which may be NULL, asked to stop; `out` is then incomplete.
bool convolve(const float *plane, uint32_t width, uint32_t height, const struct kernel_1d *x,
              const struct kernel_1d *y, const struct progress *progress, float *scratch,
              float *out);

#endif
