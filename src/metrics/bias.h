// Estimates bias, the part of the error that more samples do not reduce, as distinct from noise.
// The functions work on plain arrays; any thread may call them.
#ifndef LAMPYRIS_METRICS_BIAS_H
#define LAMPYRIS_METRICS_BIAS_H

#include "metrics/curve.h"

// Independent images by one method, and a reference. The values are interleaved RGB; each image has
// `length` of them.
struct bias_params {
    const float *const *pictures;
    size_t count; // number of images: at least 3 for bias_find(), at least 2 otherwise
    size_t length;
    const float *reference;
    // Two independent halves whose mean is the reference. NULL if its noise is not known; the noise
    // then counts as bias.
    const float *reference_halves[2];
};

// Estimates the part of relMSE that is due to bias: the squared distance of the images' mean from
// the reference r, over r^2 + 1e-2, minus the contributions of the noise of the images and of the
// reference. For given denominators the estimate is unbiased, so it may be negative. The interval
// combines a jackknife over the images with the uncertainty of the reference's noise; without bias
// it is wider than necessary. It is lowered as bias_allow_for_unseen() says. Returns false only
// when out of memory.
bool bias_find(const struct bias_params *params, struct interval *out);

// Lowers the interval of a bias to 0 if the difference may be light that no image has found yet. If
// all images lack rare bright samples, all are too dark by the same amount, which looks like a
// bias; and the noise does not show it, because it becomes smaller without such samples. So this
// function compares the difference, summed over the pixels, with the largest contribution of a
// single pixel of one image, or of one half of the reference. The difference counts as bias if it
// is over 200 times that contribution (300 times with 16 images), either with all pixels or without
// the noisiest tenth of them. Returns false only when out of memory.
bool bias_allow_for_unseen(const struct bias_params *params, struct interval *bias);

#endif
