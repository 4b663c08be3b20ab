// The statistics of docs/verification.md, "How a mean is checked": R independently seeded
// replicates of one measurement, a t-test against the expected value, and bounds on the confidence
// interval and on the bias, since a t-test alone passes when the noise is large.
#ifndef LAMPYRIS_CHECK_REPLICATES_H
#define LAMPYRIS_CHECK_REPLICATES_H

#include "render/render.h"

#define REPLICATES 64
#define REPLICATES_VALUES 64 // at most

// With 63 degrees of freedom, |t| exceeds it with probability 1e-3 / 66: the family error is 1e-3
// over 66 tests.
#define REPLICATES_T_MAX 4.7

// A measurement of an image: `count` numbers.
struct measurement {
    uint32_t count;
    void (*measure)(const struct film_image *film, double *values);
};
extern const struct measurement MEASURE_MEAN; // measures the mean of the whole image: 3 channels
// Sums over channels and pixels of 2 x 2 and of 4 x 4 tiles in rows from the top, then of the whole
// image: the channels have the same errors.
extern const struct measurement MEASURE_2X2_TILES, MEASURE_4X4_TILES;

struct replicates {
    uint32_t count; // number of values measured
    double values[REPLICATES_VALUES][REPLICATES];
};

// Renders REPLICATES images with `samples` samples per pixel and the seeds first_seed, first_seed +
// 1, ….
bool replicates_render(struct renderer *renderer, const struct measurement *measurement,
                       uint32_t first_seed, uint64_t samples, struct replicates *out,
                       struct err *err);

struct estimate {
    double mean;
    double standard_error; // standard error of the mean
    double half_width;     // half-width of the mean's 95 % confidence interval
};
struct estimate replicates_estimate(const struct replicates *replicates, uint32_t value);

// Finds by a pilot, with seeds of its own, how many samples reduce the half-width of every value to
// `relative` times the value; at most `most`.
bool replicates_pilot(struct renderer *renderer, const struct measurement *measurement,
                      double relative, uint64_t most, uint64_t *samples, struct err *err);

#endif
