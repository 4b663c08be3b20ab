// How long-running work reports where it is. The library calls; app/ draws the bar.
#ifndef LAMPYRIS_BASE_PROGRESS_H
#define LAMPYRIS_BASE_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>

struct progress {
    // phase: "Loading", "Building BVH", "Rendering"; fraction in [0, 1]. May be called from the
    // thread that called the long-running function only. NULL: nobody listens.
    void (*report)(void *context, const char *phase, double fraction);
    // Polled now and then; true asks the work to stop early. NULL: never.
    bool (*should_stop)(void *context);
    void *context;
};

static inline void progress_report(const struct progress *progress, const char *phase,
                                   double fraction)
{
    if (progress && progress->report)
        progress->report(progress->context, phase, fraction);
}

static inline bool progress_should_stop(const struct progress *progress)
{
    return progress && progress->should_stop && progress->should_stop(progress->context);
}

#endif
