// Files that are read again when they change.
#ifndef LAMPYRIS_VIEWER_CORE_WATCH_H
#define LAMPYRIS_VIEWER_CORE_WATCH_H

#include "base/err.h"

struct viewer;
struct watch;

bool watch_create(struct viewer *viewer, struct watch **out, struct err *err);
void watch_destroy(struct watch *watch); // accepts NULL
void watch_poll(struct viewer *viewer);  // reloads what has changed and then rested for a moment

#endif
