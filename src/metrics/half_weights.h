// What the half-buffers' error is divided by: 1 / (r^2 + epsilon) of a pixel, told by the pixels
// around it. Internal to the module.
#ifndef LAMPYRIS_METRICS_HALF_WEIGHTS_H
#define LAMPYRIS_METRICS_HALF_WEIGHTS_H

#include "metrics.h"

// Of pixels: the mean M = (A + B) / 2 of the halves and D = (A - B) / 2.
struct half_sums {
    double mean[3], squares[3]; // of M and M^2
    double products[6];         // of D: 00, 11, 22, 01, 02, 12
    double pixels;
};

// Adds pixel i, if it is finite.
void half_sums_add(struct half_sums *sums, const struct half_error_params *params, uint64_t i);
void half_sums_join(struct half_sums *sums, const struct half_sums *other);

enum { HALF_REACH = 4 };

// A pixel and those around it, each by itself: rows[HALF_REACH] is its own row, the others those
// above and below, NULL outside of the picture.
struct half_view {
    const struct half_sums *rows[2 * HALF_REACH + 1];
    uint32_t x, width;
};

struct half_weight {
    double weight[3]; // 1 / (r^2 + epsilon) of each channel, over 3
    double noise[6];  // mean products of D of the pixels that this one is like
    bool structured;  // the weights do not come from all pixels around
    double doubt;     // then: variance of sum weight D^2, as far as it comes from the weights
};

// `around` is of its neighbours within the filter's radius, of which there must be one at least.
void half_weigh(const struct half_view *view, const struct half_sums *around,
                struct half_weight *out);

#endif
