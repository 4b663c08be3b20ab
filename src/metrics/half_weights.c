// The denominator of relMSE, 1 / (r^2 + epsilon), r being the true value of a pixel, for which the
// pixel's own noisy mean will not do: where the noise is skewed, as light transport's is, a pixel
// that caught a bright sample has a large variance estimate and a large mean at once, and the
// quotient comes out at a fraction of the truth.
//
// Even surroundings. r is estimated by S, the mean over the square of 2 radius + 1 pixels a side,
// the pixel itself left out, so that numerator and denominator are independent. S is noisy as well,
// and 1 / (S^2 + epsilon) is convex: with V the variance of S, estimated from the same neighbours'
// D^2, its expectation is to second order (1 + (3 S^2 - epsilon) V / (S^2 + epsilon)^2) /
// (r^2 + epsilon), by which it is divided (where the bracket exceeds 1).
//
// Structure. Beside an edge the square's mean is nobody's value: a pixel with a corner of a lamp in
// it has much of a picture's error, and neither the lamp's pixels nor the wall's are like it. That
// there is structure shows in the neighbours: their means spread by more than their halves differ,
// by three deviations of that difference; or in the pixel, which is farther from them than its
// halves are from each other, by as much. There it may be like any of several windows: the square,
// pieces of lines in four directions, a side or a corner of its eight neighbours. The weight is the
// mean over these hypotheses of what each would say, each by its likelihood given A and B: with m
// and s^2 a window's mean and the variance of one of its pixels, Student's t density of scale s,
// with 5 degrees of freedom, for noise has long tails. A bright sample on an even wall (|A - B|
// large) and a pixel that is bright (A and B far from m both) are told apart by it. Within a window
// that has structure itself, r is drawn from its mean towards M, as the empirical Bayes estimate of
// normal values would be (Efron and Morris 1973). Where M is farther from all windows than the
// halves from each other, the pixel may also be unlike all of them, and have its own mean.
//
// The variance over the hypotheses says how much of the error's uncertainty is the weights'.
#include "half_weights.h"

#include <math.h>

enum { DIRECTIONS = 4, LINE_SHORT = 2, LINE_LONG = HALF_REACH, SIDES = 8 };

static const double structure_least = 0.05; // relative variance that the correction takes well
static const double deviations = 3;         // of what counts as more than noise
// A window cannot know its mean better than to this part of it: edges are never quite straight.
static const double window_variance_least = 1e-4;
// One draw of D^2 tells little of the noise: it is below a third of its mean in 44 % of all draws.
static const double own_noise_factor = 3;
// Hypotheses of less than this part of the best one's likelihood are left out.
static const double part_least = 1e-2;

