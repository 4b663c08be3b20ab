#include "metrics/curve.h"

#include "metrics/metrics.h"
#include <math.h>
#include <stdlib.h>

static const struct interval unknown = {NAN, NAN, NAN};

static struct interval exponential(struct interval i)
{
    return (struct interval){exp(i.value), exp(i.low), exp(i.high)};
}

// The mean and the sum of squared deviations by Welford's method (1962), which needs no list of
// values.
struct running {
    double mean, squares;
    size_t count;
};

static void run_add(struct running *r, double value)
{
    double before = value - r->mean;
    r->count++;
    r->mean += before / (double)r->count;
    r->squares += before * (value - r->mean);
}

static struct interval run_interval(const struct running *r)
{
    if (r->count < 1 || !isfinite(r->mean))
        return unknown;
    if (r->count < 2)
        return (struct interval){r->mean, NAN, NAN};
    double n = (double)r->count, deviation = sqrt(r->squares / (n - 1) / n);
    double half = stats_t_quantile(0.975, n - 1) * deviation;
    return (struct interval){r->mean, r->mean - half, r->mean + half};
}

struct interval curve_mean(const double *values, size_t count)
{
    struct running running = {0};
    for (size_t i = 0; i < count; i++)
        run_add(&running, values[i]);
    return run_interval(&running);
}

struct interval curve_geometric_mean(const double *values, size_t count)
{
    struct running logs = {0};
    for (size_t i = 0; i < count; i++)
        run_add(&logs, values[i] > 0 ? log(values[i]) : NAN);
    return exponential(run_interval(&logs));
}

static double line_slope(const double *x, const double *y, size_t count)
{
    double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
    for (size_t i = 0; i < count; i++) {
        mean_x += log(x[i]) / (double)count;
        mean_y += (y[i] > 0 ? log(y[i]) : NAN) / (double)count;
    }
    for (size_t i = 0; i < count; i++) {
        double dx = log(x[i]) - mean_x;
        xx += dx * dx;
        xy += dx * (log(y[i]) - mean_y);
    }
    return xy / xx;
}

struct interval curve_slope(const double *x, const double *errors, size_t points, size_t replicates)
{
    struct running slopes = {0};
    for (size_t r = 0; r < replicates && points > 1; r++)
        run_add(&slopes, line_slope(x + r * points, errors + r * points, points));
    return run_interval(&slopes);
}

struct interval curve_paired_ratio(const double *a, const double *b, size_t count)
{
    struct running logs = {0};
    for (size_t i = 0; i < count; i++)
        run_add(&logs, a[i] > 0 && b[i] > 0 ? log(a[i] / b[i]) : NAN);
    return exponential(run_interval(&logs));
}

double curve_reach(const double *x, const double *errors, size_t points, double slope,
                   double target)
{
    size_t next = 0; // the first point whose error is at or below the target
    while (next < points && !(errors[next] <= target))
        next++;
    bool between = next > 0 && next < points;
    size_t from = next < points ? next : points - 1;
    if (between)
        slope = log(errors[next] / errors[next - 1]) / log(x[next] / x[next - 1]);
    double reached = x[from] * pow(target / errors[from], 1 / slope);
    return slope < 0 && isfinite(reached) ? reached : NAN;
}

enum curve_verdict curve_judge(struct interval ratio)
{
    return ratio.low > 1 ? CURVE_BETTER : ratio.high < 1 ? CURVE_WORSE : CURVE_NOT_TOLD_APART;
}

const char *curve_verdict_words(enum curve_verdict verdict)
{
    return verdict == CURVE_BETTER  ? "faster"
           : verdict == CURVE_WORSE ? "slower"
                                    : "no difference was found";
}
