// Pearson's chi-square test of counts against expected counts.
#ifndef LAMPYRIS_TESTS_BSDF_STATISTICS_H
#define LAMPYRIS_TESTS_BSDF_STATISTICS_H

#include <stdint.h>

// Returns P(X >= statistic) for a chi-square variable X with this many degrees of freedom.
double chi_square_tail(double statistic, double degrees);

struct pearson {
    double statistic, p;
    uint32_t degrees;
    uint64_t impossible; // counts in cells where nothing is expected
};

// Neighbouring cells whose expected counts are below 5 are pooled. The sum of the expected counts
// must equal that of the counts.
struct pearson pearson_test(const double *expected, const uint32_t *count, uint32_t cells);

#endif
