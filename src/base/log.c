#include "base/log.h"

#include "base/printable.h"
#include "base/thread.h"
#include <stdarg.h>
#include <stdio.h>

static void sink_stderr(void *context, enum log_level level, const char *message)
{
    (void)context;
    static const char *const names[] = {"error", "warning", "note", "debug"};
    fprintf(stderr, "%s: %s\n", names[level], message);
}

static struct {
    struct mutex mutex; // one message at a time
    enum log_level level;
    log_sink_fn sink;
    void *context;
} log_state = {MUTEX_INIT, LOG_WARN, sink_stderr, NULL};

void log_configure(enum log_level level, log_sink_fn sink, void *context)
{
    log_state.level = level;
    log_state.sink = sink ? sink : sink_stderr;
    log_state.context = context;
}

enum log_level log_set_level(enum log_level level)
{
    enum log_level former = log_state.level;
    log_state.level = level;
    return former;
}

void log_message(enum log_level level, const char *format, ...)
{
    if (level > log_state.level)
        return;
    char message[1024];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    if (length < 0)
        return;
    // Names and values from files must not send control codes to a terminal.
    printable_mask(message);
    mutex_lock(&log_state.mutex);
    log_state.sink(log_state.context, level, message);
    mutex_unlock(&log_state.mutex);
}
