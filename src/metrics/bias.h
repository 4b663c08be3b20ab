// Estimates bias, the error that remains for any number of samples, as distinct from noise. Plain
// arrays in, numbers out; any thread may call.
#ifndef LAMPYRIS_METRICS_BIAS_H
#define LAMPYRIS_METRICS_BIAS_H

#include "metrics/curve.h"

// Independent pictures by one method, and a reference. Values are interleaved RGB, `length` of them
// in each picture.
struct bias_params {
    const float *const *pictures;
    size_t count; // number of images; at least 3 for bias_find, else 2
    size_t length;
    const float *reference;
    // Two independent halves of the reference, whose mean it is; NULL if its noise is not known: it
    // then counts as bias.
    const float *reference_halves[2];
};

// Estimates the bias part of relMSE: the squared distance of the images' mean from the reference r
// over r^2 + 1e-2, minus the contribution of the noise of the images and of the reference. It is
// unbiased for given denominators, so it may be negative. The interval is by jackknife over the
// images and by the reference's halves; without bias it is wider than necessary. It allows for
// unseen samples as below. Returns false only when out of memory.
bool bias_find(const struct bias_params *params, struct interval *out);

// Lowers an interval of the bias to 0 where the difference could be light that no picture has found
// yet. Noise cannot show what rare bright samples would bring that none of the pictures has: all
// pictures are then too dark by the same amount, which looks like a bias, and the fewer such
// samples they have the smaller their noise is. So this compares the difference, summed over the
// pixels, with the largest part that any pixel of one picture, or of one half of the reference, has
// in it. It is reported as bias where it is over 200 times that (300 times with 16 pictures), with
// all pixels or without the noisiest tenth of them. Returns false only when out of memory.
bool bias_allow_for_unseen(const struct bias_params *params, struct interval *bias);

#endif
