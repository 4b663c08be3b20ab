// The error of pixels in which small emitters are in view (struct small_light). Internal to the
// module.
//
// Of such an emitter we know what the halves do not: the light r that a pixel has of it, and that
// each sample meets it with the chance p, r = p F. As long as none has, the error is r^2. Once
// samples have, D^2 tells the error of a few pixels by as few values, and they are whole numbers of
// hits: two in either half make D^2 zero. Samples that meet it independently have the variance
// p (1 - p) F^2 / N, and stratified ones less. So the error is at most the lesser of what that
// exceeds in a given part of cases, and of what D^2, with half a hit more, exceeds.
#ifndef LAMPYRIS_METRICS_SMALL_LIGHTS_H
#define LAMPYRIS_METRICS_SMALL_LIGHTS_H

#include "metrics/local_mean.h"
#include "metrics/metrics.h"

// Sums over pixels: of errors of lights that no sample has met; of the others' expected errors and
// of their squares; of D^2, and of what half a hit more adds to that.
struct light_errors {
    double unmet, expected, squares, told, open;
};

struct small_lights {
    struct light_errors error, relmse;
};

// Of a pixel.
double half_error_samples(const struct half_error_params *params, uint64_t pixel);

// The first one at (x, y) or later in the order of rows and columns.
const struct small_light *small_lights_from(const struct unseen_light *unseen, uint32_t x,
                                            uint32_t y);

// Adds a light; `around` is of its pixel. The error that the pixel's D^2 tells, which is in these
// sums; NAN where no sample has met the light, whose error adds to what D^2 tells of all else.
double small_lights_add(struct small_lights *sums, const struct half_error_params *params,
                        const struct small_light *light, const struct local_mean *around);
void small_lights_join(struct small_lights *sums, const struct small_lights *other);

// What the errors exceed in 1 - `quantile` of cases, and what they fall below as rarely.
double light_errors_most(const struct light_errors *errors, double quantile);
double light_errors_least(const struct light_errors *errors, double quantile);

#endif
