// Estimates the error of an image from its two halves, without a reference.
//
// Let A and B be the means of two independent halves of the samples, M = (A + B) / 2 the image and
// r the true value. Then
//
//     (M - r)^2 = ((A - B) / 2)^2 + (A - r) (B - r).
//
// The first term, D^2, is known. The second one is a product of two independent errors, so its mean
// is zero. Hence D^2 estimates the error of this image, whatever the distribution of the noise is:
// a bright sample increases both sides equally. The expected error over other seeds cannot be
// estimated that easily: it depends on how rare the brightest samples are, and an image without
// such samples does not show that.
//
// The weight of D^2 is 1 / (L^2 + epsilon). L is the mean around the pixel (local_mean.h). It
// consists of the neighbours' mean S, which is independent of the halves of the pixel itself, so
// that numerator and denominator are independent, and of the pixel's own value r with a small
// weight. M is no suitable estimate of r, because a pixel with a bright sample has both a large D^2
// and a large M. The median of A, B and S is suitable: a bright sample is in one of A and B only, a
// bright object in both. If most of the light is in one half, as with an object that few bright
// samples hit, r is only known to be between the lesser half and M. So for pixels that stand out,
// the error is computed for both ends, and the interval contains both. S is noisy as well, and 1 /
// (S^2 + epsilon) is convex: if V is the variance of S, estimated from the neighbours' D^2, the
// expectation is to second order (1 + (3 S^2 - epsilon) V / (S^2 + epsilon)^2) / (L^2 + epsilon).
// The weight is divided by the first factor if that is above 1.
//
// The interval. (A - r) (B - r) has the variance Var A Var B = 4 E[D^2]^2. If the noise is similar
// around the pixel, one factor is the pixel's own D^2 and the other the mean D^2 of its neighbours.
// For a pixel that stands out from its neighbours the variance is 4/3 D^4, the unbiased estimate
// for normal values, or the square of (A - S) (B - S) if that is less: beside a bright sample in A,
// B is still as close to r as usual. Channels share their noise, so their standard deviations are
// added; pixels do not, so their variances are added. The noise of S changes the weights: M - r of
// a pixel changes those of all pixels around it, and the noise of these changes its own weight. The
// interval is computed for the logarithm, whose distribution is closer to normal than that of a sum
// of squares. It is a t interval with as many degrees of freedom as a sum of equal variances with
// the same uncertainty would have (Satterthwaite 1946, "An approximate distribution of estimates of
// variance components").
//
// Emitters in view that no sample has hit. The scene defines the position, radiance and size of an
// emitter that is much smaller than a pixel, and so the light r that the pixel lacks until a sample
// hits it. If no pixel in which the emitter may be visible exceeds the median of its neighbours by
// half of one such sample, none has hit it, and the image's error is larger than D^2 by r^2 / ((p r
// + L)^2 + epsilon), where p is the pixel's part of the window. The bound includes this.
// small_lights.h describes the error of emitters that samples have hit.
//
// Light that paths find by chance. The contributions of all paths that hit a bright emitter by
// chance have the sum F per sample. If in no pixel, except those with an emitter in view, the
// halves differ by as much as such a path contributes, up to three such paths may have been
// expected in all samples (with three, the probability of none is 5 %). So the pixels' sum may lack
// 3 F / N. The error is greatest if this light is distributed so that each pixel that it reaches
// lacks r; per unit of light it is r / ((p r + L)^2 + epsilon), p being the pixel's part of the
// window, which is at most 1 / (2 p (L + sqrt(L^2 + epsilon))). The bound includes this; an
// interval is reported only if it is small.
#include "base/parallel.h"
#include "metrics/local_mean.h"
#include "metrics/metrics.h"
#include "metrics/pixel.h"
#include "metrics/small_lights.h"
#include <math.h>
#include <stdlib.h>

enum {
    SAMPLES_MIN = 2,
    PIXELS_MIN = 30,
    THREADS_MAX = 8, // each thread has a window of rows
    TILE_SIDE = 8,
};

static const double usual_confidence = 0.95;

// A pixel stands out if its D^2 is more than this many times the mean of its neighbours, that is,
// if its deviation is more than twice theirs.
static const double outlier = 4;

