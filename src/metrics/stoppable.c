#include "metrics/stoppable.h"

struct stoppable {
    const struct progress *progress;
    parallel_fn fn;
    void *context;
};

static void run_chunk(void *context, size_t begin, size_t end, unsigned thread)
{
    const struct stoppable *s = context;
    if (!progress_should_stop(s->progress))
        s->fn(s->context, begin, end, thread);
}

bool stoppable_for(size_t count, size_t grain, const struct progress *progress, parallel_fn fn,
                   void *context)
{
    struct stoppable s = {progress, fn, context};
    parallel_for(count, grain, 0, run_chunk, &s);
    // A stop request persists, so this call notices it even if chunks were skipped because of it.
    return !progress_should_stop(progress);
}
