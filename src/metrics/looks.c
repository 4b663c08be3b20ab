// Schedules the interim tests of a render with an error limit.
//
// With N samples the error decreases at least as 1 / N, and at most as N^(-3/2), the rate of
// stratified sampling where edges cross pixels (Mitchell 1996, "Consequences of Stratified Sampling
// in Graphics"). The next test is at the number of samples at which the faster rate would bring the
// bound down to the limit, because a test too early costs less than unnecessary samples. Few tests
// are needed: each leaves at most a third of the distance to the limit, in logarithms. Successive
// tests are at least a sixteenth of the samples apart, which limits the unnecessary samples to that
// fraction.
#include "metrics/metrics.h"

#include <math.h>

static const uint64_t part_apart = 16;

// Rounds up to a multiple of `unit`.
static uint64_t round_up(uint64_t samples, uint64_t unit)
{
    return (samples + unit - 1) / unit * unit;
}

uint64_t looks_first(uint64_t done, uint64_t unit)
{
    return round_up(done > LOOKS_FIRST ? done : LOOKS_FIRST, unit);
}

uint64_t looks_next(uint64_t done, double excess, uint64_t unit)
{
    double wanted = (double)done * cbrt(excess * excess);
    uint64_t least = done + (done + part_apart - 1) / part_apart, most = 2 * done;
    uint64_t next = wanted < (double)most ? (uint64_t)ceil(wanted) : most;
    return round_up(next > least ? next : least, unit);
}
