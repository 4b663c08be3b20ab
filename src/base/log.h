// Warnings and notes for people. The process has one sink, which the program sets once. A thread
// may have its own sink, because a process may contain several users of the library.
#ifndef LAMPYRIS_BASE_LOG_H
#define LAMPYRIS_BASE_LOG_H

enum log_level { LOG_ERROR, LOG_WARN, LOG_INFO, LOG_DEBUG };

typedef void (*log_sink_fn)(void *context, enum log_level level, const char *message);

// Sends messages up to and including `level` to the sink; NULL restores stderr. Not thread-safe:
// call it before threads start. The default is stderr with LOG_WARN.
void log_configure(enum log_level level, log_sink_fn sink, void *context);

// Changes only the level and returns the former one. Not thread-safe.
enum log_level log_set_level(enum log_level level);

// A sink with its level (see log_configure()) and the mutex that its threads hold while they write.
// Each target has its own mutex, because a sink may call code that logs to another target.
struct mutex;
struct log_target {
    enum log_level level;
    log_sink_fn sink;
    void *context;
    struct mutex *mutex; // owned by the caller
};

// Redirects the messages of this thread, and of the threads that parallel_for() starts for it, to
// *target, which must stay valid. NULL restores the process's sink. Returns the previous target.
const struct log_target *log_redirect(const struct log_target *target);
const struct log_target *log_redirected(void); // this thread's target, or NULL

// Logs a message of one line, without a newline. Thread-safe.
void log_message(enum log_level level, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#define log_warn(...) log_message(LOG_WARN, __VA_ARGS__)
#define log_info(...) log_message(LOG_INFO, __VA_ARGS__)

#endif
