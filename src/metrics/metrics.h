// Error metrics between images and error estimates from half-buffers. Plain arrays in, numbers out.
// All sums in double. Arrays are interleaved RGB, width * height pixels, and the caller's. Any
// thread may call.
#ifndef LAMPYRIS_METRICS_METRICS_H
#define LAMPYRIS_METRICS_METRICS_H

#include "base/progress.h"
#include "metrics/curve.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define METRICS_RELMSE_EPSILON 1e-2
#define METRICS_SMAPE_EPSILON 1e-6

struct metrics {
    // The first five are NaN if no pixel is finite.
    double mse;    // mean over pixels and channels of (x - r)^2
    double rmse;   // its square root
    double relmse; // mean (x - r)^2 / (r^2 + 1e-2), per channel
    double smape;  // mean 2 |x - r| / (|x| + |r| + 1e-6), per channel; rewards what is too dark
    double psnr;   // metrics_psnr() of display values without exposure
    double max;    // greatest |x - r|
    uint64_t max_pixel; // its pixel index
    uint64_t nonfinite; // pixels with a non-finite value in either image, left out of the above
    uint64_t differing; // pixels that are not bit-equal
};

// progress: NULL, or the listener that may request a stop. Returns false then, and *out is
// incomplete.
bool metrics_compare(const float (*image)[3], const float (*reference)[3], uint64_t pixel_count,
                     const struct progress *progress, struct metrics *out);

// Returns the peak signal-to-noise ratio, dB, of displayed values: multiplied by 2^stops, clamped
// to [0, 1] and sRGB-encoded, so that the peak is 1. +inf if these are equal, NaN without finite
// pixels and if `progress`, which may be NULL, requests a stop.
double metrics_psnr(const float (*image)[3], const float (*reference)[3], uint64_t pixel_count,
                    double exposure_stops, const struct progress *progress);

// The map ERROR_MAP_RELATIVE (error_map.h) in false colours, display-encoded.
void metrics_difference_picture(const float (*image)[3], const float (*reference)[3],
                                uint64_t pixel_count, float (*out)[3]);

struct error_intervals {
    struct interval mse, relmse, local_relmse;
};

// Computes 95 % intervals by Student's t over tiles of 16 x 16 pixels (smaller ones if there would
// be fewer than 16), whose errors are assumed to be independent: they show how much the error would
// change with the noise of other seeds. Differences between parts of the image widen them. NaN if
// fewer than two tiles have finite pixels. `means`: of metrics_local_means(). Returns false if
// `progress`, which may be NULL, requests a stop; nothing is known then.
bool metrics_intervals(const float (*image)[3], const float (*reference)[3],
                       const float (*means)[3], uint32_t width, uint32_t height,
                       const struct progress *progress, struct error_intervals *out);

// --- local relMSE -------------------------------------------------------------------------------
// The error relative to the brightness around a pixel: mean (x - r)^2 / (L^2 + 1e-2) over pixels
// and channels, L being the mean of r around the pixel by a Gaussian of 1.5 pixels (local_mean.h).
// Where r is even it equals relMSE. Unlike relMSE it can be estimated without a reference: a render
// knows little of a pixel's own value until it is done, but soon enough of the pixels around it.

// Computes L of each pixel, for metrics_local_relmse(). Returns false when out of memory, or if
// `progress`, which may be NULL, requests a stop.
bool metrics_local_means(const float (*reference)[3], uint32_t width, uint32_t height,
                         const struct progress *progress, float (*out)[3]);
// `means`: of metrics_local_means(). NaN when no pixel is finite.
double metrics_local_relmse(const float (*image)[3], const float (*reference)[3],
                            const float (*means)[3], uint64_t pixel_count);

// The local relMSE of (A + B) / 2, estimated from two independent half-buffers: the error of this
// image itself, not the expected one over other seeds. It is blind to bias.
struct half_error {
    // The error has an interval: with two samples or more, unless few pixels have nearly all of it,
    // light may still be missing, or the image is black. With only a bound the estimate is given,
    // too.
    bool known;
    bool bounded;       // whether at_most and relmse_at_most are finite
    const char *reason; // why not known; NULL when known
    double local_relmse;
    double ci_low, ci_high; // with the requested confidence; derived in half_error.c
    double at_most;         // the upper end of a one-sided interval of the same confidence
    double relmse_at_most;  // the same bound for relMSE
    double mse;
    // The relative deviation of the errors of images with other seeds, and the number of pixels of
    // equal noise in this estimate, at least one: see forecast.c. 0 if there is no error.
    double spread, spread_terms;
};

