// Progress reports of long-running work. Functions that take long call the functions below;
// cli/progress_bar.c draws the bar.
#ifndef LAMPYRIS_BASE_PROGRESS_H
#define LAMPYRIS_BASE_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct progress {
    // Reports a phase, such as "Loading" or "Rendering", and the part of it that is done, in [0,
    // 1]. The part is 0 while it is not known. It should be proportional to time, because the
    // remaining time is extrapolated from it. Called only by the thread that called the
    // long-running function. NULL: no listener.
    void (*report)(void *context, const char *phase, double fraction);
    // Polled regularly, by any thread. Returning true stops the work early; it must keep returning
    // true until the work has stopped. NULL: never.
    bool (*should_stop)(void *context);
    void *context;
    // Called before results are printed, so that the progress display does not interfere. NULL:
    // nothing is displayed.
    void (*end)(void *context);
    // Called before a line of results is printed while the work continues. NULL: nothing is
    // displayed.
    void (*pause)(void *context);
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

static inline void progress_end(const struct progress *progress)
{
    if (progress && progress->end)
        progress->end(progress->context);
}

static inline void progress_pause(const struct progress *progress)
{
    if (progress && progress->pause)
        progress->pause(progress->context);
}

// Returns whether a loop is to stop at iteration `i`; for loops whose count comes from a file.
// Polls only every 65536th iteration, so the cost is negligible.
static inline bool progress_stops_at(const struct progress *progress, uint64_t i)
{
    return i % 65536 == 0 && progress_should_stop(progress);
}

#endif
