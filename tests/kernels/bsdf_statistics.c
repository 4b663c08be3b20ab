#include "bsdf_statistics.h"

#include <math.h>

// Returns the regularised incomplete gamma function Q(a, x): below the mean by the series for P
// (DLMF 8.7.1), above it by the continued fraction (DLMF 8.9.2, evaluated after Lentz 1976).
static double gamma_tail(double a, double x)
{
    if (x <= 0)
        return 1;
    double front = exp(a * log(x) - x - lgamma(a));
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (double n = 1; term > 1e-16 * sum; n++) {
            term *= x / (a + n);
            sum += term;
        }
        return 1 - front * sum;
    }
    double b = x + 1 - a, c = 1e300, d = 1 / b, value = d;
    for (double n = 1; n < 1e6; n++) {
        double numerator = -n * (n - a);
        b += 2;
        d = 1 / (numerator * d + b);
        c = b + numerator / c;
        value *= c * d;
        if (fabs(c * d - 1) < 1e-15)
            break;
    }
    return front * value;
}

double chi_square_tail(double statistic, double degrees)
{
    return gamma_tail(degrees / 2, statistic / 2);
}

struct pearson pearson_test(const double *expected, const uint32_t *count, uint32_t cells)
{
    struct pearson result = {0};
    double pool = 0, pool_count = 0, last = 0, last_count = 0;
    uint32_t pools = 0;
    for (uint32_t i = 0; i < cells; i++) {
        if (!(expected[i] > 0)) {
            result.impossible += count[i];
            continue;
        }
        pool += expected[i];
        pool_count += count[i];
        if (pool < 5)
            continue;
        if (pools > 0)
            result.statistic += (last_count - last) * (last_count - last) / last;
        last = pool;
        last_count = pool_count;
        pools++;
        pool = pool_count = 0;
    }
    // The remaining cells join the last pool.
    last += pool;
    last_count += pool_count;
    if (last > 0)
        result.statistic += (last_count - last) * (last_count - last) / last;
    result.degrees = pools > 1 ? pools - 1 : 0;
    // With a single cell there is no degree of freedom.
    result.p = result.degrees ? chi_square_tail(result.statistic, result.degrees) : 1;
    return result;
}
