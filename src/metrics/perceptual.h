// Metrics after how people see: SSIM and FLIP. Plain arrays in, numbers out. Any thread may call.
// Their memory counts against the budget of the process (memory.h). `progress` may be NULL; all of
// them ask it often whether to stop.
#ifndef LAMPYRIS_METRICS_PERCEPTUAL_H
#define LAMPYRIS_METRICS_PERCEPTUAL_H

#include "base/progress.h"
#include <stdbool.h>
#include <stdint.h>

// Two pictures of the same size, linear Rec. 709, interleaved RGB. Pixels that are not finite in
// either count as black in both.
struct picture_pair {
    const float (*image)[3];
    const float (*reference)[3];
    uint32_t width, height; // at least 1
};

// Mean structural similarity (Wang, Bovik, Sheikh, Simoncelli 2004) of the luma of the display
// values: clamped to [0, 1], sRGB-encoded. Windows are Gaussian, 11 x 11, sigma 1.5, K1 = .01,
// K2 = .03; at borders the part that is inside, its weights scaled up to 1. 1 is equality; noise
// counts as structure. False when out of memory, or asked to stop.
bool metrics_ssim(const struct picture_pair *pair, const struct progress *progress, double *out);

// 0.7 m from a screen 0.7 m and 3840 pixels wide: .7 * 3840 / .7 * pi / 180.
#define FLIP_PIXELS_PER_DEGREE 67.02064327658226

// FLIP (Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images") of the
// display values; *out is the mean over pixels, in [0, 1]. `map`: width * height values, or NULL.
// False when out of memory, or asked to stop.
bool metrics_flip(const struct picture_pair *pair, double pixels_per_degree,
                  const struct progress *progress, float *map, double *out);

// The exposures that HDR-FLIP looks at (Andersson et al. 2021, "Visualizing Errors in Rendered High
// Dynamic Range Images"): from where the tone curve brings the reference's brightest pixel to .85
// to where it brings the median there, `count` of them, about one a stop. The reference alone
// decides: pictures that are compared with the same one are looked at alike.
struct flip_exposures {
    double start, stop; // stops
    uint32_t count;     // at least 2
};

// Pictures whose median is dark are cut off at FLIP_STOPS_MAX stops: the range would have no end.
// False only when asked to stop.
#define FLIP_STOPS_MAX 20
bool metrics_flip_exposures(const struct picture_pair *pair, const struct progress *progress,
                            struct flip_exposures *out);
// As many as these ends take; stop >= start.
struct flip_exposures metrics_flip_exposures_between(double start, double stop);

// HDR-FLIP: the greatest FLIP of each pixel over the exposures, tone-mapped by the curve of ACES
// that the paper uses; *out is its mean. `progress` is reported as "Comparing". Returns false when
// out of memory, or asked to stop.
bool metrics_flip_hdr(const struct picture_pair *pair, double pixels_per_degree,
                      const struct flip_exposures *exposures, const struct progress *progress,
                      float *map, double *out);

// The most memory that each of them takes at a time beside its inputs and a `map` that is given.
uint64_t metrics_ssim_bytes(uint32_t width, uint32_t height);
uint64_t metrics_flip_bytes(uint32_t width, uint32_t height);
uint64_t metrics_flip_hdr_bytes(uint32_t width, uint32_t height);

#endif
