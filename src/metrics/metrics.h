// Error metrics between images, and error estimates from half-buffers. The functions work on plain
// arrays that the caller owns: width * height pixels, interleaved RGB. All sums are in double
// precision. Any thread may call these functions.
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
    // mse to psnr are NaN if no pixel is finite.
    double mse;    // mean over pixels and channels of (x - r)^2
    double rmse;   // square root of mse
    double relmse; // mean over pixels and channels of (x - r)^2 / (r^2 + 1e-2)
    // Mean over pixels and channels of 2 |x - r| / (|x| + |r| + 1e-6), which favours dark images.
    double smape;
    double psnr;        // metrics_psnr() at exposure 0, dB
    double max;         // greatest |x - r| of a channel
    uint64_t max_pixel; // index of the pixel with that difference
    uint64_t nonfinite; // pixels that are not finite in either image; they are omitted above
    uint64_t differing; // pixels whose bits differ
};

// Compares an image x with a reference r. `progress` may be NULL. Returns false if it requests a
// stop; *out is then incomplete.
bool metrics_compare(const float (*image)[3], const float (*reference)[3], uint64_t pixel_count,
                     const struct progress *progress, struct metrics *out);

// Returns the peak signal-to-noise ratio, in dB, of display values: linear values multiplied by
// 2^stops, clamped to [0, 1] and sRGB-encoded, so that the peak is 1. Returns +inf if the display
// values are equal, NaN if no pixel is finite or if `progress` (which may be NULL) requests a stop.
double metrics_psnr(const float (*image)[3], const float (*reference)[3], uint64_t pixel_count,
                    double exposure_stops, const struct progress *progress);

// Computes the map ERROR_MAP_RELATIVE (error_map.h) in false colours, as display values.
void metrics_difference_picture(const float (*image)[3], const float (*reference)[3],
                                uint64_t pixel_count, float (*out)[3]);

struct error_intervals {
    struct interval mse, relmse, local_relmse;
};

// Computes 95 % confidence intervals by Student's t over tiles of 16 x 16 pixels, or smaller ones
// if there would be fewer than 16. The errors of tiles are assumed to be independent. The intervals
// show how much an error would vary over seeds; differences between parts of the image widen them.
// They are NaN if fewer than two tiles have finite pixels. `means` comes from
// metrics_local_means(). Returns false if `progress` (which may be NULL) requests a stop; *out is
// then not valid.
bool metrics_intervals(const float (*image)[3], const float (*reference)[3],
                       const float (*means)[3], uint32_t width, uint32_t height,
                       const struct progress *progress, struct error_intervals *out);

// --- local relMSE -------------------------------------------------------------------------------
// The local relMSE is the error relative to the brightness around a pixel: the mean of (x - r)^2 /
// (L^2 + 1e-2) over pixels and channels, where L is the mean of r around the pixel by a Gaussian of
// 1.5 pixels (local_mean.h). If r is constant, it equals relMSE. Unlike relMSE it can be estimated
// without a reference: a pixel's own value is uncertain until the render is finished, but the mean
// of the pixels around it is known early.

// Computes L of each pixel, for metrics_local_relmse(). Returns false when out of memory, or if
// `progress` (which may be NULL) requests a stop.
bool metrics_local_means(const float (*reference)[3], uint32_t width, uint32_t height,
                         const struct progress *progress, float (*out)[3]);
// Returns the local relMSE, or NaN if no pixel is finite. `means` comes from metrics_local_means().
double metrics_local_relmse(const float (*image)[3], const float (*reference)[3],
                            const float (*means)[3], uint64_t pixel_count);

// The local relMSE of the image (A + B) / 2, estimated from two independent half-buffers A and B:
// the error of this image, not its expectation over seeds. It does not include bias.
struct half_error {
    // True if the error has an interval. It has none with fewer than two samples, if few pixels
    // have nearly all of the error, if light may still be missing, or if the image is black. The
    // estimate is valid if `bounded` is set, even without an interval.
    bool known;
    bool bounded;       // at_most and relmse_at_most are finite
    const char *reason; // why there is no interval; NULL if `known`
    double local_relmse;
    // The interval of local_relmse with the requested confidence; derived in half_error.c.
    double ci_low, ci_high;
    double at_most;        // upper end of the one-sided interval of the same confidence
    double relmse_at_most; // the same for relMSE
    double mse;
    // The standard deviation of the errors of images with other seeds, relative to the error, and
    // the number (at least 1) of pixels of equal noise that would make this estimate as uncertain;
    // see forecast.c. Both are 0 if there is no error.
    double spread, spread_terms;
};

