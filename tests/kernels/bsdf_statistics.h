// Pearson's test of counts against expected counts.
#ifndef LAMPYRIS_TESTS_BSDF_STATISTICS_H
#define LAMPYRIS_TESTS_BSDF_STATISTICS_H

#include <stdint.h>

// P(X >= statistic) for X of chi-square with so many degrees of freedom.
double chi_square_tail(double statistic, double degrees);

struct pearson {
    double statistic, p;
    uint32_t degrees;
    uint64_t impossible; // counted where nothing is expected
};

// Neighbouring cells that expect fewer than 5 are pooled until they do. The expected counts must
// sum to the counts' sum.
struct pearson pearson_test(const double *expected, const uint32_t *count, uint32_t cells);

#endif
