// Runs that a clock ends.
#ifndef LAMPYRIS_JOB_TIMED_STEP_H
#define LAMPYRIS_JOB_TIMED_STEP_H

#include <stdint.h>

// How many samples, or rounds, to take next when `done` of them took `elapsed` seconds; 0 when
// `limit` seconds are over. Steps grow to `most` while they are short against the time left, so
// that the end is within one of the limit.
static inline uint64_t timed_step(double limit, double elapsed, uint64_t done, uint64_t most)
{
    if (done == 0)
        return 1;
    double fits = (limit - elapsed) * (double)done / elapsed;
    if (fits < 1.0)
        return 0;
    // Half of what is left: the estimate is a noisy one.
    return fits < 2.0 * (double)most ? (uint64_t)(0.5 * fits) + 1 : most;
}

#endif
