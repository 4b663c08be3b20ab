// The error of a picture from its two halves, without a reference.
//
// With A and B the means of two independent halves of the samples, M = (A + B) / 2 the picture and
// r the true value, the identity
//
//     (M - r)^2 = ((A - B) / 2)^2 + (A - r) (B - r)
//
// says what the halves know: the first term is at hand, the second a product of two independent
// errors, zero on average. So ((A - B) / 2)^2 estimates the error of this very picture, and what it
// is off by has the variance (Var A)(Var B), whatever the noise is like: a bright sample that both
// terms on the left and right share cancels. An interval for the error that other seeds would have
// on average could not be had so cheaply: it depends on how rare the brightest samples are, which a
// picture that lacks them cannot know.
//
// The sum over channels c of (A - r) (B - r) with weights w has the variance
// 4 sum_cd w_c w_d E[D_c D_d]^2, with D = (A - B) / 2. The pixel's own D gives one factor, the mean
// over its neighbours (and itself) the other: they are independent, so that the product has no bias
// where the noise is alike. Pixels are independent of each other; their variances add up.
//
// The weights stand for 1 / (r^2 + epsilon): half_weights.c says how. Where they come from the mean
// S over all neighbours, each pixel's noise M - r moves the weights of those around it: the sum by
// (M - r) times the mean over them of D^2 dw/dS, for which the pixel's own surroundings stand. That
// is uncorrelated with (A - r) (B - r), so that the variances add up again. Where
// they come from hypotheses, these say how much they may be wrong. Of that a part is the same
// everywhere, and does not go down with the number of pixels: see doubt_shared.
//
// The radius of the neighbourhood is the smallest that brings the relative variance of its mean
// down to 0.02 on the picture's average: the correction for it is then 6 % and what it leaves below
// 1 %.
#include "half_weights.h"

#include "parallel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    SAMPLES_MIN = 16,
    // A mean of n independent terms of which k carry most is itself uncertain by about 1/sqrt(k);
    // 30 is where the normal approximation is commonly trusted.
    CARRIERS_MIN = 30,
    RADIUS_MAX = 8,
    THREADS_MAX = 8, // each has rows of its own
    TILE_SIDE = 8,   // over which the relative variance is taken that decides on the radius
};

static const double usual_confidence = 0.95;

static const double relative_variance_wanted = 0.02;

static const double factor_max = 10; // an interval that is wider says nothing

// The part of the weights' doubt, a standard deviation, that all pixels share, and what the
// correction for the noise of the weights leaves of the error: measured, see docs/convergence.md.
static const double doubt_shared = 0.1, correction_shared = 0.005;

struct tile {
    double relative; // sum over the tile's pixels of the error, a mean over channels
    double squared;
    double pixels;          // finite ones
    double variance;        // of what the error is off by
    double variance_square; // sum of the squares of what the pixels add to it
    double doubt;           // sum of the standard deviations that are the weights'
};

// What a thread needs for itself.
struct band {
    struct half_sums *pixels;  // of each pixel by itself: the last `rows` ones, row y at y % rows
    uint32_t loaded;           // up to this row
    struct half_sums *columns; // of the rows around the present one
    struct half_sums *others;  // of these without the present one
    // The greatest CARRIERS_MIN - 1 relative errors of pixels, in ascending order.
    double greatest[CARRIERS_MIN - 1];
};

struct estimator {
    const struct half_error_params *params;
    uint32_t tile_side, tiles_x, tiles_y;
    uint32_t radius;
    uint32_t rows; // that a pixel's surroundings take
    struct tile *tiles;
    struct band *bands; // one a thread
    unsigned threads;
    bool any_light;
};

static uint32_t tiles_along(uint32_t length, uint32_t side)
{
    return (uint32_t)(((uint64_t)length + side - 1) / side);
}

static uint32_t least(uint32_t a, uint64_t b)
{
    return a < b ? a : (uint32_t)b;
}

