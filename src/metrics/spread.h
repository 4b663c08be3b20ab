// Statistics of repeated timings, which are positive and skewed, and some of which are far too
// long. The functions work on plain arrays; any thread may call them.
#ifndef LAMPYRIS_METRICS_SPREAD_H
#define LAMPYRIS_METRICS_SPREAD_H

#include "metrics/curve.h"

// Computes the median, with the order statistics that enclose it with a probability of at least 95
// % for any distribution (David and Nagaraja 2003, "Order Statistics", equation 7.1.2). With fewer
// than six values the interval is not known (NAN); if a value is not finite, nothing is. Returns
// false only when out of memory.
bool spread_median(const double *values, size_t count, struct interval *out);

// A set of independent, positive values. spread_ratio() returns the ratio of the geometric means of
// two sets, with Welch's interval (1947) of the logarithms at the given confidence. The result is
// not known (NAN) if a set has fewer than two values or one that is not positive.
struct spread_set {
    const double *values;
    size_t count;
};
struct interval spread_ratio(struct spread_set numerator, struct spread_set denominator,
                             double confidence);

#endif
