#include "metrics.h"

uint32_t looks_within(uint64_t bound)
{
    uint32_t looks = 0;
    for (uint64_t done = 0; done < bound; looks++)
        done = looks_next(done, bound);
    return looks;
}

uint64_t looks_next(uint64_t done, uint64_t bound)
{
    uint64_t next = LOOKS_FIRST;
    while (next <= done)
        next *= 2;
    return next < bound ? next : bound;
}

double looks_confidence(uint32_t looks)
{
    return 1 - 0.05 / looks;
}