// The picture's average of a pixel's relative variance, from the tiles' means.
static double relative_variance(struct estimator *estimator)
{
    const struct half_error_params *params = estimator->params;
    double sum = 0, pixels = 0;
    for (size_t tile = 0; tile < (size_t)estimator->tiles_x * estimator->tiles_y; tile++) {
        uint32_t side = estimator->tile_side;
        uint32_t x0 = (uint32_t)(tile % estimator->tiles_x) * side;
        uint32_t y0 = (uint32_t)(tile / estimator->tiles_x) * side;
        uint32_t x1 = least(params->width, (uint64_t)x0 + side);
        uint32_t y1 = least(params->height, (uint64_t)y0 + side);
        struct half_sums sums = {0};
        for (uint32_t y = y0; y < y1; y++)
            for (uint32_t x = x0; x < x1; x++)
                half_sums_add(&sums, params, (uint64_t)y * params->width + x);
        if (sums.pixels == 0)
            continue;
        for (int c = 0; c < 3; c++) {
            double mean = sums.mean[c] / sums.pixels;
            sum += sums.products[c] / (mean * mean + METRICS_RELMSE_EPSILON) / 3;
            estimator->any_light |= sums.mean[c] != 0;
        }
        pixels += sums.pixels;
    }
    return pixels > 0 ? sum / pixels : 0;
}

static void choose_radius(struct estimator *estimator)
{
    double neighbours_wanted = relative_variance(estimator) / relative_variance_wanted;
    uint32_t radius = 1;
    while (radius < RADIUS_MAX && (2 * radius + 1) * (2 * radius + 1) - 1 < neighbours_wanted)
        radius++;
    estimator->radius = radius;
}

// NULL outside of the picture.
static struct half_sums *row_of(const struct estimator *estimator, const struct band *band,
                                int64_t y)
{
    const struct half_error_params *params = estimator->params;
    if (y < 0 || y >= params->height)
        return NULL;
    return &band->pixels[(size_t)(y % estimator->rows) * params->width];
}

// Makes the rows around y ready, of which those before `loaded` are.
static void load_rows(const struct estimator *estimator, struct band *band, uint32_t y)
{
    const struct half_error_params *params = estimator->params;
    uint32_t end = least(params->height, (uint64_t)y + estimator->rows / 2 + 1);
    for (; band->loaded < end; band->loaded++) {
        struct half_sums *row = row_of(estimator, band, band->loaded);
        memset(row, 0, params->width * sizeof *row);
        for (uint32_t x = 0; x < params->width; x++)
            half_sums_add(&row[x], params, (uint64_t)band->loaded * params->width + x);
    }
}

// Sums down the columns of the rows within the radius of row y. The pixel itself is later left out
// by adding up the rest: taken away again, a very bright one would leave its rounding error.
static void sum_columns(const struct estimator *estimator, struct band *band, uint32_t y)
{
    uint32_t width = estimator->params->width;
    memset(band->others, 0, width * sizeof *band->others);
    for (int64_t row = (int64_t)y - estimator->radius; row <= (int64_t)y + estimator->radius;
         row++) {
        const struct half_sums *pixels = row_of(estimator, band, row);
        for (uint32_t x = 0; pixels && row != y && x < width; x++)
            half_sums_join(&band->others[x], &pixels[x]);
    }
    const struct half_sums *pixels = row_of(estimator, band, y);
    memcpy(band->columns, band->others, width * sizeof *band->columns);
    for (uint32_t x = 0; x < width; x++)
        half_sums_join(&band->columns[x], &pixels[x]);
}

// Keeps the list of the greatest ones sorted.
static void remember(struct band *band, double value)
{
    double *greatest = band->greatest;
    if (value <= greatest[0])
        return;
    int i = 0;
    for (; i + 1 < CARRIERS_MIN - 1 && greatest[i + 1] < value; i++)
        greatest[i] = greatest[i + 1];
    greatest[i] = value;
}

// w^T P w, P being products of D.
static double form(const double *w, const double *products)
{
    const double *p = products;
    return w[0] * w[0] * p[0] + w[1] * w[1] * p[1] + w[2] * w[2] * p[2] +
           2 * (w[0] * w[1] * p[3] + w[0] * w[2] * p[4] + w[1] * w[2] * p[5]);
}

