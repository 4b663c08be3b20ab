// Error against samples and time, from replicates: independent runs of the same method with other
// seeds. Plain arrays in, numbers out; any thread may call.
#ifndef LAMPYRIS_METRICS_CURVE_H
#define LAMPYRIS_METRICS_CURVE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// A number with its 95 % interval. NAN if not known; with a single value, the interval is not
// known.
struct interval {
    double value, low, high;
};

// Returns the mean of values in [0, 1], or in decibels, with Student's t interval. Not known if one
// of them is not finite.
struct interval curve_mean(const double *values, size_t count);

// Returns the geometric mean of positive values that vary by factors, such as errors, with
// Student's t interval of the logarithms. Not known if one of them is not positive.
struct interval curve_geometric_mean(const double *values, size_t count);

// Estimates how an error falls off: the exponent of x in errors[r][i] ~ x[r][i]^slope. One
// least-squares line through the logarithms for each replicate, whose points share their samples
// and are no independent ones; then Student's t interval over the replicates. `x`, `errors`:
// `replicates` rows of `points`. Not known with fewer than two points, or with an error that is not
// positive.
struct interval curve_slope(const double *x, const double *errors, size_t points,
                            size_t replicates);

// Returns the ratio a / b of two methods' results with the same seeds, by the mean of the
// logarithms of the `count` ratios and its t interval.
struct interval curve_paired_ratio(const double *a, const double *b, size_t count);

// Returns where a curve reaches `target`: between its points by linear interpolation in logarithms;
// before and beyond them with the given slope. `x`, `errors`: `points` of each, x ascending. NAN if
// the slope does not lead there.
double curve_reach(const double *x, const double *errors, size_t points, double slope,
                   double target);

enum curve_verdict { CURVE_NOT_TOLD_APART, CURVE_BETTER, CURVE_WORSE };
// Judges a ratio of efficiencies: better if the whole interval is above 1.
enum curve_verdict curve_judge(struct interval ratio);

#endif
