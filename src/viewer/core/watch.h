// Reloads files when they change.
#ifndef LAMPYRIS_VIEWER_CORE_WATCH_H
#define LAMPYRIS_VIEWER_CORE_WATCH_H

#include "base/err.h"

struct viewer;
struct watch;

// Starts or stops watching. If that fails, the viewer shows a message.
void viewer_watch(struct viewer *viewer, bool on);
bool viewer_watches(const struct viewer *viewer);
bool watch_create(struct viewer *viewer, struct watch **out, struct err *err);
void watch_destroy(struct watch *watch); // accepts NULL
// Reloads files that have changed and have then been unchanged for a moment.
void watch_poll(struct viewer *viewer);

#endif
