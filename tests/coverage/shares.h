#ifndef LAMPYRIS_TESTS_COVERAGE_SHARES_H
#define LAMPYRIS_TESTS_COVERAGE_SHARES_H

#include <stdbool.h>
#include <stdint.h>

// Returns whether so few of `cases` independent ones, with the chance `p` each, hold by chance in
// fewer than one of a thousand sets of them. Of two hundred that are right, one fails in a fifth of
// all runs.
bool share_is_too_small(uint32_t held, uint32_t cases, double p);

#endif
