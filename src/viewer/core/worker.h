// A thread for work that must not delay the image: error estimates, files, compilation. It runs
// tasks in order. Only the viewer's thread may call these functions; it also finishes the tasks.
#ifndef LAMPYRIS_VIEWER_CORE_WORKER_H
#define LAMPYRIS_VIEWER_CORE_WORKER_H

#include "base/err.h"
#include <stdbool.h>
#include <stdint.h>

struct worker;

struct worker_task {
    const char *name; // "error", "picture", "shaders"
    // Called on the worker's thread. Returns false and sets err on failure.
    bool (*run)(void *context, struct err *err);
    // Called on the viewer's thread by worker_poll(); frees the context. `viewer` is the argument
    // of worker_poll().
    void (*done)(void *context, void *viewer, bool ok, const struct err *err);
    void *context;
};

bool worker_create(struct worker **out, struct err *err);
// Runs all remaining tasks, so that an image that is being saved is not lost, and calls their
// `done`.
void worker_destroy(struct worker *worker, void *viewer); // accepts NULL
// Adds a task. Returns false if the list (64 tasks) is full; the caller then keeps the context.
bool worker_add(struct worker *worker, const struct worker_task *task);
// Calls `done` for the finished tasks.
void worker_poll(struct worker *worker, void *viewer);
// Returns the number of tasks with this name that wait or run.
uint32_t worker_count(const struct worker *worker, const char *name);
bool worker_is_idle(const struct worker *worker);

#endif
