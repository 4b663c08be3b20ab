// Tests estimates of bias with noise of known bias: intervals must contain the bias in 95 % of
// draws, and unbiased methods may be reported as biased in at most 2.5 %, even if few samples carry
// all the light.
#include "metrics/bias.h"
#include "metrics/metrics.h"
#include "random.h"
#include "test.h"

enum { DRAWS = 1000, PICTURES = 16, LENGTH = 3 * 256, LEAST = 927, MOST = 973, WRONG = 40 };

static bool covers(struct interval i, double truth)
{
    return i.low <= truth && truth <= i.high && i.low <= i.value && i.value <= i.high;
}

static float pictures[PICTURES][LENGTH], halves[2][LENGTH], reference[LENGTH];

static struct interval find(size_t count, bool with_halves)
{
    const float *rows[PICTURES];
    struct interval found = {NAN, NAN, NAN};
    for (size_t r = 0; r < count; r++)
        rows[r] = pictures[r];
    for (int i = 0; i < LENGTH; i++)
        reference[i] = (float)(0.5 * ((double)halves[0][i] + (double)halves[1][i]));
    const struct bias_params params = {
        .pictures = rows,
        .count = count,
        .length = LENGTH,
        .reference = reference,
        .reference_halves = {with_halves ? halves[0] : NULL, with_halves ? halves[1] : NULL},
    };
    bool ok = bias_find(&params, &found);
    CHECK(ok);
    return found;
}

// --- Gaussian noise ------------------------------------------------------------------------------

#define TRUTH 3.0
// The noise of the reference changes this very little.
#define SCALE (TRUTH * TRUTH + METRICS_RELMSE_EPSILON)

// Draws images of a constant with noise, and a reference with noise of its own.
static void draw(double bias, double noise, double reference_noise)
{
    for (int i = 0; i < LENGTH; i++) {
        for (int h = 0; h < 2; h++)
            halves[h][i] = (float)(TRUTH + sqrt(2) * reference_noise * normal());
        for (int r = 0; r < PICTURES; r++)
            pictures[r][i] = (float)(TRUTH + bias + noise * normal());
    }
}

struct tally {
    int covered, biased;
    double mean;
};

static struct tally count(size_t pictures_used, double bias, double reference_noise)
{
    struct tally tally = {0};
    for (int d = 0; d < DRAWS; d++) {
        draw(bias, 0.3, reference_noise);
        struct interval found = find(pictures_used, true);
        tally.covered += covers(found, bias * bias / SCALE);
        tally.biased += found.low > 0;
        tally.mean += found.value / DRAWS;
    }
    printf("  bias %g, reference's noise %g: covered %d of %d, biased %d, mean %.3g\n", bias,
           reference_noise, tally.covered, DRAWS, tally.biased, tally.mean);
    return tally;
}

TEST(intervals_cover)
{
    struct tally none = count(PICTURES, 0, 0.02), some = count(PICTURES, 0.1, 0.02);
    CHECK(none.covered >= LEAST && none.biased <= WRONG, "%d %d", none.covered, none.biased);
    CHECK(some.covered >= LEAST && some.covered <= MOST, "%d", some.covered);
    CHECK(some.biased == DRAWS, "%d", some.biased);
    CHECK(fabs(none.mean) < 2e-5 && fabs(some.mean - 0.01 / SCALE) < 2e-5, "%g %g", none.mean,
          some.mean);
}

// The mean of the images has a standard deviation of 0.3 / 4. All images share the noise of the
// reference, so their differences do not show its error.
TEST(a_reference_as_noisy_as_the_pictures)
{
    struct tally same = count(PICTURES, 0, 0.075), noisier = count(PICTURES, 0, 0.3);
    CHECK(same.covered >= LEAST && noisier.covered >= LEAST, "%d %d", same.covered,
          noisier.covered);
    CHECK(same.biased <= WRONG && noisier.biased <= WRONG, "%d %d", same.biased, noisier.biased);
}

// --- rare bright samples -------------------------------------------------------------------------

// Draws values of 1: constant light, except for a part that comes from few samples, `expected` of
// them in all pixels of 16 images. Their brightness is distributed evenly over the orders of
// magnitude up to the brightest, like that of lobes, so that each order has ten times the light of
// the previous one.
static void draw_rare(double expected, double part)
{
    const double orders = log(1e4), brightest = part * LENGTH / 3 * PICTURES * orders / expected;
    for (int i = 0; i < LENGTH; i++) {
        halves[0][i] = halves[1][i] = 1;
        for (int r = 0; r < PICTURES; r++)
            pictures[r][i] = (float)(1 - part * (1 - 1e-4) + (i % 3 ? 0 : 0.001 * normal()));
    }
    // A Poisson process: the gaps are exponential.
    for (double at = -log(uniform()) / expected; at < 1; at -= log(uniform()) / expected) {
        int r = (int)(uniform() * PICTURES), pixel = (int)(uniform() * LENGTH / 3);
        float sample = (float)(brightest * exp(-orders * uniform()));
        for (int c = 0; c < 3; c++)
            pictures[r][3 * pixel + c] += sample;
    }
}

