#include "metrics/spread.h"

#include "metrics/metrics.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// Returns the number k of values that may be left out at either end: the greatest k with 2 P(X < k)
// <= 5 %, where X, the number of `count` values below the median, is binomial with probability 1/2.
// Returns 0 if even the extreme values do not enclose the median with 95 %.
static size_t rank_of_end(size_t count)
{
    double n = (double)count, sum = 0.0;
    for (size_t k = 0; k < count; k++) {
        double i = (double)k;
        sum += exp(lgamma(n + 1) - lgamma(i + 1) - lgamma(n - i + 1) - n * log(2.0));
        if (2.0 * sum > 0.05)
            return k;
    }
    return 0;
}

bool spread_median(const double *values, size_t count, struct interval *out)
{
    *out = (struct interval){NAN, NAN, NAN};
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return true;
    if (count == 0)
        return true;
    double *sorted = malloc(count * sizeof *sorted);
    if (!sorted)
        return false;
    memcpy(sorted, values, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, compare);
    out->value = 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]);
    size_t rank = rank_of_end(count);
    if (rank > 0) {
        out->low = sorted[rank - 1];
        out->high = sorted[count - rank];
    }
    free(sorted);
    return true;
}

struct log_moments {
    double mean, error; // mean of the logarithms, and the variance of that mean
};

static bool take_logs(struct spread_set set, struct log_moments *out)
{
    double n = (double)set.count, sum = 0.0, squares = 0.0;
    for (size_t i = 0; i < set.count; i++) {
        if (!(set.values[i] > 0) || !isfinite(set.values[i]))
            return false;
        sum += log(set.values[i]);
    }
    out->mean = sum / n;
    for (size_t i = 0; i < set.count; i++) {
        double d = log(set.values[i]) - out->mean;
        squares += d * d;
    }
    out->error = squares / (n - 1) / n;
    return set.count >= 2;
}

struct interval spread_ratio(struct spread_set numerator, struct spread_set denominator,
                             double confidence)
{
    struct log_moments a, b;
    if (!take_logs(numerator, &a) || !take_logs(denominator, &b))
        return (struct interval){NAN, NAN, NAN};
    double error = a.error + b.error, ratio = exp(a.mean - b.mean);
    if (!(error > 0))
        return (struct interval){ratio, ratio, ratio};
    double freedom = error * error /
                     (a.error * a.error / ((double)numerator.count - 1) +
                      b.error * b.error / ((double)denominator.count - 1));
    double half = stats_t_quantile(0.5 + 0.5 * confidence, freedom) * sqrt(error);
    return (struct interval){ratio, ratio * exp(-half), ratio * exp(half)};
}
