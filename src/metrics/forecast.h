// Forecasts the effect of more samples on a single render: the decrease of its error and, with a
// reference, the part that remains. Plain arrays in, numbers out; any thread may call.
#ifndef LAMPYRIS_METRICS_FORECAST_H
#define LAMPYRIS_METRICS_FORECAST_H

#include "metrics/curve.h"

// --- what more samples would bring --------------------------------------------------------------

// An error estimate from the half-buffers at some number of samples of the same render.
struct forecast_look {
    double samples;
    double error;
    double low, high; // its interval
    double confidence;
};

#define FORECAST_LOOKS_MIN 4u // fewer do not determine a slope
// with more of them, only the last ones are used, because a line is an approximation
#define FORECAST_LOOKS_MAX 5u

struct forecast_params {
    // At doubling numbers of samples, in ascending order; errors above 0.
    const struct forecast_look *looks;
    size_t count;
    struct interval error; // error of the current image, without the remaining part
    double times;          // factor on the number of samples; 0: twice
    // The relative standard deviation of the errors of such images over seeds, and the number of
    // values in its estimate (half_error); without these: any number. The next samples bring the
    // error of another image; the interval of this one may be narrower.
    double spread, spread_terms;
    // Samples are independent of each other: the error decreases with their number regardless of
    // the estimates. Otherwise it decreases at least as fast.
    bool independent;
    struct interval stays; // added; {0, 0, 0}: nothing
};

enum forecast_basis {
    FORECAST_INVERSE,  // error ~ 1 / samples
    FORECAST_AT_LEAST, // the same as an upper bound; down to samples^(-3/2)
    FORECAST_SLOPE,    // error ~ samples^slope, as the looks show
};

struct forecast {
    struct interval error; // error of the image with `times` as many samples
    enum forecast_basis basis;
    struct interval slope;
    size_t looks; // number of estimates in the slope
};

// Not known (NAN) if params->error is not, or has no interval.
void forecast_find_error(const struct forecast_params *params, struct forecast *out);

// --- what no number of samples brings -----------------------------------------------------------

struct forecast_bias_params {
    const float (*half_a)[3]; // two independent halves of a picture
    const float (*half_b)[3];
    const float (*reference)[3];
    const float (*means)[3]; // metrics_local_means() of `reference`
    uint32_t width, height;
    // Its own noise: its halves, NULL if not known, and its value as local relMSE, then 0.
    const float (*reference_halves[2])[3];
    double reference_error;
};

struct forecast_bias {
    // The remaining part of the local relMSE, with its 95 % interval, from tiles. It may be
    // negative: it is an unbiased estimate. The interval allows for unseen samples as in bias.h.
    // NAN if no pixel is finite, or if there are fewer than four tiles.
    struct interval stays;
    // There certainly is a bias: the 99.9 % interval and the interval of `stays` are above 0.
    bool is_certain;
};

// With independent halves A and B and a reference r, E (A - r) (B - r) = bias^2 + variance of r,
// because the noise of the halves is independent. Returns false only when out of memory.
bool forecast_find_bias(const struct forecast_bias_params *params, struct forecast_bias *out);

#endif
