// Splits the error of an image, the local relMSE estimated from its half-buffers, by classes of
// light that have half-buffers of their own. Any thread may call these functions.
//
// With D = (A - B) / 2 of the image and D_k of class k, D is the sum of all D_k. In each pixel,
//
//     D^2 = sum_k D_k^2 + sum_j sum_k!=j D_j D_k
//
// so the variance of a sum is the sum of the variances and of the covariances, each counted twice.
// All terms have the same weights as D^2 (half_error.c). So, apart from rounding, the error is the
// sum of the classes' own errors and of their covariances. The covariances are negative if one
// class contributes more where another contributes less, for example emitters of which each sample
// chooses one. They are positive if a sample has contributions of all classes or of none, for
// example where a path either hits or misses a surface.
#ifndef LAMPYRIS_METRICS_ERROR_BY_H
#define LAMPYRIS_METRICS_ERROR_BY_H

#include "metrics/metrics.h"

#define ERROR_BY_CLASSES_MAX 8

struct error_by_params {
    const struct half_error_params *halves; // the half-buffers of the image
    const double (*weights)[3];             // computed by metrics_half_error_weights()
    // The half-buffers of the classes. Class k of pixel p has the index p * stride + k, with k <
    // count <= ERROR_BY_CLASSES_MAX.
    const float (*class_a)[3], (*class_b)[3];
    uint32_t count, stride;
};

// The part of the error that one class, or the covariances, contribute.
struct error_share {
    double error; // part of the local relMSE
    // The fraction of the total error, with the 95 % confidence interval of that fraction over
    // other seeds. NAN if there is no error; above 1 if covariances with other classes cancel a
    // part of it.
    struct interval share;
};

struct error_by {
    double error; // the local relMSE of the image: mean of D^2 / (L^2 + 1e-2)
    uint32_t count;
    struct error_share classes[ERROR_BY_CLASSES_MAX]; // errors of the classes alone
    double light[ERROR_BY_CLASSES_MAX];               // share of the image's luminance (BT.709)
    struct error_share together;                      // contribution of all covariances
};

// Return D^2 times its weight, summed over channels, for one pixel and for all pixels. They do not
// use the classes.
double metrics_error_of_pixel(const struct error_by_params *params, uint64_t pixel);
double metrics_error_sum(const struct error_by_params *params);

void metrics_error_by(const struct error_by_params *params, struct error_by *out);

// Combines the results of `count` independent images with the same classes: means of errors and of
// light, and shares of the mean error. The intervals come from the differences between images, and
// are NAN for a single image.
void metrics_error_by_pool(const struct error_by *pictures, uint32_t count, struct error_by *out);

#endif
