// Forecasts what a single render can expect of more samples: how its error will go on falling, and,
// where there is a reference, what of it will stay. Plain arrays in, numbers out; any thread may
// call.
#ifndef LAMPYRIS_METRICS_FORECAST_H
#define LAMPYRIS_METRICS_FORECAST_H

#include "metrics/curve.h"

// --- what more samples would bring --------------------------------------------------------------

// The error as the half-buffers told it at some number of samples of the same render.
struct forecast_look {
    double samples;
    double error;
    double low, high; // its interval
    double confidence;
};

#define FORECAST_LOOKS_MIN 4u // fewer tell no slope
#define FORECAST_LOOKS_MAX 5u // of more, the last ones: a line is an approximation

struct forecast_params {
    // At doubling numbers of samples, in ascending order; errors above 0.
    const struct forecast_look *looks;
    size_t count;
    struct interval error; // of the picture as it is, without what stays
    double times;          // as many samples; 0: twice
    // Relative standard deviation of the errors of such pictures over seeds, and as how many values
    // tell it (half_error); of no terms: as any number. What the next samples bring is another
    // picture's error; the interval of this one's may be narrower.
    double spread, spread_terms;
    // Samples are independent of each other: the error falls with their number whatever the looks
    // say. Else it falls as fast at least.
    bool independent;
    struct interval stays; // added; {0, 0, 0}: nothing
};

enum forecast_basis {
    FORECAST_INVERSE,  // error ~ 1 / samples
    FORECAST_AT_LEAST, // the same as an upper bound; as low as samples^(-3/2)
    FORECAST_SLOPE,    // error ~ samples^slope, as the looks show
};

struct forecast {
    struct interval error; // of the picture with so many times the samples
    enum forecast_basis basis;
    struct interval slope;
    size_t looks; // that the slope is from
};

// Not known (NAN) where params->error is not, or has no interval.
void forecast_find_error(const struct forecast_params *params, struct forecast *out);

// --- what no number of samples brings -----------------------------------------------------------

struct forecast_bias_params {
    const float (*half_a)[3]; // two independent halves of a picture
    const float (*half_b)[3];
    const float (*reference)[3];
    const float (*means)[3]; // of it: of metrics_local_means()
    uint32_t width, height;
    // Its own noise: its halves, NULL where not known, and what it is as local relMSE, 0 then.
    const float (*reference_halves[2])[3];
    double reference_error;
};

struct forecast_bias {
    // The part of the local relMSE that stays, with its 95 % interval, from tiles. It may be
    // negative: it is an unbiased estimate. The interval allows for unseen samples as in bias.h.
    // NAN where no pixel is finite, or where there are fewer than four tiles.
    struct interval stays;
    // That there is any: the 99.9 % interval is above 0, and stays' interval is.
    bool is_certain;
};

// With independent halves A and B and a reference r, E (A - r) (B - r) = bias^2 + variance of r:
// the noise of one half has nothing to do with the other's. False only when out of memory.
bool forecast_find_bias(const struct forecast_bias_params *params, struct forecast_bias *out);

#endif
