// Functions of a single pixel for the metrics.
#ifndef LAMPYRIS_METRICS_PIXEL_H
#define LAMPYRIS_METRICS_PIXEL_H

#include <math.h>
#include <stdbool.h>

static inline bool pixel_is_finite(const float pixel[3])
{
    return isfinite(pixel[0]) && isfinite(pixel[1]) && isfinite(pixel[2]);
}

// Returns the display value of a linear value: clamped to [0, 1] and encoded by the transfer
// function of sRGB (IEC 61966-2-1).
static inline double display_value(double linear)
{
    double x = fmin(fmax(linear, 0), 1);
    return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
}

#endif
