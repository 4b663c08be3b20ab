#ifndef LAMPYRIS_BASE_CLOCK_H
#define LAMPYRIS_BASE_CLOCK_H

#include <stdint.h>

// Monotonic time in nanoseconds.
uint64_t clock_ns(void);
// Seconds since `start_ns`.
double clock_seconds_since(uint64_t start_ns);

#endif
