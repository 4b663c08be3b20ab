#include "metrics/forecast.h"

#include "metrics/bias.h"
#include "metrics/metrics.h"
#include "metrics/pixel.h"
#include <math.h>

enum {
    // The forecast treats tiles as independent, as error_interval.c does. The noise of pixels is
    // independent, so tiles may be smaller if otherwise there would be too few.
    TILE_SIDE = 8,
    TILES_WANTED = 16, // number of tiles below which smaller tiles are chosen
    TILES_MIN = 4,
};

static const struct interval unknown = {NAN, NAN, NAN};

// Half the width of a 95 % normal interval, in standard deviations.
static const double usual_deviations = 1.959963984540054;

// --- slope ---------------------------------------------------------------------------------------

// Returns the deviation, in standard deviations, that a normal variable exceeds in absolute value
// with probability 1 - confidence.
static double deviations_of(double confidence)
{
    return stats_t_quantile(0.5 + 0.5 * confidence, 1e9);
}

// Returns the standard deviation, over seeds, of the logarithm of the estimated error. If `spread`
// is not known, it is derived from the intervals of the estimates. These also include the
// uncertainty of the denominators, but that is the same in all estimates.
static double log_deviation(const struct forecast_look *look, double spread)
{
    if (spread > 0)
        return spread;
    return log(look->high / look->low) / (2 * deviations_of(look->confidence));
}

static bool is_usable(const struct forecast_look *look)
{
    return look->samples > 0 && look->error > 0 && look->low > 0 && look->high > look->low &&
           isfinite(look->high);
}

// A line a + b x, where x is in doublings of the samples, with the covariance matrix of a and b.
struct line {
    double a, b, aa, ab, bb;
};

// Fits a line to error estimates that share samples. With Gaussian noise, the squared difference
// after 2^k times the samples has the correlation 2^-k with the previous one, like a first-order
// autoregression. So the estimates are whitened one after the other, and the line is fitted by
// least squares (Aitken 1935). If the estimates deviate from the line by more than their intervals
// permit, the line's uncertainty is scaled accordingly.
static struct line fit(const struct forecast_look *looks, size_t count, double spread)
{
    double s00 = 0, s01 = 0, s11 = 0, t0 = 0, t1 = 0, tt = 0, before[3] = {0}, x_before = 0;
    for (size_t i = 0; i < count; i++) {
        double x = log2(looks[i].samples), deviation = log_deviation(&looks[i], spread);
        double row[3] = {1 / deviation, x / deviation, log(looks[i].error) / deviation};
        double correlation = i > 0 ? exp2(x_before - x) : 0, free[3];
        double scale = 1 / sqrt(1 - correlation * correlation);
        for (int k = 0; k < 3; k++) {
            free[k] = (row[k] - correlation * before[k]) * scale;
            before[k] = row[k];
        }
        x_before = x;
        s00 += free[0] * free[0];
        s01 += free[0] * free[1];
        s11 += free[1] * free[1];
        t0 += free[0] * free[2];
        t1 += free[1] * free[2];
        tt += free[2] * free[2];
    }
    double determinant = s00 * s11 - s01 * s01;
    struct line line = {
        .a = (s11 * t0 - s01 * t1) / determinant,
        .b = (s00 * t1 - s01 * t0) / determinant,
    };
    double excess = (tt - line.a * t0 - line.b * t1) / ((double)count - 2);
    double variance = fmax(excess, 1) / determinant;
    line.aa = s11 * variance;
    line.ab = -s01 * variance;
    line.bb = s00 * variance;
    return line;
}

// Returns how many of the last estimates are usable without an unusable one between them; at most
// FORECAST_LOOKS_MAX.
static size_t usable_looks(const struct forecast_params *params)
{
    size_t usable = 0;
    while (usable < params->count && usable < FORECAST_LOOKS_MAX &&
           is_usable(&params->looks[params->count - 1 - usable]))
        usable++;
    return usable;
}

// --- forecast ------------------------------------------------------------------------------------

static struct interval scaled(struct interval i, double factor)
{
    return (struct interval){i.value * factor, i.low * factor, i.high * factor};
}

// Extrapolates the image's own error by x doublings of the samples. The uncertainty of the slope
// widens the interval. The errors of the last estimate and of the slope are correlated: if C is the
// covariance matrix of the line, the value at x and the slope have the covariance C_ab + x C_bb.
static struct interval go_on(struct interval error, const struct line *line, double x,
                             double doublings)
{
    double together = fmax(line->ab + x * line->bb, 0);
    double variance = doublings * doublings * line->bb + 2 * doublings * together;
    double fall = usual_deviations * sqrt(variance);
    double value = error.value * exp(doublings * line->b);
    return (struct interval){value, value * exp(-hypot(log(error.value / error.low), fall)),
                             value * exp(hypot(log(error.high / error.value), fall))};
}

// Returns the sum of two numbers with independent errors.
static struct interval sum(struct interval a, struct interval b)
{
    double value = a.value + b.value;
    double low = value - hypot(a.value - a.low, b.value - b.low);
    return (struct interval){value, fmax(low, 0),
                             value + hypot(a.high - a.value, b.high - b.value)};
}

