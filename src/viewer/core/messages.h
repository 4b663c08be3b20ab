// Messages to people: on stderr, and in the window.
#ifndef LAMPYRIS_VIEWER_CORE_MESSAGES_H
#define LAMPYRIS_VIEWER_CORE_MESSAGES_H

#include "base/err.h"
#include "base/log.h"

struct viewer;

enum message_kind { MESSAGE_NOTE, MESSAGE_WARNING, MESSAGE_ERROR };

// From here on what the log says, up to that level, is told by the viewer; and no more.
void viewer_log_begin(struct viewer *viewer, enum log_level level);
void viewer_log_end(struct viewer *viewer);
void viewer_log_show(struct viewer *viewer); // in the window: what has come since the last frame
void viewer_print(const struct viewer *viewer, enum log_level level, const char *text); // to stderr
void viewer_message(struct viewer *viewer, enum message_kind kind, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
double viewer_seconds(const struct viewer *viewer); // since it began

#endif
