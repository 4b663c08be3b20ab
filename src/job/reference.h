// A reference image, and the contribution of its own noise to errors.
#ifndef LAMPYRIS_JOB_REFERENCE_H
#define LAMPYRIS_JOB_REFERENCE_H

#include "base/progress.h"
#include "image/image.h"

struct reference {
    struct image image;
    const float (*means)[3]; // around each pixel, for the local relMSE
    // Its own noise, in the measures of metrics.h, which is subtracted from an image's errors. 0 if
    // not known.
    double mse, relmse, local_relmse;
    bool noise_known;
    // The halves from which its noise is estimated, with the same pixels as `image`; NULL if there
    // are none.
    const float (*halves[2])[3];
    const char *reason; // why not; NULL where known
};

// Reads a picture, and its noise, of an EXR file with the layers half_a and half_b (--aov halves)
// or variance (--aov variance, of each value); finds its means. Pixels live in `arena`. That its
// noise is not known is no failure; ERR_STOPPED where `progress`, which may be NULL, asks to stop.
bool reference_read(const char *path, const struct progress *progress, struct arena *arena,
                    struct reference *out, struct err *err);

// Sets the means of out->image, which live in `arena`; to be called before the noise is set. Stops
// as reference_read() does.
bool reference_find_means(struct reference *out, const struct progress *progress,
                          struct arena *arena, struct err *err);

// Sets the noise of out->image from two independent halves of its samples, of as many pixels:
// mean (A - B)^2 / 4, that over r^2 + epsilon, and over L^2 + epsilon, with as little noise in r
// and L as a reference has. Pixels that are not finite are left out, as metrics_compare does.
// Keeps the pointers to them.
void reference_set_noise(struct reference *out, const float (*half_a)[3], const float (*half_b)[3]);

// Sets it from the variances of out->image's values, in a picture of as many pixels. ERR_INPUT,
// naming the pixel, where one is negative or not finite though the reference is. `path` is that of
// the variances.
bool reference_set_variance(struct reference *out, const char *path, const float (*variance)[3],
                            struct err *err);
// Sets one variance for all pixels.
void reference_set_even_variance(struct reference *out, double variance);

// Errors of an image against a reference, whose own noise is subtracted from the first three. NAN:
// not known.
struct reference_errors {
    double local_relmse, relmse, mse, smape, psnr;
};
// The image must have as many pixels. Returns false if `progress`, which may be NULL, requests a
// stop: *out is not set then.
bool reference_compare(const struct reference *reference, const float (*image)[3],
                       const struct progress *progress, struct reference_errors *out);

// Fails with ERR_INPUT unless its size is that of `what`.
bool reference_check_size(const struct reference *reference, const char *path, const char *what,
                          uint32_t width, uint32_t height, struct err *err);

#endif
