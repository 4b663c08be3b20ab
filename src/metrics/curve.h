// The error as a function of samples and time, from replicates: independent runs of the same method
// with different seeds. The functions work on plain arrays; any thread may call them.
#ifndef LAMPYRIS_METRICS_CURVE_H
#define LAMPYRIS_METRICS_CURVE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// A number with its 95 % confidence interval. Members that are not known are NAN; the interval is
// not known if there is only one value.
struct interval {
    double value, low, high;
};

// Returns the arithmetic mean with Student's t interval, for values in [0, 1] or in decibels. The
// result is not known (NAN) if a value is not finite.
struct interval curve_mean(const double *values, size_t count);

// Returns the geometric mean, with Student's t interval of the logarithms, for values that vary by
// factors, such as errors. The result is not known (NAN) if a value is not positive.
struct interval curve_geometric_mean(const double *values, size_t count);

// Estimates the exponent with which an error decreases: errors[r][i] ~ x[r][i]^slope. The points of
// a replicate share their samples and are not independent, so a least-squares line through the
// logarithms is computed for each replicate; the interval is Student's t over the replicates'
// slopes. `x` and `errors` have `replicates` rows of `points` values. The result is not known (NAN)
// with fewer than two points, or if an error is not positive.
struct interval curve_slope(const double *x, const double *errors, size_t points,
                            size_t replicates);

// Returns the ratio a / b of the results of two methods with the same `count` seeds: the geometric
// mean of the ratios, with the t interval of their logarithms.
struct interval curve_paired_ratio(const double *a, const double *b, size_t count);

// Returns the x at which a curve reaches the error `target`. Between points the logarithms are
// interpolated linearly; outside of the points the curve continues with the given slope. `x`
// (ascending) and `errors` have `points` values. Returns NAN if the curve does not reach the
// target.
double curve_reach(const double *x, const double *errors, size_t points, double slope,
                   double target);

enum curve_verdict { CURVE_NOT_TOLD_APART, CURVE_BETTER, CURVE_WORSE };
// Judges a ratio of efficiencies by its interval: better if all of it is above 1, worse if all of
// it is below.
enum curve_verdict curve_judge(struct interval ratio);
// Returns the words for people: "faster", "slower" or "no difference was found".
const char *curve_verdict_words(enum curve_verdict verdict);

#endif
