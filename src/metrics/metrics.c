#include "metrics.h"

#include <math.h>
#include <string.h>

static bool is_finite(const float pixel[3])
{
    return isfinite(pixel[0]) && isfinite(pixel[1]) && isfinite(pixel[2]);
}

// Of the bits: 0 and -0 differ, and a NaN is like itself.
static bool is_same(const float a[3], const float b[3])
{
    uint32_t a_bits[3], b_bits[3];
    memcpy(a_bits, a, sizeof a_bits);
    memcpy(b_bits, b, sizeof b_bits);
    return a_bits[0] == b_bits[0] && a_bits[1] == b_bits[1] && a_bits[2] == b_bits[2];
}

void metrics_compare(const float (*image)[3], const float (*reference)[3], uint64_t pixel_count,
                     struct metrics *out)
{
    *out = (struct metrics){0};
    double squares = 0, relative_squares = 0, symmetric = 0;
    for (uint64_t i = 0; i < pixel_count; i++) {
        out->differing += !is_same(image[i], reference[i]);
        if (!is_finite(image[i]) || !is_finite(reference[i])) {
            out->nonfinite++;
            continue;
        }
        for (int c = 0; c < 3; c++) {
            double r = reference[i][c], difference = image[i][c] - r;
            squares += difference * difference;
            symmetric += 2 * fabs(difference) / (fabs((double)image[i][c]) + fabs(r) + 1e-6);
            relative_squares += difference * difference / (r * r + METRICS_RELMSE_EPSILON);
            if (fabs(difference) > out->max) {
                out->max = fabs(difference);
                out->max_pixel = i;
            }
        }
    }
    // Without a single finite pixel nothing is known, and 0 would claim equality.
    double values = 3 * (double)(pixel_count - out->nonfinite);
    out->mse = values > 0 ? squares / values : NAN;
    out->relmse = values > 0 ? relative_squares / values : NAN;
    out->smape = values > 0 ? symmetric / values : NAN;
    out->rmse = sqrt(out->mse);
    out->psnr = -10 * log10(out->mse);
}

// Position in [0, 1] on the scale of metrics_difference_picture.
static double difference_level(const float x[3], const float r[3])
{
    const double decades = 4; // from 1e-4 to 1
    double sum = 0;
    for (int c = 0; c < 3; c++)
        sum += fabs((double)x[c] - r[c]) / (fabs((double)r[c]) + METRICS_RELMSE_EPSILON);
    return fmin(fmax(1 + log10(sum / 3) / decades, 0), 1); // log10(0) is -inf
}

void metrics_difference_picture(const float (*image)[3], const float (*reference)[3],
                                uint64_t pixel_count, float (*out)[3])
{
    static const float colours[][3] = {{0, 0, 0}, {0, 0, 1}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}};
    static const float nonfinite_colour[3] = {1, 0, 1};
    enum { SEGMENTS = sizeof colours / sizeof colours[0] - 1 };
    for (uint64_t i = 0; i < pixel_count; i++) {
        if (!is_finite(image[i]) || !is_finite(reference[i])) {
            memcpy(out[i], nonfinite_colour, sizeof out[i]);
            continue;
        }
        double position = SEGMENTS * difference_level(image[i], reference[i]);
        int segment = position < SEGMENTS ? (int)position : SEGMENTS - 1;
        float t = (float)(position - segment);
        for (int c = 0; c < 3; c++)
            out[i][c] = (1 - t) * colours[segment][c] + t * colours[segment + 1][c];
    }
}
