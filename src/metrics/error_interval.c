#include "metrics/metrics.h"

#include "metrics/pixel.h"

enum { TILE_SIDE = 16, LEAST_TILES = 16, TILES_A_POLL = 256, ERRORS = 3 };

struct tiling {
    const float (*image)[3];
    const float (*reference)[3];
    const float (*means)[3];
    uint32_t width, height, side;
};

struct tile_sum {
    double values;        // number of finite values
    double error[ERRORS]; // sums of the terms of mse, relmse and local relmse
};

static uint32_t tiles_along(uint32_t length, uint32_t side)
{
    return (length + side - 1) / side;
}

static uint64_t tile_count(const struct tiling *t)
{
    return (uint64_t)tiles_along(t->width, t->side) * tiles_along(t->height, t->side);
}

static struct tile_sum sum_tile(const struct tiling *t, uint64_t index)
{
    struct tile_sum sum = {0};
    uint32_t columns = tiles_along(t->width, t->side);
    uint32_t left = (uint32_t)(index % columns) * t->side;
    uint32_t top = (uint32_t)(index / columns) * t->side;
    for (uint32_t y = top; y < t->height && y - top < t->side; y++)
        for (uint32_t x = left; x < t->width && x - left < t->side; x++) {
            uint64_t i = (uint64_t)y * t->width + x;
            if (!pixel_is_finite(t->image[i]) || !pixel_is_finite(t->reference[i]))
                continue;
            for (int c = 0; c < 3; c++) {
                double r = t->reference[i][c], d = t->image[i][c] - r, l = t->means[i][c];
                sum.values++;
                sum.error[0] += d * d;
                sum.error[1] += d * d / (r * r + METRICS_RELMSE_EPSILON);
                sum.error[2] += d * d / (l * l + METRICS_RELMSE_EPSILON);
            }
        }
    return sum;
}

// Returns the interval of a ratio of two sums over tiles. `residuals` is the sum of the squared
// deviations of the tiles' terms, from which the variance follows (Cochran 1977, "Sampling
// Techniques", eq. 6.13); a ratio is needed because tiles at the border are smaller.
static struct interval ratio_interval(double ratio, double residuals, double values, double tiles)
{
    double half =
        sqrt(tiles / (tiles - 1) * residuals) / values * stats_t_quantile(0.975, tiles - 1);
    return (struct interval){ratio, ratio - half, ratio + half};
}

bool metrics_intervals(const float (*image)[3], const float (*reference)[3],
                       const float (*means)[3], uint32_t width, uint32_t height,
                       const struct progress *progress, struct error_intervals *out)
{
    struct tiling t = {image, reference, means, width, height, TILE_SIDE};
    while (t.side > 1 && tile_count(&t) < LEAST_TILES)
        t.side /= 2;
    struct tile_sum all = {0};
    double residuals[ERRORS] = {0}, tiles = 0;
    for (uint64_t i = 0; i < tile_count(&t); i++) {
        if (i % TILES_A_POLL == 0 && progress_should_stop(progress))
            return false;
        struct tile_sum one = sum_tile(&t, i);
        tiles += one.values > 0;
        all.values += one.values;
        for (int k = 0; k < ERRORS; k++)
            all.error[k] += one.error[k];
    }
    for (uint64_t i = 0; i < tile_count(&t); i++) {
        if (i % TILES_A_POLL == 0 && progress_should_stop(progress))
            return false;
        struct tile_sum one = sum_tile(&t, i);
        for (int k = 0; k < ERRORS; k++) {
            double residual = one.error[k] - all.error[k] / all.values * one.values;
            residuals[k] += one.values > 0 ? residual * residual : 0;
        }
    }
    struct interval *intervals[ERRORS] = {&out->mse, &out->relmse, &out->local_relmse};
    for (int k = 0; k < ERRORS; k++) {
        double ratio = all.values > 0 ? all.error[k] / all.values : NAN;
        *intervals[k] = tiles > 1 ? ratio_interval(ratio, residuals[k], all.values, tiles)
                                  : (struct interval){ratio, NAN, NAN};
    }
    return true;
}
