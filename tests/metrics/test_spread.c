// Tests intervals of repeated timings with noise whose true median is known.
#include "metrics/spread.h"
#include "random.h"
#include "test.h"

enum { DRAWS = 1000, ROWS = 10 };

static bool covers(struct interval i, double truth)
{
    return i.low <= truth && truth <= i.high;
}

// The number of covering intervals in 1,000 draws must be within 3.3 standard deviations, as in
// 99.9 % of cases.
static void check_coverage(const char *what, int covered, double expected)
{
    double off = 3.3 * sqrt(DRAWS * expected * (1 - expected));
    printf("  %s: %d of %d, expected %.1f\n", what, covered, DRAWS, DRAWS * expected);
    CHECK(fabs(covered - DRAWS * expected) <= off, "%s: %d of %d", what, covered, DRAWS);
}

// Exponential times with the median log 2. How often the interval contains it is known exactly, for
// any distribution: 1 - 2 P(X < k), where X is binomial with (count, 1/2).
TEST(medians_are_covered)
{
    static const struct {
        size_t count;
        double coverage;
    } cases[] = {
        {6, 1 - 2.0 / 64},
        {7, 1 - 2.0 / 128},
        {9, 1 - 2.0 * (1 + 9) / 512},
        {20, 1 - 2.0 * (1 + 20 + 190 + 1140 + 4845 + 15504) / 1048576},
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        int covered = 0;
        for (int d = 0; d < DRAWS; d++) {
            double values[20];
            struct interval i;
            for (size_t k = 0; k < cases[c].count; k++)
                values[k] = -log(uniform());
            CHECK(spread_median(values, cases[c].count, &i), "memory");
            covered += covers(i, log(2.0));
        }
        CHECK(cases[c].coverage >= 0.95, "%zu values: %g", cases[c].count, cases[c].coverage);
        check_coverage("median", covered, cases[c].coverage);
    }
}

TEST(medians_of_little)
{
    struct interval i;
    const double values[] = {3, 1, 2, 10, 5};
    CHECK(spread_median(values, 5, &i) && i.value == 3 && isnan(i.low), "five values");
    CHECK(spread_median(values, 4, &i) && i.value == 2.5 && isnan(i.high), "four values");
    CHECK(spread_median(values, 1, &i) && i.value == 3, "one value");
    CHECK(spread_median(values, 0, &i) && isnan(i.value), "no value");
    const double unknown[] = {1, 2, NAN, 3};
    CHECK(spread_median(unknown, 4, &i) && isnan(i.value), "a time that is not known");
    const double ordered[] = {6, 5, 4, 3, 2, 1};
    CHECK(spread_median(ordered, 6, &i) && i.low == 1 && i.high == 6 && i.value == 3.5, "six");
}

static void draw(double *values, size_t count, double center, double spread)
{
    for (size_t i = 0; i < count; i++)
        values[i] = center * exp(spread * normal());
}

// The sets differ in number and noise, for which Welch's interval is made.
TEST(ratios_are_covered)
{
    int covered = 0, covered_99 = 0;
    for (int d = 0; d < DRAWS; d++) {
        double a[7], b[15];
        draw(a, 7, 12.0, 0.02);
        draw(b, 15, 10.0, 0.10);
        const struct spread_set now = {a, 7}, then = {b, 15};
        covered += covers(spread_ratio(now, then, 0.95), 1.2);
        covered_99 += covers(spread_ratio(now, then, 0.99), 1.2);
    }
    check_coverage("ratio, 95 %", covered, 0.95);
    check_coverage("ratio, 99 %", covered_99, 0.99);
}

// None of many rows has changed. With the error divided among them (Bonferroni), at most one run in
// twenty reports any change. Welch's interval may report fewer.
TEST(rows_that_stay_are_left_alone)
{
    int alarms = 0, found = 0;
    for (int d = 0; d < DRAWS; d++) {
        bool alarm = false;
        double a[7], b[7];
        for (int r = 0; r < ROWS; r++) {
            draw(a, 7, 5.0, 0.05);
            draw(b, 7, 5.0, 0.05);
            alarm |= !covers(
                spread_ratio((struct spread_set){a, 7}, (struct spread_set){b, 7}, 1 - 0.05 / ROWS),
                1.0);
        }
        draw(a, 7, 7.0, 0.05);
        found += spread_ratio((struct spread_set){a, 7}, (struct spread_set){b, 7}, 1 - 0.05 / ROWS)
                     .low > 1.0;
        alarms += alarm;
    }
    printf("  alarms: %d of %d; what is slower by 1.4 is found in %d\n", alarms, DRAWS, found);
    CHECK(alarms <= 50 + 23, "%d alarms of %d", alarms, DRAWS);
    CHECK(found >= 950, "found %d of %d", found, DRAWS);
}

TEST(ratios_of_little)
{
    const double a[] = {2, 2, 2}, b[] = {1, 1, 1}, zero[] = {1, 0, 1};
    struct interval i = spread_ratio((struct spread_set){a, 3}, (struct spread_set){b, 3}, 0.95);
    CHECK(fabs(i.value - 2) < 1e-12 && i.low == i.value && i.high == i.value, "without noise");
    i = spread_ratio((struct spread_set){a, 1}, (struct spread_set){b, 3}, 0.95);
    CHECK(isnan(i.value), "one value");
    i = spread_ratio((struct spread_set){a, 3}, (struct spread_set){zero, 3}, 0.95);
    CHECK(isnan(i.value), "a time of nothing");
}

TEST_MAIN(TEST_CASE(medians_are_covered), TEST_CASE(medians_of_little),
          TEST_CASE(ratios_are_covered), TEST_CASE(rows_that_stay_are_left_alone),
          TEST_CASE(ratios_of_little))
