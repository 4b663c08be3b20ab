// The error of pixels in which small emitters are in view (struct small_light). Internal to the
// module.
//
// For such an emitter we know what the halves do not: the light r that it gives to a pixel, and
// that each sample meets it with the chance p, r = p F. As long as no sample has met it, the error
// is r^2. Once samples have, D^2 estimates the error of a few pixels from as few values, and these
// are whole numbers of hits: two hits in each half make D^2 zero. Samples that meet the emitter
// independently have the variance p (1 - p) F^2 / N, stratified samples have less. So the error is
// at most the lesser of two quantiles: of that variance, and of D^2 with half a hit more.
#ifndef LAMPYRIS_METRICS_SMALL_LIGHTS_H
#define LAMPYRIS_METRICS_SMALL_LIGHTS_H

#include "metrics/local_mean.h"
#include "metrics/metrics.h"

// Sums over the pixels of small lights.
struct light_errors {
    double unmet;             // errors of lights that no sample has met
    double expected, squares; // expected errors of all others, and their squares
    double told, open;        // D^2 of these, and what half a hit more adds to it
};

struct small_lights {
    struct light_errors error, relmse;
};

// The number of samples of a pixel.
double half_error_samples(const struct half_error_params *params, uint64_t pixel);

// The first one at (x, y) or later in the order of rows and columns.
const struct small_light *small_lights_from(const struct unseen_light *unseen, uint32_t x,
                                            uint32_t y);

// Adds a light; `around` is the mean around its pixel. Returns D^2 of the pixel, weighted, which
// these sums then hold. Returns NAN where no sample has met the light: its error comes on top of
// the pixel's D^2, which the caller adds as for any other pixel.
double small_lights_add(struct small_lights *sums, const struct half_error_params *params,
                        const struct small_light *light, const struct local_mean *around);
void small_lights_join(struct small_lights *sums, const struct small_lights *other);

// The bound that the errors exceed with a probability of 1 - `quantile`, and the one that they fall
// below as rarely.
double light_errors_most(const struct light_errors *errors, double quantile);
double light_errors_least(const struct light_errors *errors, double quantile);

#endif
