// Error metrics between images and error estimates from half-buffers. Plain arrays in, numbers out.
// All sums in double. Arrays are interleaved RGB, width * height pixels, and the caller's. Any
// thread may call.
#ifndef LAMPYRIS_METRICS_METRICS_H
#define LAMPYRIS_METRICS_METRICS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define METRICS_RELMSE_EPSILON 1e-2

struct metrics {
    // The first four are NaN when no pixel is finite.
    double mse;         // mean over pixels and channels of (x - r)^2
    double rmse;        // its square root
    double relmse;      // mean (x - r)^2 / (r^2 + 1e-2), per channel
    double psnr;        // dB, peak 1, on values as given (linear), +inf when equal
    double max;         // greatest |x - r|
    uint64_t max_pixel; // its pixel index
    uint64_t nonfinite; // pixels with a non-finite value in either image, left out of the above
    uint64_t differing; // pixels that are not bit-equal
};

void metrics_compare(const float (*image)[3], const float (*reference)[3], uint64_t pixel_count,
                     struct metrics *out);

// False-colour picture of |x - r| / (|r| + 1e-2) per pixel (mean over channels): black 0, then
// blue, green, yellow, red on a logarithmic scale from 1e-4 to 1; magenta where either is not
// finite. Values in [0, 1], display-encoded.
void metrics_difference_picture(const float (*image)[3], const float (*reference)[3],
                                uint64_t pixel_count, float (*out)[3]);

// Error of (A + B) / 2 from two independent half-buffers' means.
struct half_error {
    // False below 16 spp, while fewer than 30 pixels carry half of the variance (they stand for
    // 30 samples, which a film does not keep apart), and while all is black. The rest is 0 then.
    bool known;
    const char *reason; // why not known; NULL when known
    double relmse;
    // 95 %, by bootstrap of tiles of 16 x 16 pixels; low is >= 0. Pictures of fewer than 16 such
    // tiles take smaller ones, of more than 65536 larger ones.
    double ci_low, ci_high;
    double mse;
};

struct half_error_params {
    const float (*half_a)[3];
    const float (*half_b)[3];
    uint32_t width, height;
    uint64_t samples; // per pixel, both halves together
    uint32_t seed;    // of the bootstrap: the result is deterministic
};

// mean (A-B)^2 / 4 over a denominator that is a smoothed image: half_error.c states the filter and
// why. Non-finite pixels are left out. False only when out of memory.
bool metrics_half_error(const struct half_error_params *params, struct half_error *out);

// --- statistics ---------------------------------------------------------------------------------
// Quantile of Student's t, p in (0, 1), degrees of freedom >= 1; NaN outside of that. The relative
// error is <= 1e-6 for p >= 1e-150 and up to 1e9 degrees of freedom.
double stats_t_quantile(double p, double degrees_of_freedom);
// Mean, unbiased variance (two-pass). NaN without values, the variance also with one alone.
void stats_mean_variance(const double *values, size_t count, double *mean, double *variance);

#endif
