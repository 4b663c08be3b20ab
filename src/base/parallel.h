// Data parallelism on all CPU threads.
#ifndef LAMPYRIS_BASE_PARALLEL_H
#define LAMPYRIS_BASE_PARALLEL_H

#include <stddef.h>

// The number of CPUs this process may run on, at least 1.
unsigned cpu_count(void);

typedef void (*parallel_fn)(void *context, size_t begin, size_t end, unsigned thread);

// Calls fn over [0, count) in chunks of at most `grain`, on `threads` threads (0: cpu_count), the
// caller's included; returns when all is done. Falls back to fewer threads when the system gives no
// more. `thread` is below the number of threads in use.
void parallel_for(size_t count, size_t grain, unsigned threads, parallel_fn fn, void *context);

#endif
