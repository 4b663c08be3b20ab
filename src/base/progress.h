// How long-running work reports where it is. The library calls; cli/progress_bar.c draws the bar.
#ifndef LAMPYRIS_BASE_PROGRESS_H
#define LAMPYRIS_BASE_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct progress {
    // phase: "Loading", "Building BVH", "Compiling", "Rendering"; fraction of it that is done, in
    // [0, 1], and as even in time as can be: what time is left is found from it. 0 as long as it is
    // not known. May be called from the thread that called the long-running function only. NULL:
    // nobody listens.
    void (*report)(void *context, const char *phase, double fraction);
    // Polled now and then, from any thread; true asks the work to stop early, and stays true until
    // it has. NULL: never.
    bool (*should_stop)(void *context);
    void *context;
    // Called before results are printed: what was shown of the progress is not to stand between
    // them. NULL: nothing is shown.
    void (*end)(void *context);
    // Called before a line of results is printed while the work goes on. NULL: nothing is shown.
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

// For loops over counts that come from files, at turn `i`: whether to stop. Looks at every 65536th
// turn alone, which costs nothing measurable beside a turn's work.
static inline bool progress_stops_at(const struct progress *progress, uint64_t i)
{
    return i % 65536 == 0 && progress_should_stop(progress);
}

#endif
