// Tests forecasts for twice the samples with noise of known error: intervals must contain the error
// in 95 % of 1,000 draws. The 99.9 % range of the count is 950 +- 23.
#include "metrics/forecast.h"
#include "metrics/metrics.h"
#include "random.h"
#include "test.h"

enum { DRAWS = 1000, LEAST = 927, MOST = 973 };

static void check_coverage(const char *what, int covered)
{
    printf("  %s: %d of %d\n", what, covered, DRAWS);
    CHECK(covered >= LEAST && covered <= MOST, "%s: %d of %d", what, covered, DRAWS);
}

static bool covers(struct interval i, double truth)
{
    return i.low <= truth && truth <= i.high && i.low <= i.value && i.value <= i.high;
}

// --- error ---------------------------------------------------------------------------------------

enum { VALUES = 600, LOOKS = 5 };

// An image of independent pixels whose sums of samples grow as those of a film. Half the difference
// of the halves estimates the error, and their sum has the error.
struct film {
    double difference[VALUES], sum[VALUES], samples;
};

static void film_add(struct film *film, double samples)
{
    for (int i = 0; i < VALUES; i++) {
        film->difference[i] += sqrt(samples) * normal();
        film->sum[i] += sqrt(samples) * normal();
    }
    film->samples += samples;
}

static double mean_square(const double *sums, double samples)
{
    double sum = 0;
    for (int i = 0; i < VALUES; i++)
        sum += sums[i] * sums[i] / (samples * samples);
    return sum / VALUES;
}

// `variances` is 1 for the interval of the estimate, and 2 for the interval of the image's error.
static struct forecast_look look_at(const struct film *film, double variances)
{
    double error = mean_square(film->difference, film->samples);
    double half = 1.959964 * sqrt(variances * 2 / VALUES);
    return (struct forecast_look){film->samples, error, error * exp(-half), error * exp(half),
                                  0.95};
}

static void check_forecasts(double times)
{
    int by_law = 0, slope = 0, by_slope = 0;
    for (int d = 0; d < DRAWS; d++) {
        struct film film = {0};
        struct forecast_look looks[LOOKS];
        for (int i = 0; i < LOOKS; i++) {
            film_add(&film, i == 0 ? 16 : film.samples);
            looks[i] = look_at(&film, 1);
        }
        struct forecast_look last = look_at(&film, 2);
        struct forecast_params params = {
            .looks = looks,
            .count = LOOKS,
            .error = {last.error, last.low, last.high},
            .times = times,
        };
        struct forecast forecast;
        film_add(&film, (times - 1) * film.samples);
        double truth = mean_square(film.sum, film.samples);
        forecast_find_error(&params, &forecast);
        struct forecast again;
        params.spread = sqrt(2.0 / VALUES); // relative standard deviation of the estimates, which
                                            // their intervals already imply
        params.error = (struct interval){last.error, last.error, last.error};
        forecast_find_error(&params, &again);
        CHECK(fabs(again.slope.low - forecast.slope.low) < 1e-6, "%g", again.slope.low);
        params.spread = 0;
        CHECK(forecast.basis == FORECAST_SLOPE && forecast.looks == LOOKS, "%d %zu", forecast.basis,
              forecast.looks);
        slope += covers(forecast.slope, -1);
        by_slope += covers(forecast.error, truth);
        params.independent = true;
        params.error = (struct interval){last.error, last.low, last.high};
        forecast_find_error(&params, &forecast);
        CHECK(forecast.basis == FORECAST_INVERSE, "%d", forecast.basis);
        by_law += covers(forecast.error, truth);
    }
    printf("  to %g times the samples:\n", times);
    check_coverage("1 / samples", by_law);
    check_coverage("slope", slope);
    // The interval also allows for the case that the slope ends and the error continues as 1 /
    // samples.
    printf("  by slope: %d of %d\n", by_slope, DRAWS);
    CHECK(by_slope >= LEAST, "%d of %d", by_slope, DRAWS);
}

TEST(forecasts_cover)
{
    check_forecasts(2);
    check_forecasts(4);
}

