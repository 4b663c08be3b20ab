// When a render that is to reach an error looks at it.
//
// The error falls at least as 1 / N with N samples, and at most as N^(-3/2): that is what
// stratification brings where edges cross pixels (Mitchell 1996, "Consequences of Stratified
// Sampling in Graphics"). The next look is where the faster of the two would bring the bound to the
// limit: rather a look too early than samples that nobody asked for. Few looks are needed: each
// leaves at most a third of the way, as the logarithm goes, and none is nearer to the one before
// than a sixteenth of its samples, which is what a render may go on for longer than it needs.
#include "metrics/metrics.h"

#include <math.h>

static const uint64_t part_apart = 16;

// The next multiple of `unit` that is no less.
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
