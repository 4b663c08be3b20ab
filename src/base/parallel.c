#include "base/parallel.h"

#include "base/log.h"
#include "base/system.h"
#include "base/thread.h"
#include <stdatomic.h>

unsigned cpu_count(void)
{
    const unsigned count = system_processors();
    return count < PARALLEL_MAX_THREADS ? count : PARALLEL_MAX_THREADS;
}

struct loop {
    parallel_fn fn;
    void *context;
    const struct log_target *log; // log target of the calling thread
    size_t count, grain, chunks;
    _Atomic size_t next_chunk;
};

struct worker {
    struct loop *loop;
    unsigned thread;
    struct thread handle;
};

// Takes chunks one by one, so that a slow chunk does not delay the others. The counter exceeds
// `chunks` by at most one per thread.
static void loop_run(struct loop *loop, unsigned thread)
{
    for (;;) {
        size_t chunk = atomic_fetch_add_explicit(&loop->next_chunk, 1, memory_order_relaxed);
        if (chunk >= loop->chunks)
            return;
        size_t begin = chunk * loop->grain;
        size_t end = loop->count - begin < loop->grain ? loop->count : begin + loop->grain;
        loop->fn(loop->context, begin, end, thread);
    }
}

static void worker_main(void *argument)
{
    struct worker *worker = argument;
    log_redirect(worker->loop->log);
    loop_run(worker->loop, worker->thread);
}

// Starts workers 1 … threads - 1 and returns how many started.
static unsigned workers_start(struct worker *workers, unsigned threads, struct loop *loop)
{
    unsigned started = 0;
    while (started + 1 < threads) {
        struct worker *worker = &workers[started];
        *worker = (struct worker){.loop = loop, .thread = started + 1};
        if (thread_start(&worker->handle, worker_main, worker) != 0)
            break;
        started++;
    }
    return started;
}

void parallel_for(size_t count, size_t grain, unsigned threads, parallel_fn fn, void *context)
{
    if (count == 0)
        return;
    grain = grain > 0 ? grain : 1;
    struct loop loop = {.fn = fn, .context = context, .count = count, .grain = grain};
    loop.log = log_redirected();
    loop.chunks = count / grain + (count % grain != 0);
    threads = threads > 0 ? threads : cpu_count();
    threads = threads < PARALLEL_MAX_THREADS ? threads : PARALLEL_MAX_THREADS;
    threads = threads < loop.chunks ? threads : (unsigned)loop.chunks;

    struct worker workers[PARALLEL_MAX_THREADS - 1];
    unsigned started = workers_start(workers, threads, &loop);
    loop_run(&loop, 0);
    for (unsigned i = 0; i < started; i++)
        thread_join(&workers[i].handle);
}
