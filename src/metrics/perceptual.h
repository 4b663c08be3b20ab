// Perceptual image metrics: SSIM and FLIP. The functions work on plain arrays; any thread may call
// them. Their memory counts against the budget of the process (base/memory.h). `progress` may be
// NULL; it is often asked whether to stop.
#ifndef LAMPYRIS_METRICS_PERCEPTUAL_H
#define LAMPYRIS_METRICS_PERCEPTUAL_H

#include "base/progress.h"
#include <stdbool.h>
#include <stdint.h>

// Two images of the same size in linear Rec. 709, interleaved RGB. A pixel that is not finite in
// one of them counts as black in both.
struct picture_pair {
    const float (*image)[3];
    const float (*reference)[3];
    uint32_t width, height; // at least 1
};

// Computes the mean structural similarity (Wang, Bovik, Sheikh, Simoncelli 2004) of the luma of
// display values, which are clamped to [0, 1] and sRGB-encoded. Windows are Gaussian with 11 x 11
// pixels and sigma 1.5; K1 = .01, K2 = .03. At the border only the part inside the image is used,
// with its weights scaled to a sum of 1. The result is 1 for equal images. Noise reduces it like
// any other difference in structure. Returns false when out of memory or stopped.
bool metrics_ssim(const struct picture_pair *pair, const struct progress *progress, double *out);

// The value for a viewer 0.7 m from a screen that is 0.7 m and 3840 pixels wide: .7 * 3840 / .7 *
// pi / 180.
#define FLIP_PIXELS_PER_DEGREE 67.02064327658226

// Computes FLIP (Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images") of
// display values. *out is the mean over pixels, in [0, 1]. `map` receives width * height values; it
// may be NULL. Returns false when out of memory or stopped.
bool metrics_flip(const struct picture_pair *pair, double pixels_per_degree,
                  const struct progress *progress, float *map, double *out);

// The exposures of HDR-FLIP (Andersson et al. 2021, "Visualizing Errors in Rendered High Dynamic
// Range Images"): `count` exposures, about one per stop, from the one at which the tone curve maps
// the reference's brightest pixel to .85 to the one at which it maps the median to .85. They depend
// on the reference alone, so that all images compared with it are evaluated alike.
struct flip_exposures {
    double start, stop; // in stops
    uint32_t count;     // at least 2
};

// The greatest value of stop - start. If the median is very dark, the range of exposures would
// otherwise have no end.
#define FLIP_STOPS_MAX 20
// Finds the exposures for the reference of a pair. Returns false only when stopped.
bool metrics_flip_exposures(const struct picture_pair *pair, const struct progress *progress,
                            struct flip_exposures *out);
// Returns as many exposures as the range from start to stop needs; stop >= start.
struct flip_exposures metrics_flip_exposures_between(double start, double stop);

// Computes HDR-FLIP: for each pixel the greatest FLIP over the exposures, with the tone curve of
// ACES that the paper uses. *out is its mean over pixels. Progress is reported as "Comparing".
// Returns false when out of memory or stopped.
bool metrics_flip_hdr(const struct picture_pair *pair, double pixels_per_degree,
                      const struct flip_exposures *exposures, const struct progress *progress,
                      float *map, double *out);

// These functions return the most memory, in bytes, that a metric needs besides its inputs and
// `map`.
uint64_t metrics_ssim_bytes(uint32_t width, uint32_t height);
uint64_t metrics_flip_bytes(uint32_t width, uint32_t height);
uint64_t metrics_flip_hdr_bytes(uint32_t width, uint32_t height);

#endif
