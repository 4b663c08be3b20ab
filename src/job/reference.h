// A reference image, and the contribution of its own noise to measured errors.
#ifndef LAMPYRIS_JOB_REFERENCE_H
#define LAMPYRIS_JOB_REFERENCE_H

#include "base/progress.h"
#include "image/image.h"

struct reference {
    struct image image;
    const float (*means)[3]; // means around each pixel, for the local relMSE
    // The reference's own noise in three metrics of metrics.h, which is subtracted from an image's
    // errors. 0 if it is not known.
    double mse, relmse, local_relmse;
    bool noise_known;
    // The halves from which the noise was estimated, with the same pixels as `image`; NULL if there
    // are none.
    const float (*halves[2])[3];
    const char *reason; // why the noise is not known; NULL if it is known
};

// Reads an image and its noise, and computes its local means. The noise is known if the file is an
// EXR with the layers half_a and half_b (--aov halves) or variance (--aov variance, the variance of
// each value); an unknown noise is not an error. `arena` owns the pixels. Fails with ERR_STOPPED if
// `progress`, which may be NULL, requests a stop.
bool reference_read(const char *path, const struct progress *progress, struct arena *arena,
                    struct reference *out, struct err *err);

// Computes the local means of out->image, which `arena` owns. Must be called before the noise is
// set. Stops as reference_read() does.
bool reference_find_means(struct reference *out, const struct progress *progress,
                          struct arena *arena, struct err *err);

// Sets the noise of out->image from two independent halves of its samples, with the same number of
// pixels: the means of (A - B)^2 / 4, of the same over r^2 + epsilon, and of the same over L^2 +
// epsilon. These are accurate only if r and L have as little noise as a reference has. Pixels that
// are not finite are left out, as in metrics_compare(). Keeps the pointers to the halves.
void reference_set_noise(struct reference *out, const float (*half_a)[3], const float (*half_b)[3]);

// Sets the noise from the variance of each value of out->image, for the same number of pixels.
// Fails with ERR_INPUT, naming the pixel, if a variance is negative, or if it is not finite
// although the reference is. `path` is the file of the variances, for messages.
bool reference_set_variance(struct reference *out, const char *path, const float (*variance)[3],
                            struct err *err);
// Sets the noise from a single variance of all values.
void reference_set_even_variance(struct reference *out, double variance);

// Errors of an image against a reference, whose own noise is subtracted from the first three. NAN
// if not known.
struct reference_errors {
    double local_relmse, relmse, mse, smape, psnr;
};
// Compares an image, which must have as many pixels as the reference. Returns false if `progress`,
// which may be NULL, requests a stop; *out is then not set.
bool reference_compare(const struct reference *reference, const float (*image)[3],
                       const struct progress *progress, struct reference_errors *out);

// Fails with ERR_INPUT unless the reference has the size width x height of `what`.
bool reference_check_size(const struct reference *reference, const char *path, const char *what,
                          uint32_t width, uint32_t height, struct err *err);

#endif
