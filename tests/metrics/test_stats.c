#include "metrics/metrics.h"
#include "test.h"

static void check_quantile(double p, double degrees, double expected)
{
    double got = stats_t_quantile(p, degrees);
    CHECK(fabs(got - expected) <= 1e-6 * fabs(expected), "p %.17g, n %g: got %.12g, expected %.12g",
          p, degrees, got, expected);
}

// From the NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.2, with more decimals.
TEST(t_quantile_matches_tables)
{
    check_quantile(0.975, 10, 2.228138852);
    check_quantile(0.975, 63, 1.998340543);
    check_quantile(0.975, 30, 2.042272456);
    check_quantile(0.95, 5, 2.015048373);
    check_quantile(0.995, 20, 2.845339710);
    CHECK(fabs(stats_t_quantile(0.999, 10) - 4.144) < 5e-4, "%g", stats_t_quantile(0.999, 10));
    CHECK(fabs(stats_t_quantile(0.90, 100) - 1.290) < 5e-4, "%g", stats_t_quantile(0.90, 100));
}

// With 1, 2 and 4 degrees of freedom the distribution inverts in closed form (Shaw 2006, "Sampling
// Student's T distribution", section 3).
TEST(t_quantile_matches_closed_forms)
{
    static const double tails[] = {1e-100, 1e-12, 1e-6, 5e-4, 0.025, 0.1, 0.2499, 0.2501, 0.4999};
    const double pi = acos(-1.0);
    for (size_t i = 0; i < sizeof tails / sizeof tails[0]; i++) {
        double p = tails[i], odds = 4 * p * (1 - p);
        check_quantile(p, 1, -cos(pi * p) / sin(pi * p));
        check_quantile(p, 2, -(1 - 2 * p) * sqrt(2 / odds));
        double q = cos(acos(sqrt(odds)) / 3) / sqrt(odds);
        check_quantile(p, 4, -2 * sqrt(q - 1));
    }
    double step = 1e-9; // near the middle, where the density for two degrees of freedom is 1 /
                        // sqrt(8)
    check_quantile(0.5 + step, 2, (0.5 + step - 0.5) * sqrt(8.0));
}

// Integrates the density beyond t, independently of the incomplete beta function: by Simpson's rule
// over the angle with tan(angle) = t / sqrt(n), where the density is a power of the cosine.
static double tail_by_integration(double t, double n)
{
    const int steps = 200000;
    double from = atan(t / sqrt(n)), to = acos(-1.0) / 2, h = (to - from) / steps, sum = 0;
    for (int i = 0; i <= steps; i++) {
        double weight = i == 0 || i == steps ? 1 : i % 2 ? 4 : 2;
        sum += weight * pow(fabs(cos(from + i * h)), n - 1);
    }
    return sum * h / 3 * exp(lgamma((n + 1) / 2) - lgamma(n / 2)) / sqrt(acos(-1.0));
}

TEST(t_quantile_matches_integration)
{
    static const double degrees[] = {1.5, 3, 15, 63, 99, 101, 1000};
    static const double tails[] = {0.0005, 0.025, 0.4};
    for (size_t i = 0; i < sizeof degrees / sizeof degrees[0]; i++)
        for (size_t k = 0; k < sizeof tails / sizeof tails[0]; k++) {
            double t = stats_t_quantile(1 - tails[k], degrees[i]);
            double tail = tail_by_integration(t, degrees[i]);
            CHECK(fabs(tail - tails[k]) <= 2e-7 * tails[k], "n %g: %.12g, expected %.12g",
                  degrees[i], tail, tails[k]);
        }
}

TEST(t_quantile_tends_to_the_normal)
{
    // The first term of the expansion in 1/n (Abramowitz and Stegun 26.7.5) at n = 1e9 is 1e-9.
    const double z = 1.959963984540054;
    CHECK(fabs(stats_t_quantile(0.975, 1e9) - z) < 1e-8, "%.12g", stats_t_quantile(0.975, 1e9));
    double n = 1e6, expected = z + (z * z * z + z) / (4 * n);
    CHECK(fabs(stats_t_quantile(0.975, n) - expected) < 1e-10);
}

TEST(t_quantile_is_odd_and_refuses_nonsense)
{
    CHECK(stats_t_quantile(0.5, 7) == 0);
    CHECK(stats_t_quantile(0.25, 7) == -stats_t_quantile(0.75, 7));
    CHECK(isnan(stats_t_quantile(0, 5)));
    CHECK(isnan(stats_t_quantile(1, 5)));
    CHECK(isnan(stats_t_quantile(NAN, 5)));
    CHECK(isnan(stats_t_quantile(0.3, 0.5)));
    CHECK(isnan(stats_t_quantile(0.3, INFINITY)));
}

TEST(mean_and_variance)
{
    const double values[] = {1e9 + 4, 1e9 + 7, 1e9 + 13, 1e9 + 16};
    double mean, variance;
    stats_mean_variance(values, 4, &mean, &variance);
    CHECK(mean == 1e9 + 10, "%.17g", mean);
    CHECK(variance == 30, "%.17g", variance);
    stats_mean_variance(values, 1, &mean, &variance);
    CHECK(mean == 1e9 + 4 && isnan(variance));
    stats_mean_variance(values, 0, &mean, &variance);
    CHECK(isnan(mean) && isnan(variance));
}

TEST_MAIN(TEST_CASE(t_quantile_matches_tables), TEST_CASE(t_quantile_matches_closed_forms),
          TEST_CASE(t_quantile_matches_integration), TEST_CASE(t_quantile_tends_to_the_normal),
          TEST_CASE(t_quantile_is_odd_and_refuses_nonsense), TEST_CASE(mean_and_variance))
