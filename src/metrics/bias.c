#include "metrics/bias.h"

#include "metrics/metrics.h"
#include <math.h>
#include <stdlib.h>

static const float *reference_half(const struct bias_params *p, int half)
{
    return p->reference_halves[half] ? p->reference_halves[half] : p->reference;
}

static double relative_weight(const struct bias_params *p, size_t i)
{
    double reference = (double)p->reference[i];
    return 1 / (reference * reference + METRICS_RELMSE_EPSILON);
}

// --- differences due to unseen samples -----------------------------------------------------------

// The factor by which a difference must exceed the brightest sample to count as bias. If no image
// contains samples of some kind, fewer than ln(1 / 0.025) = 3.7 of them were expected in all images
// together; otherwise at least one would have been seen with a probability of 97.5 %. So if an
// unbiased method lacks the sum S because of such samples, each of them is at least S / 3.7. With
// 16 images and S = 300 times the brightest sample seen, they would be 81 times as bright as that
// sample. For a distribution of brightness whose mean just fails to exist (Pareto's with exponent
// 1), the probability that none of n samples exceeds 1/81 of the typical maximum is exp(-81). The
// largest S of the unbiased methods that were tried was 230 times the brightest sample, when none
// of 16 images had found a sun of half a degree. If the same number of samples is divided among
// fewer images, their noise is larger by the square root of the ratio, so the factor is smaller by
// the same root. It is at least 200: then 1.5 % of single images of a small sun
// (tests/render/test_bias.c) are reported as biased; with 106 it would be 8 %.
static double unseen_factor(size_t pictures)
{
    return fmax(75 * sqrt((double)pictures), 200);
}

struct difference {
    double sum[3]; // sum of the differences of each channel, which detects a bias of constant sign
    double absolute; // sum of the differences with the sign of the pixel's bias, see add_picture()
    double largest; // largest contribution of a pixel of one image, or of one half of the reference
};

// For each pixel, the noise estimated from the images with even indices, from those with odd
// indices, and from the reference. It decides which pixels are omitted.
struct spreads {
    float *pixel[3];
    float limit[3]; // pixels with more noise than this are omitted
};
enum { SPREAD_EVEN, SPREAD_ODD, SPREAD_REFERENCE, SPREADS };

static double sum_pictures(const struct bias_params *p, size_t i)
{
    double sum = 0;
    for (size_t k = 0; k < p->count; k++)
        sum += (double)p->pictures[k][i];
    return sum;
}

static bool is_finite(const struct bias_params *p, size_t pixel)
{
    double sum = 0;
    for (size_t i = 3 * pixel; i < 3 * pixel + 3; i++)
        sum +=
            sum_pictures(p, i) + (double)reference_half(p, 0)[i] + (double)reference_half(p, 1)[i];
    return isfinite(sum);
}

static bool is_noisy(const struct spreads *spreads, size_t by, size_t pixel)
{
    return spreads && spreads->pixel[by][pixel] > spreads->limit[by];
}

static bool is_lit(const struct bias_params *p, size_t picture, size_t pixel)
{
    const float *rgb = p->pictures[picture] + 3 * pixel;
    return rgb[0] != 0 || rgb[1] != 0 || rgb[2] != 0;
}

// The values of a pixel in all images and in both halves of the reference.
struct pixel {
    double sum[3], scale[3], half[2][3];
    size_t lit; // number of images in which the pixel is not black
};

static struct pixel read_pixel(const struct bias_params *p, size_t index)
{
    struct pixel pixel = {0};
    for (size_t c = 0; c < 3; c++) {
        pixel.sum[c] = sum_pictures(p, 3 * index + c);
        pixel.scale[c] = sqrt(relative_weight(p, 3 * index + c));
        for (int h = 0; h < 2; h++)
            pixel.half[h][c] = (double)reference_half(p, h)[3 * index + c];
    }
    for (size_t k = 0; k < p->count; k++)
        pixel.lit += is_lit(p, k, index);
    return pixel;
}

