// One thread for what must not hold up the picture: errors, files, compiling. Tasks run in the
// order they came; finished ones are taken by the viewer's thread, which alone calls these
// functions.
#ifndef LAMPYRIS_VIEWER_CORE_WORKER_H
#define LAMPYRIS_VIEWER_CORE_WORKER_H

#include "base/err.h"
#include <stdbool.h>
#include <stdint.h>

struct worker;

struct worker_task {
    const char *name; // "error", "picture", "shaders"
    // On the worker's thread. False: err says why.
    bool (*run)(void *context, struct err *err);
    // On the viewer's thread, from worker_poll; frees the context. `viewer` is worker_poll's.
    void (*done)(void *context, void *viewer, bool ok, const struct err *err);
    void *context;
};

bool worker_create(struct worker **out, struct err *err);
// Waits for the tasks that are left (a picture that is being saved is not lost), with their `done`.
void worker_destroy(struct worker *worker, void *viewer); // accepts NULL
// False where the list is full (64): the task is not taken, and its context stays the caller's.
bool worker_add(struct worker *worker, const struct worker_task *task);
// Calls `done` of what has ended.
void worker_poll(struct worker *worker, void *viewer);
uint32_t worker_count(const struct worker *worker, const char *name); // waiting or running
bool worker_is_idle(const struct worker *worker);

#endif
