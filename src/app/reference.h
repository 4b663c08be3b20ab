// A reference picture, and how much of a difference from it is its own noise.
#ifndef LAMPYRIS_APP_REFERENCE_H
#define LAMPYRIS_APP_REFERENCE_H

#include "image.h"

struct reference {
    struct image image;
    // Its own noise, in the measures of metrics_compare: what is to be subtracted from a picture's
    // MSE and relMSE against it. 0 where not known.
    double mse, relmse;
    bool noise_known;
    // What its noise is told from, with the same pixels as `image`; NULL where that is something
    // else or nothing.
    const float (*halves[2])[3];
    const char *reason; // why not; NULL where known
};

// Reads a picture, and, of an EXR file with the layers half_a and half_b (--aov halves), its noise.
// Pixels live in `arena`. That its noise is not known is no failure.
bool reference_read(const char *path, struct arena *arena, struct reference *out, struct err *err);

// Sets the noise of out->image from two independent halves of its samples, of as many pixels:
// mean (A - B)^2 / 4, and that over r^2 + epsilon, with as little noise in r as a reference has.
// Keeps the pointers to them.
// Pixels that are not finite are left out, as metrics_compare does.
void reference_set_noise(struct reference *out, const float (*half_a)[3], const float (*half_b)[3]);

// Sets it from the variances of out->image's values, in a picture of as many pixels. ERR_INPUT,
// naming the pixel, where one is negative or not finite though the reference is. `path` is that of
// the variances.
bool reference_set_variance(struct reference *out, const char *path, const float (*variance)[3],
                            struct err *err);
// The same with one variance for all.
void reference_set_even_variance(struct reference *out, double variance);

// ERR_INPUT, unless it has as many pixels as `what` has.
bool reference_check_size(const struct reference *reference, const char *path, const char *what,
                          uint32_t width, uint32_t height, struct err *err);

#endif