// In an image with rare bright samples, the future error is less certain than the present one.
TEST(spread_of_spiky_noise)
{
    enum { WIDE = 40, SPIKY = WIDE * WIDE, SAMPLES = 64 };
    static double sums[2][SPIKY];
    static float halves[2][SPIKY][3];
    double mean = 0, square = 0, told = 0;
    int covered[2] = {0};
    for (int d = 0; d < DRAWS; d++) {
        struct forecast_params params = {.independent = true};
        double before = 0;
        memset(sums, 0, sizeof sums);
        for (int more = SAMPLES / 2, times = 1; times <= 4;
             more = SAMPLES / 2 * times, times *= 2) {
            double after = 0;
            for (int i = 0; i < SPIKY; i++) {
                for (int h = 0; h < 2; h++)
                    for (int s = 0; s < more; s++)
                        sums[h][i] += uniform() < 0.01 ? 100.0 : 0.0;
                double value = (sums[0][i] + sums[1][i]) / (SAMPLES * times);
                after += (value - 1) * (value - 1) / (1 + METRICS_RELMSE_EPSILON) / SPIKY;
                for (int h = 0; times == 1 && h < 2; h++)
                    for (int c = 0; c < 3; c++)
                        halves[h][i][c] = (float)(sums[h][i] / (SAMPLES / 2));
            }
            if (times == 1) {
                const struct half_error_params half = {.half_a = (const float(*)[3])halves[0],
                                                       .half_b = (const float(*)[3])halves[1],
                                                       .width = WIDE,
                                                       .height = WIDE,
                                                       .samples = SAMPLES};
                struct half_error error;
                CHECK(metrics_half_error(&half, &error) && error.known);
                before = error.local_relmse;
                params.error = (struct interval){before, before, before};
                params.spread = error.spread;
                params.spread_terms = error.spread_terms;
                told += error.spread / DRAWS;
                continue;
            }
            struct forecast forecast;
            params.times = times;
            forecast_find_error(&params, &forecast);
            covered[times / 4] += covers(forecast.error, after);
        }
        mean += before / DRAWS;
        square += before * before / DRAWS;
    }
    double spread = sqrt(square - mean * mean) / mean;
    printf("  spread %.3f, told %.3f; covered in %d, to four times the samples in %d\n", spread,
           told, covered[0], covered[1]);
    CHECK(told > 0.95 * spread && told < 1.3 * spread, "%g, not %g", told, spread);
    CHECK(covered[0] >= LEAST && covered[1] >= LEAST, "%d, %d", covered[0], covered[1]);
}

// If few pixels carry the error, they give little information about its variation over seeds.
TEST(few_terms_widen)
{
    struct forecast_params params = {
        .error = {1e-3, 9e-4, 1.1e-3}, .spread = 0.2, .spread_terms = 1000, .independent = true};
    struct forecast many, few;
    forecast_find_error(&params, &many);
    params.spread_terms = 3;
    forecast_find_error(&params, &few);
    // The quantiles of Student's t with 1000 and with 3 degrees of freedom.
    CHECK(fabs(log(many.error.high / many.error.value) - 1.9623 * sqrt(1.5) * 0.2) < 1e-4);
    CHECK(fabs(log(few.error.high / few.error.value) - 3.1824 * sqrt(1.5) * 0.2) < 1e-4);
}

TEST(few_looks_are_no_slope)
{
    struct forecast_look looks[] = {
        {16, 4e-3, 3e-3, 5e-3, 0.95},
        {32, 2e-3, 1e-3, 3e-3, 0.95},
        {64, 1e-3, 8e-4, 2e-3, 0.95},
    };
    struct forecast_params params = {.looks = looks, .count = 3, .error = {1e-3, 8e-4, 2e-3}};
    struct forecast f;
    forecast_find_error(&params, &f);
    CHECK(f.basis == FORECAST_AT_LEAST && f.looks == 0, "%d", f.basis);
    // With stratification the error may decrease as N^(-3/2).
    CHECK(f.error.value == 5e-4 && fabs(f.error.low / 4e-4 - sqrt(0.5)) < 1e-12 &&
              f.error.high == 1e-3,
          "%g", f.error.value);
    params.stays = (struct interval){3e-3, 2e-3, 4e-3};
    forecast_find_error(&params, &f);
    CHECK(fabs(f.error.value - 3.5e-3) < 1e-15 && f.error.low < 2.5e-3 && f.error.low > 2.4e-3,
          "%g %g", f.error.value, f.error.low);
}

