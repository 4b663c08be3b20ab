// Splits the error of an image, the local relMSE that its half-buffers estimate, by classes of
// light whose half-buffers are known as well. Any thread may call.
//
// With D = (A - B) / 2 of the picture and D_k of class k, D is the sum of D_k, and
//
//     D^2 = sum_k D_k^2 + sum_j sum_k!=j D_j D_k
//
// in each pixel: the variance of a sum is that of its terms and twice their covariances. All are
// weighted as D^2 is (half_error.c), so that the classes' own errors and what they have in common
// add up to the error, but for rounding. The latter is below 0 where one class brings more when
// another brings less, as with emitters of which each sample chooses one, and above 0 where a
// sample brings all of them or none, as a path does that meets a surface or not.
#ifndef LAMPYRIS_METRICS_ERROR_BY_H
#define LAMPYRIS_METRICS_ERROR_BY_H

#include "metrics/metrics.h"

#define ERROR_BY_CLASSES_MAX 8

struct error_by_params {
    const struct half_error_params *halves; // the half-buffers of the image
    const double (*weights)[3]; // the weights that metrics_half_error_weights() computes
    // The half-buffers of the classes: those of class k at pixel p have the index p * stride + k.
    // k < count, which is at most ERROR_BY_CLASSES_MAX.
    const float (*class_a)[3], (*class_b)[3];
    uint32_t count, stride;
};

// The contribution of one class to the error.
struct error_share {
    double error; // part of the local relMSE
    // The fraction of the total error, with the 95 % interval of its value for other seeds. NAN if
    // there is no error; above 1 if other classes cancel a part of it.
    struct interval share;
};

struct error_by {
    double error; // the whole local relMSE: mean D^2 over L^2 + 1e-2
    uint32_t count;
    struct error_share classes[ERROR_BY_CLASSES_MAX]; // each by itself
    double light[ERROR_BY_CLASSES_MAX];               // share of the picture's luminance (BT.709)
    struct error_share together;                      // the rest: twice the covariances
};

// Return a pixel's weighted D^2, and the sum over all pixels. The classes of the params are not
// used.
// used.
double metrics_error_of_pixel(const struct error_by_params *params, uint64_t pixel);
double metrics_error_sum(const struct error_by_params *params);

void metrics_error_by(const struct error_by_params *params, struct error_by *out);

// Combines `count` independent images with the same classes: means of errors and of light, and
// shares of the mean error, with intervals from the differences between images; NAN for a single
// image.
void metrics_error_by_pool(const struct error_by *pictures, uint32_t count, struct error_by *out);

#endif
