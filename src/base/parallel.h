// Data parallelism on all CPU threads.
#ifndef LAMPYRIS_BASE_PARALLEL_H
#define LAMPYRIS_BASE_PARALLEL_H

#include <stddef.h>

enum { PARALLEL_MAX_THREADS = 256 };

// The number of CPUs this process may run on, 1 to PARALLEL_MAX_THREADS.
unsigned cpu_count(void);

typedef void (*parallel_fn)(void *context, size_t begin, size_t end, unsigned thread);

// Calls fn over [0, count) in chunks of at most `grain`, on `threads` threads (0: cpu_count), the
// caller's included; returns when all is done. Falls back to fewer threads when the system gives no
// more. `thread` is below the number of threads in use; the caller's is 0. A grain of 0 counts
// as 1. At most PARALLEL_MAX_THREADS take part. The library's threads leave signals to the
// caller's.
void parallel_for(size_t count, size_t grain, unsigned threads, parallel_fn fn, void *context);

#endif