// Estimates with an unknown error are omitted; the number of usable ones decides whether there is a
// slope.
TEST(unknown_looks_are_left_out)
{
    struct forecast_look looks[6];
    for (int i = 0; i < 6; i++) {
        double error = 1e-2 * exp2(-1.5 * i);
        looks[i] = (struct forecast_look){16 << i, error, 0.9 * error, 1.1 * error, 0.95};
    }
    looks[1].error = NAN;
    struct forecast_params params = {.looks = looks, .count = 6, .error = {1e-4, 9e-5, 1.1e-4}};
    struct forecast f;
    forecast_find_error(&params, &f);
    CHECK(f.basis == FORECAST_SLOPE && f.looks == 4, "%d %zu", f.basis, f.looks);
    CHECK(fabs(f.slope.value + 1.5) < 1e-9, "%g", f.slope.value);
    CHECK(fabs(f.error.value - 1e-4 * exp2(-1.5)) < 1e-12, "%g", f.error.value);
    looks[3].high = looks[3].low; // without a width the estimate has no weight
    forecast_find_error(&params, &f);
    CHECK(f.basis == FORECAST_AT_LEAST, "%d", f.basis);
}

TEST(an_unknown_error_has_no_forecast)
{
    const double values[][3] = {{NAN, NAN, NAN},
                                {0, 0, 0},
                                {1e-3, 9e-4, INFINITY},
                                {-1e-3, -2e-3, -1e-4},
                                {1e-3, NAN, NAN}};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        struct forecast_params params = {.error = {values[i][0], values[i][1], values[i][2]}};
        struct forecast f;
        forecast_find_error(&params, &f);
        CHECK(isnan(f.error.value), "case %zu: %g", i, f.error.value);
    }
}

// --- bias ----------------------------------------------------------------------------------------

enum { SIDE = 48, PIXELS = SIDE * SIDE };

struct picture {
    float a[PIXELS][3], b[PIXELS][3], r[PIXELS][3];
};

// Draws a dark and a bright half, whose noise is proportional to their values, too bright by
// `factor`.
static void draw(struct picture *p, double factor)
{
    for (int i = 0; i < PIXELS; i++)
        for (int c = 0; c < 3; c++) {
            double truth = i % SIDE < SIDE / 2 ? 0.05 : 2.0;
            p->r[i][c] = (float)truth;
            p->a[i][c] = (float)(truth * (factor + 0.1 * normal()));
            p->b[i][c] = (float)(truth * (factor + 0.1 * normal()));
        }
}

// Computes the local mean by its definition, with the window's weights along x only, because all
// rows are alike.
static double mean_around(int x)
{
    double sum = 0, weights = 0;
    for (int u = x < 5 ? 0 : x - 5; u <= x + 5 && u < SIDE; u++) {
        double weight = exp(-(u - x) * (u - x) / 4.5);
        sum += weight * (u < SIDE / 2 ? 0.05 : 2.0);
        weights += weight;
    }
    return sum / weights;
}

// Returns the mean over columns of `dark` or `bright` over L^2 + epsilon.
static double local(double dark, double bright)
{
    double sum = 0;
    for (int x = 0; x < SIDE; x++) {
        double l = mean_around(x);
        sum += (x < SIDE / 2 ? dark : bright) / (l * l + 1e-2) / SIDE;
    }
    return sum;
}

static double expected_bias(double factor)
{
    return (factor - 1) * (factor - 1) * local(0.05 * 0.05, 4.0);
}

static struct forecast_bias find(const struct picture *p, double own)
{
    static float means[PIXELS][3];
    CHECK(metrics_local_means((const float(*)[3])p->r, SIDE, SIDE, NULL, means));
    const struct forecast_bias_params params = {
        .half_a = (const float(*)[3])p->a,
        .half_b = (const float(*)[3])p->b,
        .reference = (const float(*)[3])p->r,
        .means = (const float(*)[3])means,
        .width = SIDE,
        .height = SIDE,
        .reference_error = own,
    };
    struct forecast_bias out;
    bool ok = forecast_find_bias(&params, &out);
    CHECK(ok);
    return out;
}