static const int line_steps[DIRECTIONS][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
static const int half_sides[SIDES][2] = {{1, 0}, {-1, 0}, {0, 1},  {0, -1},
                                         {1, 1}, {1, -1}, {-1, 1}, {-1, -1}};

// That the pixel is one like those of a window.
struct hypothesis {
    double likelihood;
    struct half_sums window; // without pixels: that it is like none
};

struct hypotheses {
    const struct half_sums *own;
    struct hypothesis list[1 + 2 * DIRECTIONS + SIDES + 1];
    int count;
    double nearest; // squared distance of M to a window's mean, the least
};

void half_sums_add(struct half_sums *sums, const struct half_error_params *params, uint64_t i)
{
    const float *a = params->half_a[i], *b = params->half_b[i];
    for (int c = 0; c < 3; c++)
        if (!isfinite(a[c]) || !isfinite(b[c]))
            return;
    double d[3];
    for (int c = 0; c < 3; c++) {
        double m = ((double)a[c] + b[c]) / 2;
        d[c] = ((double)a[c] - b[c]) / 2;
        sums->mean[c] += m;
        sums->squares[c] += m * m;
        sums->products[c] += d[c] * d[c];
    }
    sums->products[3] += d[0] * d[1];
    sums->products[4] += d[0] * d[2];
    sums->products[5] += d[1] * d[2];
    sums->pixels++;
}

void half_sums_join(struct half_sums *sums, const struct half_sums *other)
{
    for (int c = 0; c < 3; c++) {
        sums->mean[c] += other->mean[c];
        sums->squares[c] += other->squares[c];
    }
    for (int i = 0; i < 6; i++)
        sums->products[i] += other->products[i];
    sums->pixels += other->pixels;
}

static void add_offset(struct half_sums *sums, const struct half_view *view, int dx, int dy)
{
    const struct half_sums *row = view->rows[HALF_REACH + dy];
    uint32_t x = view->x + (uint32_t)dx; // left of the picture it wraps to beyond the width
    if (row && x < view->width)
        half_sums_join(sums, &row[x]);
}

// 1 / (r^2 + epsilon) from the mean over pixels and its variance.
static double inverse_square(double mean, double mean_variance)
{
    double square = mean * mean + METRICS_RELMSE_EPSILON;
    double curvature = fmax(3 * mean * mean - METRICS_RELMSE_EPSILON, 0);
    return 1 / (square + curvature * mean_variance / square);
}

// Mean products of D over the pixels of a window and the pixel itself. It is to be multiplied by
// the pixel's own product, and a normal variable's fourth moment is three times its squared
// variance.
static void find_noise(const struct half_sums *own, const struct half_sums *window, double *noise)
{
    for (int i = 0; i < 6; i++)
        noise[i] = (window->products[i] + own->products[i] / 3) / (window->pixels + 1);
}

// Of one pixel's value, by how the means spread.
static double spread_of(const struct half_sums *sums, int c)
{
    double mean = sums->mean[c] / sums->pixels;
    return (sums->squares[c] - sums->pixels * mean * mean) / (sums->pixels - 1);
}

// Whether the pixels around differ by more than noise, or the pixel from them; the noise of the
// difference between spread and noise is that of a product of independent halves.
static bool has_structure(const struct half_sums *own, const struct half_sums *around)
{
    double structure = 0, noise = 0, distance = 0, own_noise = 0;
    if (around->pixels < 2)
        return false;
    for (int c = 0; c < 3; c++) {
        double mean = around->mean[c] / around->pixels;
        double variance = around->products[c] / around->pixels;
        double square = mean * mean + METRICS_RELMSE_EPSILON;
        double away = own->mean[c] - mean;
        structure += (spread_of(around, c) - variance) / square / 3;
        noise += 2 * variance / sqrt(around->pixels) / square / 3;
        distance += away * away / square;
        own_noise += fmax(own->products[c], variance) / square;
    }
    return structure > structure_least + deviations * noise ||
           distance > deviations * deviations * own_noise;
}

// That the pixel is one like those of the window. Channels and halves share most of their noise:
// they count as one observation.
static void consider(struct hypotheses *all, const struct half_sums *window)
{
    if (window->pixels < 2)
        return;
    const struct half_sums *own = all->own;
    double part = 1 / window->pixels, parts = 1 / (window->pixels - 1);
    double distance = 0, away = 0, scales = 1;
    for (int c = 0; c < 3; c++) {
        double mean = window->mean[c] * part, noise = window->products[c] * part;
        double spread = (window->squares[c] - window->mean[c] * mean) * parts;
        double square = mean * mean + METRICS_RELMSE_EPSILON;
        double variance = 2 * fmax(spread, noise) * (1 + part) + window_variance_least * square;
        double off = own->mean[c] - mean;
        away += off * off;
        distance += (off * off + own->products[c]) / variance / 3;
        scales *= variance;
    }
    all->nearest = fmin(all->nearest, away);
    double density = 1 + distance / 5; // to the power of -(5 + 1) / 2
    all->list[all->count++] = (struct hypothesis){
        .likelihood = 1 / (cbrt(sqrt(scales)) * density * density * density),
        .window = *window,
    };
}

// That it is unlike all of them. Of its value nothing is known beforehand but that it is about as
// far from the nearest window as it is.
static void consider_itself(struct hypotheses *all)
{
    const struct half_sums *own = all->own;
    double noise = own->products[0] + own->products[1] + own->products[2];
    if (!(all->nearest > deviations * deviations * noise))
        return;
    double least = window_variance_least * METRICS_RELMSE_EPSILON;
    all->list[all->count++] = (struct hypothesis){
        .likelihood = 1 / sqrt(all->nearest / 3 + least),
    };
}

// 1 / (r^2 + epsilon). Where the window has structure, the pixel's distance to its mean is not all
// noise: r is taken to be nearer to M by that part.
static double weight_by(const struct half_sums *window, const struct half_sums *own, int c)
{
    if (window->pixels < 2)
        return inverse_square(own->mean[c], 0);
    double mean = window->mean[c] / window->pixels, noise = window->products[c] / window->pixels;
    double structure = fmax(spread_of(window, c) - noise, 0);
    double part = structure > 0
                      ? structure / (structure + own_noise_factor * fmax(noise, own->products[c]))
                      : 0;
    return inverse_square(mean + part * (own->mean[c] - mean),
                          noise * (part + (1 - part) * (1 - part) / window->pixels));
}

// The mean over the hypotheses, and the variance of what they say the pixel adds, to which as much
// again is added as it is: the windows are a choice, and others would be as good.
static void judge(const struct hypotheses *all, struct half_weight *out)
{
    double greatest = 0, likelihood = 0, error = 0, error_squared = 0;
    double weight[3] = {0}, noise[6] = {0};
    for (int i = 0; i < all->count; i++)
        greatest = fmax(greatest, all->list[i].likelihood);
    if (!(greatest > 0)) // beyond what numbers hold
        return;
    for (int i = 0; i < all->count; i++) {
        const struct half_sums *window = &all->list[i].window;
        double part = all->list[i].likelihood / greatest, said = 0, noise_said[6];
        if (part < part_least)
            continue;
        for (int c = 0; c < 3; c++) {
            double one = weight_by(window, all->own, c) / 3;
            weight[c] += part * one;
            said += one * all->own->products[c];
        }
        find_noise(all->own, window, noise_said);
        for (int j = 0; j < 6; j++)
            noise[j] += part * noise_said[j];
        likelihood += part;
        error += part * said;
        error_squared += part * said * said;
    }
    for (int c = 0; c < 3; c++)
        out->weight[c] = weight[c] / likelihood;
    for (int j = 0; j < 6; j++)
        out->noise[j] = noise[j] / likelihood;
    error /= likelihood;
    out->doubt = fmax(error_squared / likelihood - error * error, 0) + error * error;
}

static void consider_lines(struct hypotheses *all, const struct half_view *view)
{
    for (int i = 0; i < DIRECTIONS; i++) {
        int dx = line_steps[i][0], dy = line_steps[i][1];
        struct half_sums sums = {0};
        for (int step = 1; step <= LINE_LONG; step++) {
            add_offset(&sums, view, step * dx, step * dy);
            add_offset(&sums, view, -step * dx, -step * dy);
            if (step == LINE_SHORT || step == LINE_LONG)
                consider(all, &sums);
        }
    }
}

static void consider_sides(struct hypotheses *all, const struct half_view *view)
{
    for (int i = 0; i < SIDES; i++) {
        struct half_sums sums = {0};
        for (int y = -1; y <= 1; y++)
            for (int x = -1; x <= 1; x++)
                if (x * half_sides[i][0] + y * half_sides[i][1] > 0)
                    add_offset(&sums, view, x, y);
        consider(all, &sums);
    }
}

void half_weigh(const struct half_view *view, const struct half_sums *around,
                struct half_weight *out)
{
    const struct half_sums *own = &view->rows[HALF_REACH][view->x];
    double n = around->pixels;
    for (int c = 0; c < 3; c++)
        out->weight[c] = inverse_square(around->mean[c] / n, around->products[c] / n / n) / 3;
    find_noise(own, around, out->noise);
    out->doubt = 0;
    out->structured = has_structure(own, around);
    if (!out->structured)
        return;
    struct hypotheses all;
    all.own = own;
    all.count = 0;
    all.nearest = INFINITY;
    consider(&all, around);
    consider_lines(&all, view);
    consider_sides(&all, view);
    consider_itself(&all);
    judge(&all, out);
}
