#include "metrics/metrics.h"

#include "metrics/pixel.h"
#include <math.h>
#include <string.h>

// Compares bits: 0 differs from -0, and a NaN is equal to the same NaN.
static bool is_same(const float a[3], const float b[3])
{
    uint32_t a_bits[3], b_bits[3];
    memcpy(a_bits, a, sizeof a_bits);
    memcpy(b_bits, b, sizeof b_bits);
    return a_bits[0] == b_bits[0] && a_bits[1] == b_bits[1] && a_bits[2] == b_bits[2];
}

double metrics_psnr(const float (*image)[3], const float (*reference)[3], uint64_t pixel_count,
                    double exposure_stops, const struct progress *progress)
{
    double squares = 0, factor = exp2(exposure_stops);
    uint64_t finite = 0;
    for (uint64_t i = 0; i < pixel_count; i++) {
        if (progress_stops_at(progress, i))
            return NAN;
        if (!pixel_is_finite(image[i]) || !pixel_is_finite(reference[i]))
            continue;
        finite++;
        for (int c = 0; c < 3; c++) {
            double x = image[i][c], r = reference[i][c];
            double difference = x == r ? 0 : display_value(factor * x) - display_value(factor * r);
            squares += difference * difference;
        }
    }
    return finite > 0 ? -10 * log10(squares / (3 * (double)finite)) : NAN;
}

bool metrics_compare(const float (*image)[3], const float (*reference)[3], uint64_t pixel_count,
                     const struct progress *progress, struct metrics *out)
{
    *out = (struct metrics){0};
    double squares = 0, relative_squares = 0, symmetric = 0;
    for (uint64_t i = 0; i < pixel_count; i++) {
        if (progress_stops_at(progress, i))
            return false;
        out->differing += !is_same(image[i], reference[i]);
        if (!pixel_is_finite(image[i]) || !pixel_is_finite(reference[i])) {
            out->nonfinite++;
            continue;
        }
        for (int c = 0; c < 3; c++) {
            double r = reference[i][c], difference = image[i][c] - r;
            squares += difference * difference;
            symmetric += 2 * fabs(difference) /
                         (fabs((double)image[i][c]) + fabs(r) + METRICS_SMAPE_EPSILON);
            relative_squares += difference * difference / (r * r + METRICS_RELMSE_EPSILON);
            if (fabs(difference) > out->max) {
                out->max = fabs(difference);
                out->max_pixel = i;
            }
        }
    }
    // If no pixel is finite, the error is not known; 0 would mean that the images are equal.
    double values = 3 * (double)(pixel_count - out->nonfinite);
    out->mse = values > 0 ? squares / values : NAN;
    out->relmse = values > 0 ? relative_squares / values : NAN;
    out->smape = values > 0 ? symmetric / values : NAN;
    out->rmse = sqrt(out->mse);
    out->psnr = metrics_psnr(image, reference, pixel_count, 0, progress);
    return !progress_should_stop(progress);
}
