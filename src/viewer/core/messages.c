// Shows messages of the viewer and of the log, on stderr and in the window.
#include "viewer/core/messages.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/printable.h"
#include "viewer/core/viewer.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

double viewer_seconds(const struct viewer *viewer)
{
    return clock_seconds_since(viewer->shell.start_ns);
}

void viewer_print(const struct viewer *viewer, enum log_level level, const char *text)
{
    static const char *const names[] = {"error", "warning", "note", "debug"};
    if (level <= viewer->shell.log.level)
        fprintf(stderr, "lampyris-view: %s: %s\n", names[level], text);
}

static void set_message(struct viewer *viewer, enum message_kind kind, const char *text)
{
    viewer->shell.message_kind = kind;
    snprintf(viewer->shell.message, sizeof viewer->shell.message, "%s", text);
    viewer->shell.message_seconds = viewer_seconds(viewer);
}

void viewer_message(struct viewer *viewer, enum message_kind kind, const char *format, ...)
{
    static const enum log_level levels[] = {LOG_INFO, LOG_WARN, LOG_ERROR};
    char text[sizeof viewer->shell.message];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    printable_mask(text); // names from files must not send control codes to a terminal
    set_message(viewer, kind, text);
    viewer_print(viewer, levels[kind], text);
}

// Receives a line of the log; any thread may call it. A renderer may repeat a warning after every
// change, but it is shown only once.
static void take_log(void *context, enum log_level level, const char *text)
{
    struct viewer *viewer = context;
    struct viewer_log *log = &viewer->shell.log;
    mutex_lock(&log->mutex);
    if (strcmp(log->last, text) != 0) {
        viewer_print(viewer, level, text);
        snprintf(log->last, sizeof log->last, "%s", text);
        log->last_level = level;
        log->is_new = level <= LOG_WARN;
    }
    mutex_unlock(&log->mutex);
}

void viewer_log_show(struct viewer *viewer)
{
    struct viewer_log *log = &viewer->shell.log;
    mutex_lock(&log->mutex);
    if (log->is_new)
        set_message(viewer, log->last_level == LOG_ERROR ? MESSAGE_ERROR : MESSAGE_WARNING,
                    log->last);
    log->is_new = false;
    mutex_unlock(&log->mutex);
}

void viewer_log_begin(struct viewer *viewer, enum log_level level)
{
    mutex_init(&viewer->shell.log.mutex);
    viewer->shell.log.level = level;
    log_configure(level > LOG_WARN ? level : LOG_WARN, take_log, viewer);
}

void viewer_log_end(struct viewer *viewer)
{
    log_configure(viewer->shell.log.level, NULL, NULL);
    mutex_finish(&viewer->shell.log.mutex);
}
