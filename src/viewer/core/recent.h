// The scenes that were opened last, in a file that outlives the program:
// lampyris/recent.json in $XDG_STATE_HOME or, without it, in ~/.local/state (XDG Base Directory
// Specification, version 0.8).
#ifndef LAMPYRIS_VIEWER_CORE_RECENT_H
#define LAMPYRIS_VIEWER_CORE_RECENT_H

#include "base/err.h"
#include <stdbool.h>
#include <stdint.h>

#define RECENT_MAX 8u
#define RECENT_PATH_MAX 1024u

struct recent {
    char paths[RECENT_MAX][RECENT_PATH_MAX]; // the newest is the first
    uint32_t count;
};

// Reads the list. A missing file is an empty list. Returns false if the file is damaged; the list
// is then empty, and recent_write() will replace the file.
bool recent_read(struct recent *out, struct err *err);
// Adds a path in front. If it is in the list already, it moves to the front.
void recent_add(struct recent *recent, const char *path);
// Writes the list atomically, and creates its folder if necessary. Does nothing if the environment
// names no folder.
bool recent_write(const struct recent *recent, struct err *err);

#endif