TEST(bias_is_told_from_noise)
{
    static struct picture p;
    int covered = 0, covered_biased = 0, certain = 0, found = 0;
    double mean = 0;
    for (int d = 0; d < DRAWS; d++) {
        draw(&p, 1);
        struct forecast_bias none = find(&p, 0);
        covered += covers(none.stays, 0);
        certain += none.is_certain;
        mean += none.stays.value / DRAWS;
        draw(&p, 1.05);
        struct forecast_bias some = find(&p, 0);
        covered_biased += covers(some.stays, expected_bias(1.05));
        found += some.is_certain;
    }
    // Expected in 0.05 % of draws; more than 6 of 1000 have a probability of 1e-6.
    printf("  without bias: mean %.3g, certain in %d; with 5 %%: found in %d\n", mean, certain,
           found);
    // An interval above 0 is extended to 0 here, so it can only fail from below, in 2.5 % of draws.
    // The 99.9 % range about 975 is +-16.
    printf("  no bias: %d of %d\n", covered, DRAWS);
    CHECK(covered >= 959 && covered <= 991, "%d", covered);
    CHECK(certain <= 6, "%d", certain);
    CHECK(fabs(mean) < 1e-5, "%g", mean);
    // The two halves of the image contribute differently, which makes the interval too wide rather
    // than too narrow.
    CHECK(covered_biased >= LEAST && found == DRAWS, "%d %d", covered_biased, found);
}

// A third of the light comes from few samples, whose brightness is distributed evenly over four
// orders of magnitude.
static void draw_rare(struct picture *p, double expected)
{
    const double part = 0.3, orders = log(1e4), brightest = part * 2 * PIXELS * orders / expected;
    for (int i = 0; i < PIXELS; i++)
        for (int c = 0; c < 3; c++) {
            p->r[i][c] = 1;
            p->a[i][c] = p->b[i][c] = (float)(1 - part * (1 - 1e-4));
        }
    // A Poisson process: the gaps are exponential.
    for (double at = -log(uniform()) / expected; at < 1; at -= log(uniform()) / expected) {
        float(*half)[3] = uniform() < 0.5 ? p->a : p->b;
        float *pixel = half[(int)(uniform() * PIXELS)];
        float sample = (float)(brightest * exp(-orders * uniform()));
        for (int c = 0; c < 3; c++)
            pixel[c] += sample;
    }
}

TEST(rare_samples_are_no_bias)
{
    static const double expected[] = {20, 60, 300, 3000};
    static struct picture p;
    for (size_t e = 0; e < sizeof expected / sizeof *expected; e++) {
        int certain = 0;
        for (int d = 0; d < DRAWS; d++) {
            draw_rare(&p, expected[e]);
            certain += find(&p, 0).is_certain;
        }
        printf("  %g rare samples: certain in %d of %d\n", expected[e], certain, DRAWS);
        CHECK(certain <= 6, "%d", certain);
    }
}

TEST(noise_of_the_reference_is_no_bias)
{
    static struct picture p;
    double mean = 0, own = 0;
    for (int d = 0; d < 200; d++) {
        draw(&p, 1);
        for (int i = 0; i < PIXELS; i++)
            for (int c = 0; c < 3; c++)
                p.r[i][c] += (float)(0.02 * normal());
        own = local(4e-4, 4e-4); // valid as long as the noise is small relative to the values
        mean += find(&p, own).stays.value / 200;
    }
    CHECK(fabs(mean) < 0.05 * own, "%g of %g", mean, own);
}

TEST(what_is_not_finite_is_left_out)
{
    static struct picture p;
    draw(&p, 1.05);
    p.a[5][1] = NAN;
    p.b[100][2] = INFINITY;
    p.r[200][0] = NAN;
    CHECK(find(&p, 0).is_certain, "with three pixels fewer");
    for (int i = 0; i < PIXELS; i++)
        p.r[i][0] = NAN;
    CHECK(isnan(find(&p, 0).stays.value) && !find(&p, 0).is_certain, "without any");
    struct forecast_bias_params params = {.width = 0, .height = 0};
    struct forecast_bias out;
    bool ok = forecast_find_bias(&params, &out);
    CHECK(ok && isnan(out.stays.value), "no pixels");
}

TEST_MAIN(TEST_CASE(forecasts_cover), TEST_CASE(few_looks_are_no_slope),
          TEST_CASE(spread_of_spiky_noise), TEST_CASE(few_terms_widen),
          TEST_CASE(unknown_looks_are_left_out), TEST_CASE(an_unknown_error_has_no_forecast),
          TEST_CASE(bias_is_told_from_noise), TEST_CASE(rare_samples_are_no_bias),
          TEST_CASE(noise_of_the_reference_is_no_bias), TEST_CASE(what_is_not_finite_is_left_out))
