// Alias tables: choosing one of n in proportion to weights with one random number.
#ifndef LAMPYRIS_RENDER_TABLES_ALIAS_TABLE_H
#define LAMPYRIS_RENDER_TABLES_ALIAS_TABLE_H

#include "base/arena.h"
#include <stdbool.h>
#include <stdint.h>

struct alias_bin {
    float threshold; // uniform numbers below it choose the bin itself, others its alias
    uint32_t alias;
};

// Fills bins[count] (count >= 1) from non-negative weights whose sum is positive and finite. Uses
// `scratch`; false when out of memory. Vose 1991, "A linear algorithm for generating random numbers
// with a given distribution".
bool alias_table_build(const double *weights, uint32_t count, struct arena *scratch,
                       struct alias_bin *bins);

#endif
