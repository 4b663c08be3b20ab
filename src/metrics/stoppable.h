// A parallel_for that can be stopped.
#ifndef LAMPYRIS_METRICS_STOPPABLE_H
#define LAMPYRIS_METRICS_STOPPABLE_H

#include "base/parallel.h"
#include "base/progress.h"
#include <stdbool.h>

// Like parallel_for on all processors, but asks `progress` (which may be NULL) before every chunk,
// and begins no further chunk after a stop request. Returns false in that case.
bool stoppable_for(size_t count, size_t grain, const struct progress *progress, parallel_fn fn,
                   void *context);

#endif