// Beyond these limits few pixels have nearly all of the error, so only the bound is reported.
// factor_max limits the ratio of the interval's ends (a factor of ten in either direction),
// open_max the part of that ratio that is due to the uncertainty of the pixels' own values.
static const double factor_max = 100, open_max = 10;

// The number of paths that may have been expected though none was found: with this number, the
// probability of none is exp(-3) = 5 %.
static const double unseen_paths = 3;
// A contribution of at least this fraction of F, the brightest light, counts as a path that found
// the light: reflections may absorb three quarters of it.
static const double seen_part = 0.25;
// Below this fraction of the error, unseen light only increases the upper end of the interval.
static const double unseen_negligible = 0.1;

// The sum of the pixels' variances, and the sum of their squares.
struct variance {
    double sum, squares;
};

// Sums over pixels, where the error of a pixel is the mean over its channels.
struct tile {
    double error;
    // The error with the least and greatest weights that the pixels' own values permit.
    double least, most;
    double relmse_most;
    double squared;
    double pixels; // number of finite pixels
    // Variance of `error`, for its upper and its lower end.
    struct variance up, down;
    // Sum of the squared errors, for the standard deviation over seeds; see forecast.c.
    struct variance spread;
    struct variance relmse; // variance of `relmse_most`
    // Sum over pixels of the greatest error that a unit of light may add.
    double unseen;
    struct small_lights small_lights;
    // Greatest contribution of one sample, from |A - B|.
    double brightest;
    double light; // greatest |M|
};

struct estimator {
    const struct half_error_params *params;
    uint32_t tile_side, tiles_x, tiles_y;
    struct tile *tiles;
    struct local_window *windows; // one per thread
    unsigned threads;
    double (*weights)[3]; // NULL, or where to store the pixels' weights instead of computing tiles
};

static uint32_t tiles_along(uint32_t length, uint32_t side)
{
    return (uint32_t)(((uint64_t)length + side - 1) / side);
}

static double median(double a, double b, double c)
{
    return fmax(fmin(a, b), fmin(fmax(a, b), c));
}

static void load_halves(const void *context, uint64_t pixel, struct local_pixel *out)
{
    const struct half_error_params *params = context;
    const float *a = params->half_a[pixel], *b = params->half_b[pixel];
    if (!pixel_is_finite(a) || !pixel_is_finite(b))
        return;
    for (int c = 0; c < 3; c++) {
        double difference = ((double)a[c] - b[c]) / 2;
        out->mean[c] = ((double)a[c] + b[c]) / 2;
        out->noise[c] = difference * difference;
    }
    out->part = 1;
}

// The variance of (A - r) (B - r), separately for errors above D^2 and below it.
struct product_variance {
    double up, down;
};

static struct product_variance find_product_variance(double a, double b, double noise,
                                                     bool stands_out,
                                                     const struct local_mean *around, int c)
{
    double as_others = 4 * noise * around->noise[c], own = 4.0 / 3 * noise * noise;
    if (!stands_out)
        return (struct product_variance){as_others, as_others};
    double alone = (a - around->mean[c]) * (b - around->mean[c]);
    return (struct product_variance){fmax(as_others, fmin(own, alone * alone)),
                                     fmax(as_others, own)};
}

static double find_noise(float a, float b)
{
    double difference = (double)a - b;
    return difference * difference / 4;
}

// Returns the mean around a pixel, or the pixel's own value if it has no finite neighbours.
static double find_near(float a, float b, const struct local_mean *around, int c)
{
    return around->own < 1 ? around->mean[c] : ((double)a + b) / 2;
}

// Returns the greatest error per unit of light that no sample has found, for the neighbours' mean
// `mean` and the pixel's part `own` of the window.
static double error_of_unseen(double mean, double own)
{
    double rest = fabs((1 - own) * mean);
    return 1 / (2 * own * (rest + hypot(rest, sqrt(METRICS_RELMSE_EPSILON)))) / 3;
}

static void add_variance(struct variance *variance, double of_pixel)
{
    variance->sum += of_pixel;
    variance->squares += of_pixel * of_pixel;
}

static void join_variances(struct variance *variance, const struct variance *other)
{
    variance->sum += other->sum;
    variance->squares += other->squares;
}