// Adds a pixel of one image. The absolute value of a difference would not have mean zero for pure
// noise. So each image's difference from one half of the reference gets the sign of the difference
// between the mean of all other images and the other half, both of which are independent of it. If
// all other images are black at this pixel, the brightness of a sample is not known, and the pixel
// is not added.
static void add_picture(const struct pixel *pixel, const float rgb[3], double count,
                        bool others_lit, struct difference *d)
{
    double part = 0;
    for (size_t c = 0; c < 3; c++) {
        double value = (double)rgb[c], others = (pixel->sum[c] - value) / (count - 1);
        part += pixel->scale[c] * fabs(value - others) / count;
        for (int h = 0; h < 2 && others_lit; h++) {
            double sign =
                (double)(others > pixel->half[h][c]) - (double)(others < pixel->half[h][c]);
            double difference = pixel->scale[c] * (value - pixel->half[1 - h][c]) / (2 * count);
            d->sum[c] += difference;
            d->absolute += sign * difference;
        }
    }
    d->largest = fmax(d->largest, part);
}

static void add_pixel(const struct bias_params *p, const struct spreads *spreads, size_t index,
                      struct difference *d)
{
    const struct pixel pixel = read_pixel(p, index);
    double part = 0;
    for (size_t c = 0; c < 3; c++)
        part += pixel.scale[c] * fabs(pixel.half[0][c] - pixel.half[1][c]) / 2;
    if (!is_noisy(spreads, SPREAD_EVEN, index) || !is_noisy(spreads, SPREAD_ODD, index))
        d->largest = fmax(d->largest, part);
    for (size_t k = 0; k < p->count && !is_noisy(spreads, SPREAD_REFERENCE, index); k++)
        if (!is_noisy(spreads, (k + 1) % 2, index))
            add_picture(&pixel, p->pictures[k] + 3 * index, (double)p->count,
                        pixel.lit > is_lit(p, k, index), d);
}

static bool outweighs_unseen(const struct bias_params *p, const struct spreads *spreads)
{
    struct difference d = {0};
    for (size_t pixel = 0; pixel < p->length / 3; pixel++)
        if (is_finite(p, pixel))
            add_pixel(p, spreads, pixel, &d);
    return fmax(d.absolute, fabs(d.sum[0]) + fabs(d.sum[1]) + fabs(d.sum[2])) >
           unseen_factor(p->count) * d.largest;
}

static void widen(double range[2], double value)
{
    range[0] = fmin(range[0], value);
    range[1] = fmax(range[1], value);
}

static float pixel_spread(const struct bias_params *p, size_t by, size_t pixel)
{
    double spread = 0;
    for (size_t i = 3 * pixel; i < 3 * pixel + 3; i++) {
        double range[2] = {INFINITY, -INFINITY};
        for (size_t k = by; k < p->count && by != SPREAD_REFERENCE; k += 2)
            widen(range, (double)p->pictures[k][i]);
        for (int h = 0; h < 2 && by == SPREAD_REFERENCE; h++)
            widen(range, (double)reference_half(p, h)[i]);
        if (p->count < 4) // a side would have a single image
            widen(range, (double)p->reference[i]);
        spread = fmax(spread, sqrt(relative_weight(p, i)) * (range[1] - range[0]));
    }
    return (float)spread;
}

