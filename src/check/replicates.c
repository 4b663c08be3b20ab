#include "check/replicates.h"

#include "metrics/metrics.h"
#include <math.h>
#include <string.h>

static void measure_mean(const struct film_image *film, double *values)
{
    size_t pixels = (size_t)film->width * film->height;
    for (int c = 0; c < 3; c++) {
        double sum = 0.0;
        for (size_t i = 0; i < pixels; i++)
            sum += film->mean[i][c];
        values[c] = sum / (double)pixels;
    }
}

const struct measurement MEASURE_MEAN = {3, measure_mean};

static void measure_tiles(const struct film_image *film, uint32_t tiles, double *values)
{
    uint32_t whole = tiles * tiles;
    memset(values, 0, (whole + 1) * sizeof *values);
    for (uint32_t y = 0; y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++) {
            const float *pixel = film->mean[y * film->width + x];
            double sum = (double)pixel[0] + (double)pixel[1] + (double)pixel[2];
            values[y * tiles / film->height * tiles + x * tiles / film->width] += sum;
            values[whole] += sum;
        }
}

static void measure_2x2_tiles(const struct film_image *film, double *values)
{
    measure_tiles(film, 2, values);
}

static void measure_4x4_tiles(const struct film_image *film, double *values)
{
    measure_tiles(film, 4, values);
}

const struct measurement MEASURE_2X2_TILES = {5, measure_2x2_tiles};
const struct measurement MEASURE_4X4_TILES = {17, measure_4x4_tiles};

bool replicates_render(struct renderer *r, const struct measurement *measurement,
                       uint32_t first_seed, uint64_t samples, struct replicates *out,
                       struct err *err)
{
    const struct render_call call = {.samples = samples};
    struct arena arena = {0};
    bool ok = true;
    out->count = measurement->count;
    for (uint32_t i = 0; ok && i < REPLICATES; i++) {
        struct film_image film;
        double values[REPLICATES_VALUES];
        if (progress_should_stop(r->progress))
            ok = err_set(err, ERR_STOPPED, "stopped");
        ok = ok && renderer_restart(r, first_seed + i, err) && renderer_render(r, &call, err) &&
             renderer_read(r, &arena, &film, err);
        if (!ok)
            break;
        measurement->measure(&film, values);
        for (uint32_t v = 0; v < measurement->count; v++)
            out->values[v][i] = values[v];
        arena_finish(&arena);
    }
    arena_finish(&arena);
    return ok;
}

struct estimate replicates_estimate(const struct replicates *replicates, uint32_t value)
{
    struct estimate e;
    double variance;
    stats_mean_variance(replicates->values[value], REPLICATES, &e.mean, &variance);
    e.standard_error = sqrt(variance / REPLICATES);
    e.half_width = e.standard_error * stats_t_quantile(0.975, REPLICATES - 1);
    return e;
}

// The first seed of pilots. It is far from the seeds of the tests, because the samples that decide
// how many are needed must not be part of the test.
#define PILOT_SEED 1000000u
#define PILOT_SAMPLES 4
// A safety factor. The pilot's variance and the test's variance each have a standard error of 18 %
// (their chi-squares have 63 degrees of freedom). The ratio of the two variances exceeds 2 in less
// than 0.4 % of cases.
#define PILOT_MARGIN 2.0

// Returns the number of samples that the desired half-width takes, if PILOT_SAMPLES samples have
// `ratio` times that half-width. With more samples the variance decreases at least as 1 / N. With
// fewer samples it may increase as 1 / N^3 if the integrand is smooth (Owen 1997, "Scrambled net
// variance for integrals of smooth functions").
static double samples_needed(double ratio)
{
    double part = PILOT_MARGIN * ratio * ratio;
    return PILOT_SAMPLES * (part < 1.0 ? cbrt(part) : part);
}

bool replicates_pilot(struct renderer *r, const struct measurement *measurement, double relative,
                      uint64_t most, uint64_t *samples, struct err *err)
{
    struct replicates pilot;
    if (!replicates_render(r, measurement, PILOT_SEED, PILOT_SAMPLES, &pilot, err))
        return false;
    double needed = 1.0;
    for (uint32_t v = 0; v < pilot.count; v++) {
        struct estimate e = replicates_estimate(&pilot, v);
        double ratio = e.mean > 0.0 ? e.half_width / (relative * e.mean) : 0.0;
        needed = fmax(needed, samples_needed(ratio));
    }
    // A wave has up to 16 samples of a pixel, so larger numbers are rounded up to a multiple of 16.
    uint64_t step = needed <= 16.0 ? 1 : 16;
    *samples = needed < (double)most ? (uint64_t)ceil(needed / (double)step) * step : most;
    return true;
}