// Adds the error of a pixel, its variance and the limits for uncertain weights, assuming that the
// noise is similar to that of the neighbours unless the pixel stands out. Returns the pixel's
// error.
static double add_noise(struct tile *tile, const float a[3], const float b[3],
                        const struct local_mean *around)
{
    double error = 0, up = 0, down = 0, relmse = 0, moves_others = 0, moved_by_others = 0;
    for (int c = 0; c < 3; c++) {
        double mean = ((double)a[c] + b[c]) / 2, lesser = fmin(a[c], b[c]);
        double noise = find_noise(a[c], b[c]);
        double near = find_near(a[c], b[c], around, c), own = median(a[c], b[c], near);
        struct local_weight weight = local_weigh(own, around, c);
        double positive = fmax(lesser, 0);
        bool stands_out = noise > outlier * around->noise[c];
        error += noise * weight.value;
        tile->least += noise * local_weigh(stands_out ? fmax(mean, own) : own, around, c).value;
        tile->most += noise * local_weigh(stands_out ? fmin(lesser, near) : own, around, c).value;
        double steepest = 1 / (positive * positive + METRICS_RELMSE_EPSILON) / 3;
        tile->relmse_most += noise * steepest;
        struct product_variance product =
            find_product_variance(a[c], b[c], noise, stands_out, around, c);
        up += weight.value * sqrt(product.up);
        relmse += steepest * sqrt(product.up);
        down += weight.value * sqrt(product.down);
        moves_others += weight.slope * around->noise[c] * sqrt(noise);
        moved_by_others += weight.slope * noise * sqrt(around->mean_noise[c]);
    }
    double weights = moves_others * moves_others + moved_by_others * moved_by_others;
    add_variance(&tile->up, up * up + weights);
    add_variance(&tile->down, down * down + weights);
    add_variance(&tile->relmse, relmse * relmse);
    return error;
}

// Adds the quantities of a pixel that do not depend on the model of its noise.
static void add_light(struct tile *tile, const struct half_error_params *params, uint64_t pixel,
                      const struct local_mean *around)
{
    const float *a = params->half_a[pixel], *b = params->half_b[pixel];
    const uint8_t *emitter_in_view = params->unseen.emitter_in_view;
    double samples = half_error_samples(params, pixel);
    for (int c = 0; c < 3; c++) {
        // A sample in one half was divided by the number of samples in that half.
        double of_sample = fabs((double)a[c] - b[c]) * samples / 2;
        tile->squared += find_noise(a[c], b[c]) / 3;
        tile->unseen += error_of_unseen(around->mean[c], around->own) / fmax(samples, 1);
        if (!emitter_in_view || !emitter_in_view[pixel])
            tile->brightest = fmax(tile->brightest, of_sample);
        tile->light = fmax(tile->light, fabs((double)a[c] + b[c]) / 2);
    }
    tile->pixels++;
}

// Adds a pixel. `light` is the small emitter that is visible in it, or NULL.
static void add_pixel(struct tile *tile, const struct half_error_params *params, uint64_t pixel,
                      const struct small_light *light, const struct local_mean *around)
{
    const float *a = params->half_a[pixel], *b = params->half_b[pixel];
    if (!pixel_is_finite(a) || !pixel_is_finite(b))
        return;
    add_light(tile, params, pixel, around);
    double error = light ? small_lights_add(&tile->small_lights, params, light, around) : NAN;
    if (isnan(error))
        error = add_noise(tile, a, b, around);
    tile->error += error;
    add_variance(&tile->spread, error * error);
}

// Computes the weights of a pixel's D^2, as add_noise() does.
static void find_weights(const float a[3], const float b[3], const struct local_mean *around,
                         double out[3])
{
    bool is_finite = pixel_is_finite(a) && pixel_is_finite(b);
    for (int c = 0; c < 3; c++) {
        double own = median(a[c], b[c], find_near(a[c], b[c], around, c));
        out[c] = is_finite ? local_weigh(own, around, c).value : 0;
    }
}

static void add_row(const struct estimator *estimator, struct local_window *window, uint32_t y)
{
    const struct half_error_params *params = estimator->params;
    uint32_t side = estimator->tile_side;
    struct tile *tiles = &estimator->tiles[(size_t)(y / side) * estimator->tiles_x];
    uint64_t first = (uint64_t)y * params->width;
    const struct small_light *light = small_lights_from(&params->unseen, 0, y);
    const struct small_light *end = params->unseen.small + params->unseen.small_count;
    local_window_enter(window, y);
    for (uint32_t x = 0; x < params->width; x++) {
        struct local_mean around;
        local_mean_at(window, x, &around);
        if (estimator->weights) {
            find_weights(params->half_a[first + x], params->half_b[first + x], &around,
                         estimator->weights[first + x]);
            continue;
        }
        bool has_light = light < end && light->y == y && light->x == x;
        add_pixel(&tiles[x / side], params, first + x, has_light ? light : NULL, &around);
        light += has_light;
    }
}