// Of the sum over channels of w (A - r) (B - r): see the head of this file.
static double product_variance(const struct half_weight *judged, const struct half_sums *own)
{
    double both[6];
    for (int i = 0; i < 6; i++)
        both[i] = own->products[i] * judged->noise[i];
    return 4 * form(judged->weight, both);
}

// Of what comes from the weights' noise where they are those of the mean over all neighbours: what
// the pixel's noise adds by moving the weights of its neighbours, and what the noise of its own
// weight adds, which counts where few pixels have most of the error.
static double weight_variance(const struct half_weight *judged, const struct half_sums *own,
                              const struct half_sums *around)
{
    double slope[3], own_slope[3];
    for (int c = 0; c < 3; c++) {
        double mean = around->mean[c] / around->pixels;
        double square = mean * mean + METRICS_RELMSE_EPSILON;
        double change = 2 * mean / square * judged->weight[c];
        slope[c] = change * judged->noise[c];
        own_slope[c] = change * own->products[c];
    }
    return form(slope, own->products) + form(own_slope, judged->noise) / around->pixels;
}

static void add_pixel(struct tile *tile, struct band *band, const struct half_view *view,
                      const struct half_sums *around)
{
    const struct half_sums *own = &view->rows[HALF_REACH][view->x];
    // A pixel without a finite neighbour cannot be judged.
    if (own->pixels == 0 || around->pixels == 0)
        return;
    struct half_weight judged;
    half_weigh(view, around, &judged);
    double relative = 0;
    for (int c = 0; c < 3; c++) {
        relative += own->products[c] * judged.weight[c];
        tile->squared += own->products[c] / 3;
    }
    double variance = product_variance(&judged, own);
    variance += judged.structured ? judged.doubt : weight_variance(&judged, own, around);
    tile->relative += relative;
    tile->variance += variance;
    tile->variance_square += variance * variance;
    tile->doubt += sqrt(judged.doubt);
    tile->pixels++;
    remember(band, relative);
}

static void add_row(const struct estimator *estimator, struct band *band, uint32_t y)
{
    uint32_t width = estimator->params->width, side = estimator->tile_side;
    struct tile *tiles = &estimator->tiles[(size_t)(y / side) * estimator->tiles_x];
    struct half_view view = {.width = width};
    load_rows(estimator, band, y);
    sum_columns(estimator, band, y);
    for (int i = 0; i <= 2 * HALF_REACH; i++)
        view.rows[i] = row_of(estimator, band, (int64_t)y + i - HALF_REACH);
    for (view.x = 0; view.x < width; view.x++) {
        uint32_t x = view.x, radius = estimator->radius;
        uint32_t end = least(width, (uint64_t)x + radius + 1);
        struct half_sums around = band->others[x];
        for (uint32_t i = x > radius ? x - radius : 0; i < end; i++)
            if (i != x)
                half_sums_join(&around, &band->columns[i]);
        add_pixel(&tiles[x / side], band, &view, &around);
    }
}

// Rows of tiles; each tile is one thread's, so that the sums are the same for any number of them.
static void add_tiles(void *context, size_t begin, size_t end, unsigned thread)
{
    const struct estimator *estimator = context;
    struct band *band = &estimator->bands[thread];
    uint64_t side = estimator->tile_side;
    uint32_t first = (uint32_t)(begin * side), around = estimator->rows / 2;
    uint32_t last = least(estimator->params->height, end * side);
    band->loaded = first > around ? first - around : 0;
    for (uint32_t y = first; y < last; y++)
        add_row(estimator, band, y);
}

static void add_pixels(struct estimator *estimator)
{
    // Each part begins with rows that the one before had, too.
    size_t parts = (size_t)estimator->threads * 4;
    parallel_for(estimator->tiles_y, (estimator->tiles_y + parts - 1) / parts, estimator->threads,
                 add_tiles, estimator);
}

// What the greatest relative errors of pixels add up to.
static double carried(const struct estimator *estimator)
{
    struct band all = estimator->bands[0];
    double sum = 0;
    for (unsigned thread = 1; thread < estimator->threads; thread++)
        for (int i = 0; i < CARRIERS_MIN - 1; i++)
            remember(&all, estimator->bands[thread].greatest[i]);
    for (int i = 0; i < CARRIERS_MIN - 1; i++)
        sum += all.greatest[i];
    return sum;
}

