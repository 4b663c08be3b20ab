// Computes the statistics that docs/verification.md describes in "How a mean is checked":
// REPLICATES renders of the same measurement with independent seeds, a t-test against the expected
// value, and bounds on the confidence interval and on the bias, because a t-test alone also passes
// if the noise is large.
#ifndef LAMPYRIS_CHECK_REPLICATES_H
#define LAMPYRIS_CHECK_REPLICATES_H

#include "render/render.h"

#define REPLICATES 64
#define REPLICATES_VALUES 64 // greatest number of values per measurement

// The greatest permitted |t|. With 63 degrees of freedom it is exceeded with the probability 1e-3 /
// 66, so the probability that any of 66 correct tests fails is 1e-3.
#define REPLICATES_T_MAX 4.7

// A function that computes `count` values from an image.
struct measurement {
    uint32_t count;
    void (*measure)(const struct film_image *film, double *values);
};
extern const struct measurement MEASURE_MEAN; // the mean of the image, for each of 3 channels
// The sums over channels and pixels in 2 x 2 and in 4 x 4 tiles, in rows from the top, and in the
// whole image last. Channels are added because their errors are the same.
extern const struct measurement MEASURE_2X2_TILES, MEASURE_4X4_TILES;

struct replicates {
    uint32_t count; // number of values measured
    double values[REPLICATES_VALUES][REPLICATES];
};

// Renders REPLICATES images with `samples` samples per pixel, with seeds from first_seed on.
bool replicates_render(struct renderer *renderer, const struct measurement *measurement,
                       uint32_t first_seed, uint64_t samples, struct replicates *out,
                       struct err *err);

struct estimate {
    double mean;
    double standard_error; // standard error of `mean`
    double half_width;     // half-width of the 95 % confidence interval of `mean`
};
struct estimate replicates_estimate(const struct replicates *replicates, uint32_t value);

// Determines, by a pilot with other seeds, how many samples reduce the half-width of every value to
// `relative` times the value. The result is at most `most`.
bool replicates_pilot(struct renderer *renderer, const struct measurement *measurement,
                      double relative, uint64_t most, uint64_t *samples, struct err *err);

#endif
