// Data parallelism on all CPU threads.
#ifndef LAMPYRIS_BASE_PARALLEL_H
#define LAMPYRIS_BASE_PARALLEL_H

#include <stddef.h>

enum { PARALLEL_MAX_THREADS = 256 };

// Returns the number of CPUs that this process may run on, 1 to PARALLEL_MAX_THREADS.
unsigned cpu_count(void);

typedef void (*parallel_fn)(void *context, size_t begin, size_t end, unsigned thread);

// Calls fn over [0, count) in chunks of at most `grain` (0 means 1) and returns when all are done.
// Uses `threads` threads (0 means cpu_count()), including the caller's, at most
// PARALLEL_MAX_THREADS, and fewer when the system cannot start more. `thread` is the index of the
// thread that runs the chunk; the caller's is 0. All signals are blocked in the other threads.
void parallel_for(size_t count, size_t grain, unsigned threads, parallel_fn fn, void *context);

#endif
