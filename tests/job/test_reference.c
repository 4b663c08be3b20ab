// Tests the error after subtracting the reference's own noise, with noise of known error: the means
// of 1,000 draws must be within 3.3 of their standard errors (99.9 %).
#include "job/reference.h"

#include "metrics/metrics.h"
#include "test.h"

enum { DRAWS = 1000, WIDTH = 12, HEIGHT = 8, COUNT = WIDTH * HEIGHT };

static uint64_t state = 2;

static double uniform(void)
{
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return ((double)(state >> 11) + 0.5) * 0x1p-53;
}

// Returns a normal variable (Box and Muller 1958).
static double normal(void)
{
    return sqrt(-2 * log(uniform())) * cos(2 * acos(-1.0) * uniform());
}

// The true value, and the standard deviation of one half of the reference. The image differs from
// the truth by IMAGE_ERROR.
#define IMAGE_ERROR 0.02

static double truth_at(int i)
{
    return 0.5 + 0.05 * (i % WIDTH);
}

static double half_deviation(int i, bool is_small)
{
    return (is_small ? 0.001 : 0.03) * (1 + i / WIDTH);
}

static float image[COUNT][3], half_a[COUNT][3], half_b[COUNT][3], mean[COUNT][3],
    variance[COUNT][3], around[COUNT][3];

static void draw(bool is_small)
{
    for (int i = 0; i < COUNT; i++)
        for (int c = 0; c < 3; c++) {
            double sigma = half_deviation(i, is_small), t = truth_at(i);
            half_a[i][c] = (float)(t + sigma * normal());
            half_b[i][c] = (float)(t + sigma * normal());
            mean[i][c] = 0.5f * (half_a[i][c] + half_b[i][c]);
            image[i][c] = (float)(t + IMAGE_ERROR * normal());
            variance[i][c] = (float)(sigma * sigma / 2);
        }
}

struct tally {
    double values[DRAWS];
};

static void check_mean(const char *what, const struct tally *tally, double truth, bool is_truth)
{
    double average, spread;
    stats_mean_variance(tally->values, DRAWS, &average, &spread);
    double error = sqrt(spread / DRAWS);
    printf("  %s: %.6g +- %.2g, truth %.6g\n", what, average, error, truth);
    CHECK((fabs(average - truth) < 3.3 * error) == is_truth, "%s: %g +- %g, truth %g", what,
          average, error, truth);
}

// The forms in which the reference's noise can be given.
enum source { HALVES, VARIANCES, EVEN };

static void subtract(enum source source, bool is_small, struct tally out[3])
{
    static const char path[] = "variances";
    for (int d = 0; d < DRAWS; d++) {
        draw(is_small);
        struct reference reference = {.image = {WIDTH, HEIGHT, mean},
                                      .means = (const float(*)[3])around};
        struct metrics m;
        struct err err = {0};
        bool ok = metrics_local_means((const float(*)[3])mean, WIDTH, HEIGHT, NULL, around);
        double even = 0;
        for (int i = 0; i < COUNT; i++)
            even += (double)variance[i][0] / COUNT;
        if (source == HALVES)
            reference_set_noise(&reference, (const float(*)[3])half_a, (const float(*)[3])half_b);
        else if (source == VARIANCES)
            ok &= reference_set_variance(&reference, path, (const float(*)[3])variance, &err);
        else
            reference_set_even_variance(&reference, even);
        REQUIRE(ok && reference.noise_known, "%s", err.msg);
        metrics_compare((const float(*)[3])image, (const float(*)[3])mean, COUNT, NULL, &m);
        out[0].values[d] = m.mse - reference.mse;
        out[1].values[d] = m.relmse - reference.relmse;
        out[2].values[d] = metrics_local_relmse((const float(*)[3])image, (const float(*)[3])mean,
                                                reference.means, COUNT) -
                           reference.local_relmse;
    }
}

TEST(mse_is_unbiased_however_noisy_the_reference)
{
    static struct tally tallies[3];
    for (int source = HALVES; source <= EVEN; source++) {
        subtract((enum source)source, false, tallies);
        check_mean("mse", &tallies[0], IMAGE_ERROR * IMAGE_ERROR, true);
    }
}

// The denominator is the reference, so the result is as accurate as the reference is.
TEST(relmse_is_unbiased_where_the_reference_is_good)
{
    static struct tally tallies[3];
    double truth = 0;
    for (int i = 0; i < COUNT; i++)
        truth += IMAGE_ERROR * IMAGE_ERROR / (truth_at(i) * truth_at(i) + METRICS_RELMSE_EPSILON) /
                 COUNT;
    subtract(HALVES, true, tallies);
    check_mean("relmse by halves", &tallies[1], truth, true);
    subtract(VARIANCES, true, tallies);
    check_mean("relmse by variances", &tallies[1], truth, true);
}

// The denominator is a mean over many pixels, so a noisy reference suffices.
TEST(local_relmse_is_unbiased)
{
    static struct tally tallies[3];
    static float truths[COUNT][3], means[COUNT][3];
    double truth = 0;
    for (int i = 0; i < COUNT; i++)
        for (int c = 0; c < 3; c++)
            truths[i][c] = (float)truth_at(i);
    CHECK(metrics_local_means((const float(*)[3])truths, WIDTH, HEIGHT, NULL, means));
    for (int i = 0; i < COUNT; i++) {
        double l = (double)means[i][0];
        truth += IMAGE_ERROR * IMAGE_ERROR / (l * l + METRICS_RELMSE_EPSILON) / COUNT;
    }
    for (int source = HALVES; source <= EVEN; source++) {
        subtract((enum source)source, true, tallies);
        check_mean("local relmse", &tallies[2], truth, true);
    }
}

TEST(without_it_there_is_a_bias)
{
    static struct tally tally;
    for (int d = 0; d < DRAWS; d++) {
        draw(true);
        struct metrics m;
        metrics_compare((const float(*)[3])image, (const float(*)[3])mean, COUNT, NULL, &m);
        tally.values[d] = m.mse;
    }
    check_mean("mse as measured", &tally, IMAGE_ERROR * IMAGE_ERROR, false);
}

TEST(bad_variances_are_named)
{
    float values[2][3] = {{1, 1, 1}, {1, 1, 1}}, bad[2][3] = {{0, 0, 0}, {0, -1, 0}};
    struct reference reference = {.image = {1, 2, values}, .means = (const float(*)[3])values};
    struct err err = {0};
    CHECK(!reference_set_variance(&reference, "v.exr", (const float(*)[3])bad, &err));
    CHECK(strstr(err.msg, "v.exr: pixel 0,1: the variance is -1"), "%s", err.msg);
    bad[1][1] = INFINITY;
    CHECK(!reference_set_variance(&reference, "v.exr", (const float(*)[3])bad, &err));
    values[1][0] = NAN; // this pixel is omitted, and so is its variance
    CHECK(reference_set_variance(&reference, "v.exr", (const float(*)[3])bad, &err));
    CHECK(reference.noise_known && reference.mse == 0);
    values[0][0] = NAN;
    reference_set_even_variance(&reference, 1);
    CHECK(!reference.noise_known && reference.mse == 0 && reference.reason);
}

TEST_MAIN(TEST_CASE(mse_is_unbiased_however_noisy_the_reference),
          TEST_CASE(relmse_is_unbiased_where_the_reference_is_good),
          TEST_CASE(local_relmse_is_unbiased), TEST_CASE(without_it_there_is_a_bias),
          TEST_CASE(bad_variances_are_named))
