// Builds alias tables, which choose one of n bins in proportion to weights, by one random number.
#ifndef LAMPYRIS_RENDER_TABLES_ALIAS_TABLE_H
#define LAMPYRIS_RENDER_TABLES_ALIAS_TABLE_H

#include "base/arena.h"
#include <stdbool.h>
#include <stdint.h>

struct alias_bin {
    float threshold; // uniform numbers below the threshold select the bin, others its alias
    uint32_t alias;
};

// Fills bins[count] from non-negative weights whose sum is positive and finite; count is at least
// 1. Uses memory of `scratch`; returns false when out of memory. Vose 1991, "A linear algorithm for
// generating random numbers with a given distribution".
bool alias_table_build(const double *weights, uint32_t count, struct arena *scratch,
                       struct alias_bin *bins);

#endif
