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
    struct mutex mutex; // held while a message is written
    enum log_level level;
    log_sink_fn sink;
    void *context;
} log_state = {MUTEX_INIT, LOG_WARN, sink_stderr, NULL};

static _Thread_local const struct log_target *thread_target; // log target of this thread; NULL: the
                                                             // process's sink

const struct log_target *log_redirect(const struct log_target *target)
{
    const struct log_target *former = thread_target;
    thread_target = target;
    return former;
}

const struct log_target *log_redirected(void)
{
    return thread_target;
}

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
    const struct log_target *target = thread_target;
    if (level > (target ? target->level : log_state.level))
        return;
    char message[1024];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    if (length < 0)
        return;
    // Removes control codes, which names and values from files may contain, before a terminal sees
    // them.
    printable_mask(message);
    struct mutex *mutex = target ? target->mutex : &log_state.mutex;
    mutex_lock(mutex);
    if (target)
        target->sink(target->context, level, message);
    else
        log_state.sink(log_state.context, level, message);
    mutex_unlock(mutex);
}
