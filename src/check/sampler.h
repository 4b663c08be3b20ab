// Runs the renderer's samplers and pixel filters on items that the host provides
// (shaders/check_sampler.comp), and computes statistics of their output.
#ifndef LAMPYRIS_CHECK_SAMPLER_H
#define LAMPYRIS_CHECK_SAMPLER_H

#include "render/render.h"
#include "shared/check_sampler.h"

// The input of a draw, which is replaced by its output.
union draw {
    struct {
        uint32_t pixel, sample, dimension, unused;
    };
    float u[4];
};

struct sampler_run {
    uint32_t routine;                 // SAMPLER_ROUTINE_*
    uint32_t sampler, halves, filter; // values of the settings of these names
    uint32_t seed, samples;           // `samples` is the planned number of samples
    float filter_radius;
    uint32_t pixel_sampling, pixel_strata;
};

// Replaces the draws by random numbers or film positions. The renderer determines the image size;
// it must not render any more.
bool sampler_run(struct renderer *renderer, const struct sampler_run *run, union draw *draws,
                 uint32_t count, struct err *err);

// Returns Pearson's chi-square statistic of counts with the given expected counts, converted to a
// standard normal deviate (Wilson and Hilferty 1931).
double chi_square_deviate(const uint32_t *counts, const double *expected, uint32_t cells);
// Returns Pearson's correlation of component c of two lists of draws, whose expected means are 1/2.
double draws_correlation(const union draw *a, const union draw *b, uint32_t count, int c);
// Returns whether u is a possible result of a sampler: a multiple of 2^-24 in [0, 1).
bool draw_is_uniform(float u);

#endif