// Processes rows of tiles. Each tile belongs to one thread, so that the sums do not depend on the
// number of threads.
static void add_tiles(void *context, size_t begin, size_t end, unsigned thread)
{
    const struct estimator *estimator = context;
    struct local_window *window = &estimator->windows[thread];
    uint64_t first = begin * estimator->tile_side, last = end * (uint64_t)estimator->tile_side;
    local_window_start(window, (uint32_t)first);
    for (uint64_t y = first; y < last && y < estimator->params->height; y++)
        add_row(estimator, window, (uint32_t)y);
}

static void add_pixels(struct estimator *estimator)
{
    // The window of each part is filled with rows of the previous part first, so parts should not
    // be too small.
    size_t parts = (size_t)estimator->threads * 4;
    parallel_for(estimator->tiles_y, (estimator->tiles_y + parts - 1) / parts, estimator->threads,
                 add_tiles, estimator);
}

static struct tile sum_tiles(const struct estimator *estimator)
{
    struct tile total = {0};
    for (size_t i = 0; i < (size_t)estimator->tiles_x * estimator->tiles_y; i++) {
        const struct tile *tile = &estimator->tiles[i];
        total.error += tile->error;
        total.least += tile->least;
        total.most += tile->most;
        total.relmse_most += tile->relmse_most;
        total.squared += tile->squared;
        total.pixels += tile->pixels;
        join_variances(&total.up, &tile->up);
        join_variances(&total.down, &tile->down);
        join_variances(&total.relmse, &tile->relmse);
        join_variances(&total.spread, &tile->spread);
        total.unseen += tile->unseen;
        small_lights_join(&total.small_lights, &tile->small_lights);
        total.brightest = fmax(total.brightest, tile->brightest);
        total.light = fmax(total.light, tile->light);
    }
    return total;
}

// Returns the number of equal terms whose sum would have the same relative uncertainty.
static double terms_of(const struct variance *variance)
{
    return fmax(variance->sum * variance->sum / variance->squares, 1);
}

// Returns the given quantile of the error's deviation, divided by the error.
static double relative_uncertainty(double error, const struct variance *variance, double quantile)
{
    if (!(variance->sum > 0) || !(error > 0))
        return 0;
    return sqrt(variance->sum) / error * stats_t_quantile(quantile, terms_of(variance));
}

// The greatest mean error and relMSE due to light that no sample has found.
struct unseen {
    double error, relmse;
};

static struct unseen find_unseen(const struct half_error_params *params, const struct tile *total)
{
    double by_chance = params->unseen.by_chance;
    if (!(by_chance > 0) || total->brightest >= seen_part * by_chance)
        return (struct unseen){0};
    double light = unseen_paths * by_chance / total->pixels;
    return (struct unseen){
        .error = light * total->unseen / total->pixels,
        .relmse = light / (2 * sqrt(METRICS_RELMSE_EPSILON)) / (double)params->samples,
    };
}

