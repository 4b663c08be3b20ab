// Messages to the user, on stderr and in the window.
#ifndef LAMPYRIS_VIEWER_CORE_MESSAGES_H
#define LAMPYRIS_VIEWER_CORE_MESSAGES_H

#include "base/err.h"
#include "base/log.h"

struct viewer;

enum message_kind { MESSAGE_NOTE, MESSAGE_WARNING, MESSAGE_ERROR };

// Between these two calls, the viewer shows messages of the log up to the given level.
void viewer_log_begin(struct viewer *viewer, enum log_level level);
void viewer_log_end(struct viewer *viewer);
// Shows the log's messages since the last frame in the window.
void viewer_log_show(struct viewer *viewer);
// Prints to stderr.
void viewer_print(const struct viewer *viewer, enum log_level level, const char *text);
void viewer_message(struct viewer *viewer, enum message_kind kind, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
double viewer_seconds(const struct viewer *viewer); // seconds since the viewer started

#endif
