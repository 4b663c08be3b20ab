// The texel of an environment image in a direction, in double precision.
#ifndef LAMPYRIS_TESTS_ENVIRONMENT_TEXEL_H
#define LAMPYRIS_TESTS_ENVIRONMENT_TEXEL_H

#include "scene/core/environment.h"
#include <math.h>

// The texel in which a unit direction of the image lies, row * width + column.
static inline uint32_t environment_texel(const struct environment *environment,
                                         const double direction[3])
{
    double u = 0.5 + atan2(direction[2], direction[0]) / (2 * M_PI);
    double v = acos(fmin(fmax(direction[1], -1), 1)) / M_PI;
    uint32_t column = (uint32_t)(u * environment->width), row = (uint32_t)(v * environment->height);
    if (column >= environment->width)
        column = environment->width - 1;
    if (row >= environment->height)
        row = environment->height - 1;
    return row * environment->width + column;
}

#endif
