// A thread for work that must not delay the image: error estimates, files, compiling. Tasks run in
// order; finished ones are taken by the viewer's thread, the only one that may call these
// functions.
#ifndef LAMPYRIS_VIEWER_CORE_WORKER_H
#define LAMPYRIS_VIEWER_CORE_WORKER_H

#include "base/err.h"
#include <stdbool.h>
#include <stdint.h>

struct worker;

struct worker_task {
    const char *name; // "error", "picture", "shaders"
    // Runs on the worker's thread. Returns false with err on failure.
    bool (*run)(void *context, struct err *err);
    // Runs on the viewer's thread, from worker_poll; frees the context. `viewer` is worker_poll's.
    void (*done)(void *context, void *viewer, bool ok, const struct err *err);
    void *context;
};

bool worker_create(struct worker **out, struct err *err);
// Finishes the tasks that are left (an image that is being saved is not lost), and calls their
// `done`.
void worker_destroy(struct worker *worker, void *viewer); // accepts NULL
// Returns false if the list is full (64): the caller keeps the context.
bool worker_add(struct worker *worker, const struct worker_task *task);
// Calls `done` for the finished tasks.
void worker_poll(struct worker *worker, void *viewer);
uint32_t worker_count(const struct worker *worker, const char *name); // waiting or running
bool worker_is_idle(const struct worker *worker);

#endif
