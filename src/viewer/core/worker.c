#include "viewer/core/worker.h"

#include "base/thread.h"
#include <stdlib.h>
#include <string.h>

#define TASKS_MAX 64u

struct entry {
    struct worker_task task;
    bool ok;
    struct err err;
};

// A ring of tasks in this order: finished, running, waiting. The three counters only increase.
struct worker {
    struct thread thread;
    struct mutex mutex;    // protects all members below
    struct condition wake; // signalled when there is a task, or when `is_closing` is set
    struct entry entries[TASKS_MAX];
    uint64_t taken, finished, added;
    bool is_closing;
};

static struct entry *entry_at(struct worker *worker, uint64_t number)
{
    return &worker->entries[number % TASKS_MAX];
}

static void worker_main(void *argument)
{
    struct worker *worker = argument;
    mutex_lock(&worker->mutex);
    for (;;) {
        while (worker->finished == worker->added && !worker->is_closing)
            condition_wait(&worker->wake, &worker->mutex);
        if (worker->finished == worker->added)
            break;
        struct entry *entry = entry_at(worker, worker->finished);
        mutex_unlock(&worker->mutex); // no other thread writes to the entry of a running task
        entry->ok = entry->task.run(entry->task.context, &entry->err);
        mutex_lock(&worker->mutex);
        worker->finished++;
    }
    mutex_unlock(&worker->mutex);
}

bool worker_create(struct worker **out, struct err *err)
{
    *out = NULL;
    struct worker *worker = calloc(1, sizeof *worker);
    if (!worker)
        return err_memory(err, "the worker", sizeof *worker);
    mutex_init(&worker->mutex);
    condition_init(&worker->wake);
    int result = thread_start(&worker->thread, worker_main, worker);
    if (result != 0) {
        condition_finish(&worker->wake);
        mutex_finish(&worker->mutex);
        free(worker);
        return err_set(err, ERR_SYSTEM, "cannot start a thread: %s", strerror(result));
    }
    *out = worker;
    return true;
}

void worker_destroy(struct worker *worker, void *viewer)
{
    if (!worker)
        return;
    mutex_lock(&worker->mutex);
    worker->is_closing = true;
    condition_wake_one(&worker->wake);
    mutex_unlock(&worker->mutex);
    thread_join(&worker->thread);
    worker_poll(worker, viewer);
    condition_finish(&worker->wake);
    mutex_finish(&worker->mutex);
    free(worker);
}

bool worker_add(struct worker *worker, const struct worker_task *task)
{
    mutex_lock(&worker->mutex);
    bool is_taken = worker->added - worker->taken < TASKS_MAX && !worker->is_closing;
    if (is_taken) {
        *entry_at(worker, worker->added++) = (struct entry){.task = *task};
        condition_wake_one(&worker->wake);
    }
    mutex_unlock(&worker->mutex);
    return is_taken;
}

// Takes a finished task out of the ring first, so that its `done` may add a task.
static bool take_finished(struct worker *worker, struct entry *out)
{
    mutex_lock(&worker->mutex);
    bool is_some = worker->taken < worker->finished;
    if (is_some)
        *out = *entry_at(worker, worker->taken++);
    mutex_unlock(&worker->mutex);
    return is_some;
}

void worker_poll(struct worker *worker, void *viewer)
{
    struct entry entry;
    while (take_finished(worker, &entry))
        entry.task.done(entry.task.context, viewer, entry.ok, &entry.err);
}

uint32_t worker_count(const struct worker *worker, const char *name)
{
    struct worker *w = (struct worker *)worker; // only the mutex is changed
    uint32_t count = 0;
    mutex_lock(&w->mutex);
    for (uint64_t i = w->finished; i < w->added; i++)
        count += strcmp(entry_at(w, i)->task.name, name) == 0;
    mutex_unlock(&w->mutex);
    return count;
}

bool worker_is_idle(const struct worker *worker)
{
    struct worker *w = (struct worker *)worker; // only the mutex is changed
    mutex_lock(&w->mutex);
    bool is_idle = w->taken == w->added;
    mutex_unlock(&w->mutex);
    return is_idle;
}
