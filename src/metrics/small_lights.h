// The error of pixels in which small emitters are in view (struct small_light). Internal to this
// module.
//
// The scene shows what the halves do not: an emitter with radiance F is hit by a sample with the
// probability p, and adds r = p F to a pixel. As long as no sample has hit it, the error is r^2.
// Afterwards D^2 estimates the error of a few pixels from a few values only, and these are whole
// numbers of hits: with two hits in each half, D^2 is zero. If samples hit the emitter
// independently, their mean has the variance p (1 - p) F^2 / N; with stratified samples it is less.
// So the error is at most the lesser of two quantiles: that for this variance, and that for D^2
// with half a hit more.
#ifndef LAMPYRIS_METRICS_SMALL_LIGHTS_H
#define LAMPYRIS_METRICS_SMALL_LIGHTS_H

#include "metrics/local_mean.h"
#include "metrics/metrics.h"

// Sums over the pixels with small emitters.
struct light_errors {
    double unmet; // errors of emitters that no sample has hit
    // For all other emitters: their expected errors, and the squares of these.
    double expected, squares;
    double told, open; // D^2 of emitters that samples have hit, and its increase by half a hit
                       // more
};

struct small_lights {
    struct light_errors error, relmse;
};

// Returns the number of samples of a pixel.
double half_error_samples(const struct half_error_params *params, uint64_t pixel);

// Returns the first emitter at (x, y) or later, in the order of rows and then columns.
const struct small_light *small_lights_from(const struct unseen_light *unseen, uint32_t x,
                                            uint32_t y);

// Adds an emitter; `around` is the mean around its pixel. Returns the pixel's weighted D^2, which
// the sums then contain. Returns NAN if the sums do not contain it, and the caller must add the
// pixel's D^2 as for any other pixel.
double small_lights_add(struct small_lights *sums, const struct half_error_params *params,
                        const struct small_light *light, const struct local_mean *around);
void small_lights_join(struct small_lights *sums, const struct small_lights *other);

// Return an upper bound of the error that is exceeded with probability 1 - `quantile`, and a lower
// bound that is undercut with the same probability.
double light_errors_most(const struct light_errors *errors, double quantile);
double light_errors_least(const struct light_errors *errors, double quantile);

#endif
