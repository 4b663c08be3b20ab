// Forecasts the error of a render after more samples: how its noise decreases and, with a
// reference, what part of the error remains. The functions work on plain arrays; any thread may
// call them.
#ifndef LAMPYRIS_METRICS_FORECAST_H
#define LAMPYRIS_METRICS_FORECAST_H

#include "metrics/curve.h"

// --- the error after more samples ---------------------------------------------------------------

// An estimate of the error from the half-buffers, at an earlier number of samples of the same
// render.
struct forecast_look {
    double samples;
    double error;
    double low, high; // interval of the estimate
    double confidence;
};

#define FORECAST_LOOKS_MIN 4u // with fewer estimates the slope is not known
// If there are more estimates, only the last ones are used, because the error follows a power law
// only approximately.
#define FORECAST_LOOKS_MAX 5u

struct forecast_params {
    // Estimates at doubling numbers of samples, in ascending order; their errors are above 0.
    const struct forecast_look *looks;
    size_t count;
    struct interval error; // error of the current image, without the part that remains
    double times;          // factor by which the number of samples grows; 0: 2
    // The relative standard deviation of the errors of such images over seeds, and the number of
    // values in its estimate (members of struct half_error); 0 if not known. More samples give
    // another image, whose error varies over seeds, so the interval of the current image alone may
    // be too narrow.
    double spread, spread_terms;
    // The samples are independent of each other, so that the error is inversely proportional to
    // their number, whatever the estimates say. If false, the error decreases at least that fast.
    bool independent;
    // The part of the error that does not decrease. It is added to the forecast; {0, 0, 0} if there
    // is none.
    struct interval stays;
};

enum forecast_basis {
    FORECAST_INVERSE,  // error ~ 1 / samples, because samples are independent
    FORECAST_AT_LEAST, // upper bound: error ~ 1 / samples; lower end: samples^(-3/2)
    FORECAST_SLOPE,    // error ~ samples^slope, with the slope of the estimates
};

struct forecast {
    struct interval error; // error of the image with `times` as many samples
    enum forecast_basis basis;
    struct interval slope;
    size_t looks; // number of estimates that determined the slope
};

// Forecasts the error. The result is not known (NAN) if params->error or its interval is not.
void forecast_find_error(const struct forecast_params *params, struct forecast *out);

// --- the part of the error that remains ---------------------------------------------------------

struct forecast_bias_params {
    const float (*half_a)[3]; // two independent halves of an image
    const float (*half_b)[3];
    const float (*reference)[3];
    const float (*means)[3]; // metrics_local_means() of `reference`
    uint32_t width, height;
    // The reference's own noise: its two halves, or NULL if they are not known, and its noise as
    // local relMSE, which is 0 in that case.
    const float (*reference_halves[2])[3];
    double reference_error;
};

struct forecast_bias {
    // The part of the local relMSE that remains with any number of samples, with its 95 %
    // confidence interval from tiles. The estimate is unbiased, so it may be negative. The interval
    // allows for unseen samples as in bias.h. NAN if no pixel is finite, or if there are fewer than
    // four tiles.
    struct interval stays;
    // The bias is certain: the 99.9 % interval and the interval of `stays` are both above 0.
    bool is_certain;
};

// Estimates the bias from independent halves A and B of an image and a reference r: E (A - r) (B -
// r) is the squared bias plus the variance of r, because the noise of the halves is independent.
// Returns false only when out of memory.
bool forecast_find_bias(const struct forecast_bias_params *params, struct forecast_bias *out);

#endif