// Widens the forecast by the difference between the error estimated from the half-buffers after N
// samples and the error of the image after k N samples, k >= 2. Both deviate from their
// expectations. Let s be the square root of the sum of the pixels' squared errors, divided by the
// sum of their errors. For Gaussian noise each of the two has the variance 2/3 s^2. If only few
// samples are bright, the variances are at most s^2 and s^2 / k, because the later image has k
// times as many such samples. In both cases the sum is at most 3/2 s^2. If few pixels determine s,
// it is itself uncertain. Student's t allows for that, with as many degrees of freedom as a sum of
// equal errors with the same uncertainty would have (Satterthwaite 1946).
static struct interval widened(const struct forecast_params *params)
{
    struct interval error = params->error;
    double deviations =
        params->spread_terms > 0 ? stats_t_quantile(0.975, params->spread_terms) : usual_deviations;
    double factor = exp(deviations * sqrt(1.5) * params->spread);
    return (struct interval){error.value, fmin(error.low, error.value / factor),
                             fmax(error.high, error.value * factor)};
}

void forecast_find_error(const struct forecast_params *params, struct forecast *out)
{
    *out = (struct forecast){.error = unknown, .slope = {-1, -1, -1}};
    const struct interval error = widened(params);
    bool is_known = error.value > 0 && params->error.low >= 0 && isfinite(params->error.high);
    double times = params->times > 0 ? params->times : 2;
    size_t looks = usable_looks(params);
    if (is_known)
        out->error = scaled(error, 1 / times);
    if (params->independent) {
        out->basis = FORECAST_INVERSE;
    } else if (looks < FORECAST_LOOKS_MIN) {
        out->basis = FORECAST_AT_LEAST;
        out->error.low *= 1 / sqrt(times);
    } else {
        const struct forecast_look *last = &params->looks[params->count - 1];
        const struct line line = fit(last + 1 - looks, looks, params->spread);
        double half = usual_deviations * sqrt(line.bb);
        out->basis = FORECAST_SLOPE;
        out->slope = scaled((struct interval){line.b, line.b - half, line.b + half}, 1 / log(2));
        out->looks = looks;
        if (is_known) {
            double by_law = out->error.high;
            out->error = go_on(error, &line, log2(last->samples), log2(times));
            out->error.high = fmax(out->error.high, by_law);
        }
    }
    if (is_known && params->stays.value > 0)
        out->error = sum(out->error, params->stays);
}

// --- bias ----------------------------------------------------------------------------------------

struct tile_sum {
    double value, pixels;
};

static uint32_t choose_side(const struct forecast_bias_params *p)
{
    uint32_t side = TILE_SIDE;
    while (side > 1 && (uint64_t)p->width * p->height < (uint64_t)TILES_WANTED * side * side)
        side /= 2;
    return side;
}

static struct tile_sum sum_tile(const struct forecast_bias_params *p, uint64_t x0, uint64_t y0,
                                uint32_t side)
{
    struct tile_sum tile = {0};
    for (uint64_t y = y0; y < p->height && y < y0 + side; y++)
        for (uint64_t x = x0; x < p->width && x < x0 + side; x++) {
            uint64_t i = y * p->width + x;
            const float *a = p->half_a[i], *b = p->half_b[i], *r = p->reference[i];
            if (!pixel_is_finite(a) || !pixel_is_finite(b) || !pixel_is_finite(r))
                continue;
            tile.pixels++;
            for (int c = 0; c < 3; c++) {
                double product = ((double)a[c] - r[c]) * ((double)b[c] - r[c]);
                double mean = p->means[i][c];
                tile.value += product / (3 * (mean * mean + METRICS_RELMSE_EPSILON));
            }
        }
    return tile;
}

static bool allow_for_unseen(const struct forecast_bias_params *p, struct interval *stays)
{
    const float *halves[2] = {p->half_a[0], p->half_b[0]};
    const struct bias_params params = {
        .pictures = halves,
        .count = 2,
        .length = 3 * (size_t)p->width * p->height,
        .reference = p->reference[0],
        .reference_halves = {p->reference_halves[0] ? p->reference_halves[0][0] : NULL,
                             p->reference_halves[1] ? p->reference_halves[1][0] : NULL},
    };
    return bias_allow_for_unseen(&params, stays);
}

// The mean over pixels is a ratio of two sums over tiles; its variance follows from the deviations
// of the tiles from it (Cochran 1977, "Sampling Techniques", equation 6.11).
bool forecast_find_bias(const struct forecast_bias_params *p, struct forecast_bias *out)
{
    double value = 0, pixels = 0, values = 0, products = 0, squares = 0, count = 0;
    *out = (struct forecast_bias){.stays = unknown};
    uint32_t side = choose_side(p);
    for (uint64_t y = 0; y < p->height; y += side)
        for (uint64_t x = 0; x < p->width; x += side) {
            struct tile_sum tile = sum_tile(p, x, y, side);
            count += tile.pixels > 0;
            value += tile.value;
            pixels += tile.pixels;
            values += tile.value * tile.value;
            products += tile.value * tile.pixels;
            squares += tile.pixels * tile.pixels;
        }
    if (count < TILES_MIN)
        return true;
    double mean = value / pixels;
    double spread = fmax(values - 2 * mean * products + mean * mean * squares, 0);
    double deviation = sqrt(spread * count / (count - 1)) / pixels;
    double stays = mean - p->reference_error;
    double half = stats_t_quantile(0.975, count - 1) * deviation;
    out->stays = (struct interval){stays, stays - half, stays + half};
    if (!allow_for_unseen(p, &out->stays))
        return false;
    out->is_certain = out->stays.low > 0 && stays > stats_t_quantile(0.9995, count - 1) * deviation;
    return true;
}