// Draws sums of a Pareto distribution with mean 1 and infinite variance.
static void draw_pareto(double exponent)
{
    for (int i = 0; i < LENGTH; i += 3) {
        for (int c = 0; c < 3; c++)
            halves[0][i + c] = halves[1][i + c] = 1;
        for (int r = 0; r < PICTURES; r++) {
            double value = (exponent - 1) / exponent * pow(uniform(), -1 / exponent);
            for (int c = 0; c < 3; c++)
                pictures[r][i + c] = (float)value;
        }
    }
}

// If unbiased methods are reported as biased with a probability of 2.5 % each, more than WRONG of
// 1,000 are reported in 0.3 % of cases.
static void check_honest(const char *what, size_t used, int biased)
{
    printf("  %s, %zu pictures: %d of %d called biased\n", what, used, biased, DRAWS);
    CHECK(biased <= WRONG, "%s, %zu pictures: %d", what, used, biased);
}

TEST(rare_samples_are_no_bias)
{
    static const double expected[] = {30, 100, 1000};
    static const size_t used[] = {4, 8, PICTURES};
    for (size_t e = 0; e < sizeof expected / sizeof *expected; e++) {
        int biased[3] = {0};
        char what[64];
        for (int d = 0; d < DRAWS; d++) {
            draw_rare(expected[e], 0.3);
            for (int u = 0; u < 3; u++)
                biased[u] += find(used[u], false).low > 0;
        }
        snprintf(what, sizeof what, "%g rare samples", expected[e]);
        for (int u = 0; u < 3; u++)
            check_honest(what, used[u], biased[u]);
    }
}

TEST(sums_without_variance_are_no_bias)
{
    static const double exponents[] = {1.05, 1.2, 1.5};
    for (size_t e = 0; e < sizeof exponents / sizeof *exponents; e++) {
        int biased = 0;
        char what[64];
        for (int d = 0; d < DRAWS; d++) {
            draw_pareto(exponents[e]);
            biased += find(PICTURES, false).low > 0;
        }
        snprintf(what, sizeof what, "exponent %g", exponents[e]);
        check_honest(what, PICTURES, biased);
    }
}

// --- what is found -------------------------------------------------------------------------------

// The bias is twice the noise of a pixel's mean in few pixels, or a fifth of it in all, too bright
// or too dark, in one channel only.
TEST(biases_are_found)
{
    int even = 0, mixed = 0, colored = 0;
    for (int d = 0; d < 100; d++) {
        draw(-0.06, 0.06, 0.002);
        even += find(8, true).low > 0;
        draw(0, 0.06, 0.002);
        for (int i = 0; i < LENGTH; i++)
            for (int r = 0; r < PICTURES; r++)
                pictures[r][i] += i / 3 % 2 ? 0.06f : -0.06f;
        mixed += find(8, true).low > 0;
        draw(0, 0.06, 0.002);
        for (int i = 0; i < LENGTH; i += 3)
            for (int r = 0; r < PICTURES; r++)
                pictures[r][i] += 0.15f;
        colored += find(8, true).low > 0;
    }
    CHECK(even == 100 && mixed == 100 && colored == 100, "%d %d %d", even, mixed, colored);
}

// No sample of any image has found light. It may come from few samples of any brightness.
TEST(black_pictures_tell_nothing)
{
    draw(0, 0, 0.02);
    memset(pictures, 0, sizeof pictures);
    struct interval black = find(PICTURES, true);
    CHECK(fabs(black.value - 9 / SCALE) < 0.01 && black.low == 0, "%g %g", black.value, black.low);
    pictures[5][0] = pictures[5][1] = pictures[5][2] = 0.1f; // a first sample with light
    CHECK(find(PICTURES, true).low == 0);
}

TEST(what_is_not_finite_tells_nothing)
{
    draw(0.1, 0.3, 0.02);
    CHECK(find(PICTURES, true).low > 0);
    pictures[3][5] = NAN;
    struct interval found = find(PICTURES, true);
    CHECK(isnan(found.value) && !(found.low > 0), "%g", found.low);
}

TEST_MAIN(TEST_CASE(intervals_cover), TEST_CASE(a_reference_as_noisy_as_the_pictures),
          TEST_CASE(rare_samples_are_no_bias), TEST_CASE(sums_without_variance_are_no_bias),
          TEST_CASE(biases_are_found), TEST_CASE(black_pictures_tell_nothing),
          TEST_CASE(what_is_not_finite_tells_nothing))
