// Files that are read again when they change.
#ifndef LAMPYRIS_VIEWER_CORE_WATCH_H
#define LAMPYRIS_VIEWER_CORE_WATCH_H

#include "base/err.h"

struct viewer;
struct watch;

// Begins or ends watching; a message says where it could not begin.
void viewer_watch(struct viewer *viewer, bool on);
bool viewer_watches(const struct viewer *viewer);
bool watch_create(struct viewer *viewer, struct watch **out, struct err *err);
void watch_destroy(struct watch *watch); // accepts NULL
void watch_poll(struct viewer *viewer);  // reloads what has changed and then rested for a moment

#endif