static int compare_floats(const void *a, const void *b)
{
    const float *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

// Repeats the test without the noisiest pixels. A few pixels, at the edges of lamps, may be so much
// noisier than the others that no difference outweighs them. The noisiest tenth according to one
// half of the images is omitted from the other half, and the noisiest tenth of the reference from
// both, so that the choice is independent of rare samples in the data that is tested. Returns false
// only when out of memory.
static bool quiet_pixels_outweigh(const struct bias_params *p, bool *out)
{
    size_t pixels = p->length / 3;
    struct spreads spreads = {0};
    float *sorted = malloc(((SPREADS + 1) * pixels + 1) * sizeof *sorted);
    if (!sorted)
        return false;
    for (size_t by = 0; by < SPREADS; by++) {
        spreads.pixel[by] = sorted + (by + 1) * pixels;
        for (size_t i = 0; i < pixels; i++)
            sorted[i] = spreads.pixel[by][i] = pixel_spread(p, by, i);
        qsort(sorted, pixels, sizeof *sorted, compare_floats);
        spreads.limit[by] = pixels > 0 ? sorted[(9 * pixels - 1) / 10] : 0;
    }
    *out = outweighs_unseen(p, &spreads);
    free(sorted);
    return true;
}

bool bias_allow_for_unseen(const struct bias_params *p, struct interval *bias)
{
    bool outweighs = !(bias->low > 0) || outweighs_unseen(p, NULL);
    if (!outweighs && !quiet_pixels_outweigh(p, &outweighs))
        return false;
    if (!outweighs)
        bias->low = 0;
    return true;
}

// --- bias ----------------------------------------------------------------------------------------

// Returns an unbiased estimate of the squared bias without subtracting the variance of the
// reference: for n differences from a reference with mean m and unbiased variance s^2, the
// expectation of m^2 is the squared bias plus s^2 / n plus the variance of the reference.
static double squared_bias(double sum, double squares, double n)
{
    double mean = sum / n, variance = (squares - sum * mean) / (n - 1);
    return mean * mean - variance / n;
}

// Adds the squared bias of one value: estimated from all images to *all, and from all but the k-th
// image to without[k].
static void add_squared_bias(const struct bias_params *p, size_t i, double *all, double *without)
{
    double sum = 0, squares = 0, n = (double)p->count, weight = relative_weight(p, i);
    for (size_t k = 0; k < p->count; k++) {
        double v = (double)p->pictures[k][i] - (double)p->reference[i];
        sum += v;
        squares += v * v;
    }
    *all += weight * squared_bias(sum, squares, n);
    for (size_t k = 0; k < p->count; k++) {
        double v = (double)p->pictures[k][i] - (double)p->reference[i];
        without[k] += weight * squared_bias(sum - v, squares - v * v, n - 1);
    }
}

// Subtracts the noise of the reference. If e is its error and s^2 = (A - B)^2 / 4 the estimate of
// e^2 from its halves, e^2 - s^2 has the variance 4 E(s^2)^2 for Gaussian noise, for which E s^4 is
// 3 E(s^2)^2; with heavier tails the variance is less than 4/3 E s^4. Channels are summed first,
// because they are not independent.
static struct interval subtract_reference(const struct bias_params *p, struct interval bias)
{
    double noise = 0, squares = 0, pixel = 0, length = (double)p->length;
    if (!p->reference_halves[0])
        return bias;
    for (size_t i = 0; i < p->length; i++) {
        double s = ((double)p->reference_halves[0][i] - (double)p->reference_halves[1][i]) / 2;
        pixel += relative_weight(p, i) * s * s;
        if (i % 3 < 2)
            continue;
        noise += pixel;
        squares += pixel * pixel;
        pixel = 0;
    }
    double deviation = sqrt(squares * 4 / 3) / length;
    double half =
        hypot(bias.high - bias.value, stats_t_quantile(0.975, (double)p->count - 1) * deviation);
    double value = bias.value - noise / length;
    return (struct interval){value, value - half, value + half};
}

bool bias_find(const struct bias_params *p, struct interval *out)
{
    double *values = calloc(p->count, sizeof *values), all = 0, n = (double)p->count;
    if (!values)
        return false;
    for (size_t i = 0; i < p->length; i++)
        add_squared_bias(p, i, &all, values);
    // The jackknife's pseudo-values (Tukey 1958); the result is their mean and its t interval.
    for (size_t k = 0; k < p->count; k++)
        values[k] = (n * all - (n - 1) * values[k]) / (double)p->length;
    *out = subtract_reference(p, curve_mean(values, p->count));
    free(values);
    return bias_allow_for_unseen(p, out);
}
