// Tests error curves with noise of known error: intervals must contain the true values in 95 % of
// 1,000 draws. The 99.9 % range of the count is 950 +- 23.
#include "metrics/curve.h"
#include "random.h"
#include "test.h"

enum { DRAWS = 1000, REPLICATES = 16, POINTS = 8, LEAST = 927, MOST = 973 };

static void check_coverage(const char *what, int covered)
{
    printf("  %s: %d of %d\n", what, covered, DRAWS);
    CHECK(covered >= LEAST && covered <= MOST, "%s: %d of %d", what, covered, DRAWS);
}

static bool covers(struct interval i, double truth)
{
    return i.low <= truth && truth <= i.high && i.low <= i.value && i.value <= i.high;
}

TEST(geometric_mean_covers)
{
    int covered = 0;
    for (int d = 0; d < DRAWS; d++) {
        double values[REPLICATES];
        for (int r = 0; r < REPLICATES; r++)
            values[r] = 3e-4 * exp(0.7 * normal());
        covered += covers(curve_geometric_mean(values, REPLICATES), 3e-4);
    }
    check_coverage("geometric mean", covered);
}

// The errors of a replicate depend on each other, as those of a film do: a random walk about the
// line.
TEST(slope_covers)
{
    double x[REPLICATES][POINTS], errors[REPLICATES][POINTS];
    int covered = 0;
    for (int d = 0; d < DRAWS; d++) {
        for (int r = 0; r < REPLICATES; r++) {
            double walk = 0;
            for (int i = 0; i < POINTS; i++) {
                walk += 0.1 * normal();
                x[r][i] = (double)(16 << i) * exp(0.3 * normal());
                errors[r][i] = 5 * pow(x[r][i], -1.25) * exp(walk);
            }
        }
        covered += covers(curve_slope(x[0], errors[0], POINTS, REPLICATES), -1.25);
    }
    check_coverage("slope", covered);
}

TEST(exact_lines)
{
    const double x[2][3] = {{1, 10, 100}, {2, 20, 200}};
    const double errors[2][3] = {{8, 0.8, 0.08}, {5, 0.5, 0.05}};
    struct interval slope = curve_slope(x[0], errors[0], 3, 2);
    CHECK(fabs(slope.value + 1) < 1e-12 && fabs(slope.low + 1) < 1e-9, "%.17g", slope.value);
    const double a[3] = {2, 4, 6}, b[3] = {1, 2, 3};
    struct interval ratio = curve_paired_ratio(a, b, 3);
    CHECK(fabs(ratio.value - 2) < 1e-12 && curve_judge(ratio) == CURVE_BETTER);
    CHECK(strcmp(curve_verdict_words(curve_judge(ratio)), "faster") == 0);
    ratio = curve_paired_ratio(b, a, 3);
    CHECK(fabs(ratio.value - 0.5) < 1e-12 && curve_judge(ratio) == CURVE_WORSE);
    CHECK(strcmp(curve_verdict_words(curve_judge(ratio)), "slower") == 0);
}

TEST(means_cover)
{
    int covered = 0;
    for (int d = 0; d < DRAWS; d++) {
        double values[REPLICATES];
        for (int r = 0; r < REPLICATES; r++)
            values[r] = 0.7 + 0.1 * normal();
        covered += covers(curve_mean(values, REPLICATES), 0.7);
    }
    check_coverage("mean", covered);
}

// The curve has a piece of 1 / x and one of 1 / x^2. Targets are on them, at a point, before the
// first and beyond the last point.
TEST(where_a_curve_comes_down_to)
{
    const double x[3] = {1, 10, 100}, errors[3] = {1, 0.1, 1e-3};
    static const double expected[][3] = {// target, slope, x
                                         {0.5, -1, 2},    {1e-2, -1, 31.622776601683793},
                                         {0.1, -1, 10},   {1e-4, -2, 316.22776601683796},
                                         {1e-4, -1, 1e3}, {4, -2, 0.5}};
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
        double found = curve_reach(x, errors, 3, expected[i][1], expected[i][0]);
        CHECK(fabs(found / expected[i][2] - 1) < 1e-12, "%zu: %.17g", i, found);
    }
    CHECK(isnan(curve_reach(x, errors, 3, 0, 1e-4)), "it never comes there");
    CHECK(isnan(curve_reach(x, errors, 3, 0.1, 1e-4)));
    CHECK(isnan(curve_reach(x, errors, 3, NAN, 1e-4)));
    CHECK(isfinite(curve_reach(x, errors, 3, NAN, 0.5)), "no slope is needed between points");
    const double holes[3] = {1, NAN, 1e-3};
    CHECK(isnan(curve_reach(x, holes, 3, -1, 1e-2)));
}

TEST(paired_ratio_covers)
{
    int covered = 0, told_apart = 0;
    for (int d = 0; d < DRAWS; d++) {
        double a[REPLICATES], b[REPLICATES];
        for (int r = 0; r < REPLICATES; r++) {
            double shared = exp(2 * normal()); // the factor that both results get from the seed
            a[r] = shared * exp(0.2 * normal());
            b[r] = shared * exp(0.2 * normal());
        }
        struct interval ratio = curve_paired_ratio(a, b, REPLICATES);
        covered += covers(ratio, 1);
        told_apart += curve_judge(ratio) != CURVE_NOT_TOLD_APART;
    }
    check_coverage("paired ratio", covered);
    CHECK(told_apart == DRAWS - covered, "%d", told_apart);
}

TEST(what_is_not_known)
{
    const double values[3] = {1, 0, 2}, x[1] = {1};
    struct interval alone = curve_geometric_mean(values, 1);
    CHECK(alone.value == 1 && isnan(alone.low) && isnan(alone.high), "%g", alone.value);
    CHECK(isnan(curve_geometric_mean(values, 0).value));
    const double infinite[2] = {1, INFINITY};
    CHECK(isnan(curve_mean(infinite, 2).value));
    CHECK(isnan(curve_geometric_mean(values, 3).value), "an error of 0 has no logarithm");
    CHECK(isnan(curve_slope(x, values, 1, 3).value));
    CHECK(isnan(curve_paired_ratio(values, values, 3).value));
    enum curve_verdict verdict = curve_judge(curve_paired_ratio(values, values, 3));
    CHECK(verdict == CURVE_NOT_TOLD_APART);
    CHECK(strcmp(curve_verdict_words(verdict), "no difference was found") == 0);
}

TEST_MAIN(TEST_CASE(geometric_mean_covers), TEST_CASE(means_cover), TEST_CASE(slope_covers),
          TEST_CASE(exact_lines), TEST_CASE(where_a_curve_comes_down_to),
          TEST_CASE(paired_ratio_covers), TEST_CASE(what_is_not_known))