// One or several emitters that cover only a small part of a pixel, so that samples hit them by
// chance. Until a sample hits them, the half-buffers do not show them.
struct small_light {
    uint32_t x, y; // pixel that contains the centre
    // Greatest distance, in pixels, from the centre at which a sample may hit the emitter, due to
    // the emitter's size, the pixel filter and the lens.
    float radius;
    // Fraction of a pixel that the emitter covers; equal to the expected number of hits per sample
    // if all of its light were in this pixel.
    float part;
    float radiance[3]; // radiance of a sample that hits it
};

// Light that an image may still lack. All members are 0 if nothing is known about it.
struct unseen_light {
    // The greatest radiance, in a channel, that a path may find by chance alone; 0 if shadow rays
    // find all light. The bounds include this light until a sample has found it.
    double by_chance;
    // For each pixel, whether an emitter may be directly visible there; such a pixel may be bright
    // without a path that has found light by chance. NULL: no emitter is visible.
    const uint8_t *emitter_in_view;
    // Small emitters, sorted by rows and then by columns; at most one per pixel.
    const struct small_light *small;
    size_t small_count;
};

struct half_error_params {
    const float (*half_a)[3];
    const float (*half_b)[3];
    uint32_t width, height;
    // Samples per pixel of both halves together; the mean if the counts differ between pixels. In
    // each pixel both halves must have equal numbers of samples; a difference of one is permitted
    // if they have many.
    uint64_t samples;
    const uint32_t *counts; // samples of each pixel if they differ; NULL: `samples`
    double confidence;      // confidence of the interval, in [0.5, 1); 0 means 0.95
    struct unseen_light unseen;
};

// Estimates the local relMSE as the mean of (A - B)^2 / 4 / (L^2 + 1e-2), as derived in
// half_error.c. Pixels that are not finite are omitted. Uses several threads; the result does not
// depend on their number. Returns false only when out of memory.
bool metrics_half_error(const struct half_error_params *params, struct half_error *out);

// Computes for each tile its contribution to the estimated local relMSE, per pixel of the tile.
// Tiles have side x side pixels, in rows from the top; those at the right and lower edges are
// smaller. The result is 0 if no pixel of the tile can be evaluated.
bool metrics_tile_errors(const struct half_error_params *params, uint32_t side, double *out);

// Computes the weights that metrics_half_error() applies to (A - B)^2 / 4, for each pixel and
// channel: their weighted sum over channels is the error of the pixel, except where a small emitter
// is in view. The weights are 0 for pixels that are not finite.
bool metrics_half_error_weights(const struct half_error_params *params, double (*out)[3]);

// --- when to stop -------------------------------------------------------------------------------
// A render with an error limit stops at the first interim test at which half_error.at_most, with
// the confidence LOOKS_CONFIDENCE, is below the limit. Each of several tests may err, but they
// share samples and take place near the end: over the scenes of docs/convergence.md ("When a bound
// on the error ends a render") all tests of a render together err in fewer than 5 % of renders. The
// sample counts of the tests depend only on the estimated errors, so that a render stops at the
// same sample on any machine.
#define LOOKS_FIRST 2u
#define LOOKS_CONFIDENCE 0.95
// Returns the number of samples at the first test of a render that has `done` samples already. It
// is a multiple of `unit`. The unit is 2, so that both halves have equal numbers of samples, or the
// number of samples of a round.
uint64_t looks_first(uint64_t done, uint64_t unit);
// Returns the number of samples at the next test. At the previous test, at `done` samples, the
// bound was `excess` times the limit; INFINITY if there was no bound.
uint64_t looks_next(uint64_t done, double excess, uint64_t unit);

// --- statistics ---------------------------------------------------------------------------------
// Returns the quantile of Student's t for p in (0, 1) and at least one degree of freedom; NaN
// outside of these ranges. The relative error is at most 1e-6 for p >= 1e-150 and up to 1e9 degrees
// of freedom.
double stats_t_quantile(double p, double degrees_of_freedom);
// Computes the mean and the unbiased variance in two passes. Both are NaN without values; the
// variance is NaN for a single value, too.
void stats_mean_variance(const double *values, size_t count, double *mean, double *variance);

#endif
