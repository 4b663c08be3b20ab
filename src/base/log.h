// Warnings and notes for people. The process has one sink, set once by the program; a thread may
// have another, for the user of a library who shares the process with others.
#ifndef LAMPYRIS_BASE_LOG_H
#define LAMPYRIS_BASE_LOG_H

enum log_level { LOG_ERROR, LOG_WARN, LOG_INFO, LOG_DEBUG };

typedef void (*log_sink_fn)(void *context, enum log_level level, const char *message);

// Sends messages up to and including `level` to the sink; NULL restores stderr. Not thread-safe:
// call it before threads start. The default is stderr with LOG_WARN.
void log_configure(enum log_level level, log_sink_fn sink, void *context);

// Changes only the level and returns the former one. Not thread-safe.
enum log_level log_set_level(enum log_level level);

// A sink with its level, see log_configure(), and the mutex by which its threads take turns: a sink
// of one target may call what logs to another.
struct mutex;
struct log_target {
    enum log_level level;
    log_sink_fn sink;
    void *context;
    struct mutex *mutex; // the caller's
};

// From now on this thread's messages, and those of the threads that parallel_for() starts for it,
// go to *target, which must stay valid; NULL: to the process's sink. Returns the target so far.
const struct log_target *log_redirect(const struct log_target *target);
const struct log_target *log_redirected(void); // this thread's target, or NULL

// One line without a newline. Thread-safe.
void log_message(enum log_level level, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#define log_warn(...) log_message(LOG_WARN, __VA_ARGS__)
#define log_info(...) log_message(LOG_INFO, __VA_ARGS__)

#endif
