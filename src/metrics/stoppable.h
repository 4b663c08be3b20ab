// parallel_for that can be asked to stop.
#ifndef LAMPYRIS_METRICS_STOPPABLE_H
#define LAMPYRIS_METRICS_STOPPABLE_H

#include "base/parallel.h"
#include "base/progress.h"
#include <stdbool.h>

// Runs as parallel_for on all processors, but asks `progress`, which may be NULL, before every
// chunk, and begins no more of them once it wants to stop. False then.
bool stoppable_for(size_t count, size_t grain, const struct progress *progress, parallel_fn fn,
                   void *context);

#endif