static void conclude(const struct estimator *estimator, struct half_error *out)
{
    const struct half_error_params *params = estimator->params;
    struct tile total = sum_tiles(estimator);
    if ((uint64_t)params->width * params->height < PIXELS_MIN)
        out->reason = "the image has fewer than 30 pixels";
    else if (total.pixels < PIXELS_MIN)
        out->reason = "fewer than 30 pixels are finite in both halves";
    else if (!(total.light > 0))
        out->reason = "all samples so far are black";
    if (out->reason)
        return;
    double confidence = params->confidence > 0 ? params->confidence : usual_confidence;
    double two_sided = 0.5 + 0.5 * confidence;
    double up = exp(relative_uncertainty(total.error, &total.up, two_sided));
    double down = exp(relative_uncertainty(total.error, &total.down, two_sided));
    double bound = exp(relative_uncertainty(total.error, &total.up, confidence));
    const struct light_errors *lights = &total.small_lights.error;
    // The bound of relMSE is linear: few pixels dominate relMSE, and a factor exp(uncertainty)
    // would soon exceed what is possible.
    double relmse_most =
        total.relmse_most + light_errors_most(&total.small_lights.relmse, confidence);
    double relmse_bound = 1 + relative_uncertainty(relmse_most, &total.relmse, confidence);
    struct unseen unseen = find_unseen(params, &total);
    out->local_relmse = total.error / total.pixels;
    out->mse = total.squared / total.pixels;
    if (total.error > 0) {
        out->spread = sqrt(total.spread.sum) / total.error;
        out->spread_terms = terms_of(&total.spread);
    }
    double most = total.most + light_errors_most(lights, confidence);
    out->at_most = most / total.pixels * bound + unseen.error;
    out->relmse_at_most = relmse_most / total.pixels * relmse_bound + unseen.relmse;
    most = total.most + light_errors_most(lights, two_sided);
    out->ci_low = (total.least + light_errors_least(lights, two_sided)) / total.pixels / down;
    out->ci_high = most / total.pixels * up + unseen.error;
    if (lights->unmet > total.error)
        out->reason = "no sample has hit a small emitter that is in view";
    else if (unseen.error > unseen_negligible * out->local_relmse)
        out->reason = "no path has hit the brightest light, which paths find only by chance";
    else if (!(out->ci_high <= factor_max * out->ci_low && total.most <= open_max * total.least))
        out->reason = "few pixels have most of the error";
    out->known = !out->reason;
    out->bounded = isfinite(out->at_most);
}

static bool estimator_init(struct estimator *estimator, const struct half_error_params *params,
                           uint32_t side)
{
    unsigned cpus = cpu_count();
    *estimator = (struct estimator){
        .params = params,
        .tile_side = side,
        .tiles_x = tiles_along(params->width, side),
        .tiles_y = tiles_along(params->height, side),
        .threads = cpus < THREADS_MAX ? cpus : THREADS_MAX,
    };
    size_t tiles = (size_t)estimator->tiles_x * estimator->tiles_y;
    estimator->tiles = calloc(tiles, sizeof *estimator->tiles);
    estimator->windows = calloc(estimator->threads, sizeof *estimator->windows);
    if (!estimator->tiles || !estimator->windows)
        return false;
    for (unsigned i = 0; i < estimator->threads; i++)
        if (!local_window_init(&estimator->windows[i], params->width, params->height, load_halves,
                               params))
            return false;
    return true;
}

static void estimator_finish(struct estimator *estimator)
{
    for (unsigned i = 0; estimator->windows && i < estimator->threads; i++)
        local_window_finish(&estimator->windows[i]);
    free(estimator->windows);
    free(estimator->tiles);
}

bool metrics_half_error(const struct half_error_params *params, struct half_error *out)
{
    *out = (struct half_error){.at_most = INFINITY, .relmse_at_most = INFINITY};
    if (params->samples < SAMPLES_MIN) {
        out->reason = "fewer than two samples per pixel";
        return true;
    }
    if (params->width == 0 || params->height == 0) {
        out->reason = "the image has no pixels";
        return true;
    }
    struct estimator estimator;
    bool ok = estimator_init(&estimator, params, TILE_SIDE);
    if (ok) {
        add_pixels(&estimator);
        conclude(&estimator, out);
    }
    estimator_finish(&estimator);
    return ok;
}

bool metrics_tile_errors(const struct half_error_params *params, uint32_t side, double *out)
{
    struct estimator estimator;
    bool ok = estimator_init(&estimator, params, side);
    if (ok)
        add_pixels(&estimator);
    for (size_t i = 0; ok && i < (size_t)estimator.tiles_x * estimator.tiles_y; i++) {
        const struct tile *tile = &estimator.tiles[i];
        out[i] = tile->pixels > 0 ? tile->error / tile->pixels : 0;
    }
    estimator_finish(&estimator);
    return ok;
}

bool metrics_half_error_weights(const struct half_error_params *params, double (*out)[3])
{
    struct estimator estimator;
    bool ok = estimator_init(&estimator, params, TILE_SIDE);
    estimator.weights = out;
    if (ok)
        add_pixels(&estimator);
    estimator_finish(&estimator);
    return ok;
}