// One or several emitters in a pixel that cover little of it: samples hit them by chance. Until one
// does, the halves do not know of it.
struct small_light {
    uint32_t x, y;     // the pixel of its middle
    float radius;      // pixels from there in which samples may meet it: its own size, filter, lens
    float part;        // the total fraction of a pixel that it covers, which is the fraction of a
                       // pixel's samples that would hit it if it were all in this one
    float radiance[3]; // radiance of a sample that hits it
};

// Light that may still be missing in an image; all 0: nothing is known.
struct unseen_light {
    // The greatest radiance of a channel that a path may find by chance alone; 0: none, shadow rays
    // find all light. The bounds include it until a sample has found such light.
    double by_chance;
    // For each pixel, whether an emitter may be directly visible there, so that brightness does not
    // indicate light that a path has found by chance. NULL: nowhere.
    const uint8_t *emitter_in_view;
    // Sorted by rows, then by columns; at most one per pixel.
    const struct small_light *small;
    size_t small_count;
};

struct half_error_params {
    const float (*half_a)[3];
    const float (*half_b)[3];
    uint32_t width, height;
    // Samples per pixel, both halves together; the mean if pixels have different counts. Both
    // halves of a pixel must have the same number (or differ by one, if there are many).
    uint64_t samples;
    const uint32_t *counts; // a pixel's samples, where they differ; NULL: `samples` of each
    double confidence;      // confidence of the interval, in [0.5, 1); 0: 0.95
    struct unseen_light unseen;
};

// Estimates the error as mean (A-B)^2 / 4 over L^2 + 1e-2: half_error.c derives it. Non-finite
// pixels are omitted. Uses several threads; the result does not depend on their number. Returns
// false only when out of memory.
bool metrics_half_error(const struct half_error_params *params, struct half_error *out);

// Computes what each tile adds to the local relMSE, a pixel, as above. Tiles of side x side pixels
// in rows from the top, those at the right and lower edge are smaller; 0 where no pixel can be
// judged.
bool metrics_tile_errors(const struct half_error_params *params, uint32_t side, double *out);

// Computes the weights by which metrics_half_error() adds a pixel's (A-B)^2 / 4 up, but for pixels
// with a small emitter in view: the sum over channels is the pixel's error. 0 where a pixel is not
// finite.
bool metrics_half_error_weights(const struct half_error_params *params, double (*out)[3]);

// --- when to stop -------------------------------------------------------------------------------
// A render that ends when its error is small enough stops at the first look whose one-sided bound,
// half_error.at_most of LOOKS_CONFIDENCE, is below the limit. Several looks may err where one may,
// but they share their samples, and are taken near the end: over the scenes of docs/convergence.md
// ("When --error stops") they err in fewer than 5 % of renders together. Where looks are depends on
// the errors that were seen and on nothing else, so that a render stops at the same sample on any
// machine.
#define LOOKS_FIRST 2u
#define LOOKS_CONFIDENCE 0.95
// Numbers of samples are multiples of `unit`: of 2, so that both halves have equal numbers, or of
// rounds. Returns the number of samples at the first interim test, for a render that has `done`
// samples.
uint64_t looks_first(uint64_t done, uint64_t unit);
// Returns the number of samples at the interim test after that at `done` samples, whose bound was
// `excess` times the limit; INFINITY if there was no bound.
uint64_t looks_next(uint64_t done, double excess, uint64_t unit);

// --- statistics ---------------------------------------------------------------------------------
// Quantile of Student's t, p in (0, 1), degrees of freedom >= 1; NaN outside of that. The relative
// error is <= 1e-6 for p >= 1e-150 and up to 1e9 degrees of freedom.
double stats_t_quantile(double p, double degrees_of_freedom);
// Computes mean and unbiased variance (two-pass). NaN without values; the variance also for a
// single value.
void stats_mean_variance(const double *values, size_t count, double *mean, double *variance);

#endif
