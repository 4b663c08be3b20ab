// Statistics of repeated timings, which are positive, skewed, and now and then far too long. Plain
// arrays in, numbers out; any thread may call.
#ifndef LAMPYRIS_METRICS_SPREAD_H
#define LAMPYRIS_METRICS_SPREAD_H

#include "metrics/curve.h"

// The median, with the order statistics between which it lies in at least 95 % of cases whatever
// the values' distribution (David and Nagaraja 2003, Order Statistics, equation 7.1.2): the ends
// are not known with fewer than six values. None is known where one of them is not finite. False
// only when out of memory.
bool spread_median(const double *values, size_t count, struct interval *out);

// The ratio of two independent sets of positive values, by the means of their logarithms, with
// Welch's (1947) interval at this confidence. Not known with fewer than two values in either, or
// with one that is not positive.
struct spread_set {
    const double *values;
    size_t count;
};
struct interval spread_ratio(struct spread_set numerator, struct spread_set denominator,
                             double confidence);

#endif
