// Messages to the user: on stderr, and in the window.
#ifndef LAMPYRIS_VIEWER_CORE_MESSAGES_H
#define LAMPYRIS_VIEWER_CORE_MESSAGES_H

#include "base/err.h"
#include "base/log.h"

struct viewer;

enum message_kind { MESSAGE_NOTE, MESSAGE_WARNING, MESSAGE_ERROR };

// Between these calls the viewer shows messages of the log up to that level.
void viewer_log_begin(struct viewer *viewer, enum log_level level);
void viewer_log_end(struct viewer *viewer);
void viewer_log_show(struct viewer *viewer); // in the window: messages since the last frame
void viewer_print(const struct viewer *viewer, enum log_level level, const char *text); // to stderr
void viewer_message(struct viewer *viewer, enum message_kind kind, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
double viewer_seconds(const struct viewer *viewer); // since the viewer started

#endif
