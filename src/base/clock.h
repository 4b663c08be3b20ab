#ifndef LAMPYRIS_BASE_CLOCK_H
#define LAMPYRIS_BASE_CLOCK_H

#include <stdint.h>

// Returns monotonic time in nanoseconds.
uint64_t clock_ns(void);
// Returns nanoseconds since 1970 by the system's clock, which users may set. The times of files are
// from the same clock.
uint64_t clock_wall_ns(void);
// Waits for the duration, or until a signal arrives.
void clock_sleep(double seconds);

// Returns the seconds since `start_ns`, a time of clock_ns().
static inline double clock_seconds_since(uint64_t start_ns)
{
    return (double)(clock_ns() - start_ns) * 1e-9;
}

#endif
