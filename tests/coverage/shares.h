#ifndef LAMPYRIS_TESTS_COVERAGE_SHARES_H
#define LAMPYRIS_TESTS_COVERAGE_SHARES_H

#include <stdbool.h>
#include <stdint.h>

// Returns whether the number `held` of successes in `cases` independent events, each of probability
// `p`, is so small that this happens by chance in fewer than one of a thousand sets. With two
// hundred correct sets, one of them fails in a fifth of all runs.
bool share_is_too_small(uint32_t held, uint32_t cases, double p);

#endif