static struct tile sum_tiles(const struct estimator *estimator)
{
    struct tile total = {0};
    for (size_t i = 0; i < (size_t)estimator->tiles_x * estimator->tiles_y; i++) {
        const struct tile *tile = &estimator->tiles[i];
        total.relative += tile->relative;
        total.squared += tile->squared;
        total.pixels += tile->pixels;
        total.variance += tile->variance;
        total.variance_square += tile->variance_square;
        total.doubt += tile->doubt;
    }
    return total;
}

// By which the error may be wrong. The interval is of the logarithm, which a sum of squares is more
// nearly normal in: a t interval with as many degrees of freedom as equal variances would make a
// sum as uncertain as the pixels' do (Satterthwaite 1946, "An approximate distribution of estimates
// of variance components").
static double uncertainty(const struct tile *total, double confidence)
{
    if (!(total->variance > 0))
        return 1;
    double outside = 0.5 * (1 - (confidence > 0 ? confidence : usual_confidence));
    double terms = total->variance * total->variance / total->variance_square;
    double shared = doubt_shared * total->doubt + correction_shared * total->relative;
    double deviation = sqrt(total->variance + shared * shared) / total->relative;
    return exp(deviation * stats_t_quantile(1 - outside, fmax(terms, 1)));
}

// Judges the sums; fills in what is known.
static void conclude(const struct estimator *estimator, struct half_error *out)
{
    struct tile total = sum_tiles(estimator);
    double factor = uncertainty(&total, estimator->params->confidence);
    if ((uint64_t)estimator->params->width * estimator->params->height < CARRIERS_MIN)
        out->reason = "the picture has fewer than 30 pixels";
    else if (total.pixels == 0)
        out->reason = "no pixel is finite in both halves";
    else if (!estimator->any_light)
        out->reason = "every sample so far is black";
    else if (total.pixels < CARRIERS_MIN)
        out->reason = "fewer than 30 pixels are finite in both halves";
    else if (total.relative > 0 && carried(estimator) >= total.relative / 2)
        out->reason = "fewer than 30 pixels carry half of the variance";
    else if (!(factor <= factor_max))
        out->reason = "it is uncertain by more than a factor of ten";
    if (out->reason)
        return;
    out->known = true;
    out->relmse = total.relative / total.pixels;
    out->mse = total.squared / total.pixels;
    out->ci_low = out->relmse / factor;
    out->ci_high = out->relmse * factor;
}

static bool allocate_band(struct band *band, uint32_t rows, uint32_t width)
{
    band->pixels = calloc((size_t)rows * width, sizeof *band->pixels);
    band->columns = calloc(width, sizeof *band->columns);
    band->others = calloc(width, sizeof *band->others);
    return band->pixels && band->columns && band->others;
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
    estimator->bands = calloc(estimator->threads, sizeof *estimator->bands);
    if (!estimator->tiles || !estimator->bands)
        return false;
    choose_radius(estimator);
    uint32_t reach = estimator->radius > HALF_REACH ? estimator->radius : HALF_REACH;
    estimator->rows = 2 * reach + 1;
    for (unsigned i = 0; i < estimator->threads; i++)
        if (!allocate_band(&estimator->bands[i], estimator->rows, params->width))
            return false;
    return true;
}

static void estimator_finish(struct estimator *estimator)
{
    for (unsigned i = 0; estimator->bands && i < estimator->threads; i++) {
        free(estimator->bands[i].pixels);
        free(estimator->bands[i].columns);
        free(estimator->bands[i].others);
    }
    free(estimator->bands);
    free(estimator->tiles);
}

bool metrics_half_error(const struct half_error_params *params, struct half_error *out)
{
    *out = (struct half_error){0};
    if (params->samples < SAMPLES_MIN) {
        out->reason = "fewer than 16 samples per pixel";
        return true;
    }
    if (params->width == 0 || params->height == 0) {
        out->reason = "the picture has no pixels";
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
        out[i] = tile->pixels > 0 ? tile->relative / tile->pixels : 0;
    }
    estimator_finish(&estimator);
    return ok;
}
