// Threads, mutexes and conditions. All of them live in the caller's memory and must not be moved
// while they are in use.
#ifndef LAMPYRIS_BASE_THREAD_H
#define LAMPYRIS_BASE_THREAD_H

#include <stdbool.h>
#include <stdint.h>

#ifdef _WIN32
struct mutex {
    void *lock; // an SRWLOCK
};
struct condition {
    void *variable; // a CONDITION_VARIABLE
};
typedef void *thread_handle;
#define MUTEX_INIT                                                                                 \
    {                                                                                              \
        0                                                                                          \
    }
#else
#include <pthread.h>
struct mutex {
    pthread_mutex_t lock;
};
struct condition {
    pthread_cond_t variable;
};
typedef pthread_t thread_handle;
#define MUTEX_INIT                                                                                 \
    {                                                                                              \
        PTHREAD_MUTEX_INITIALIZER                                                                  \
    }
#endif

// Initialisation cannot fail on the supported systems.
void mutex_init(struct mutex *mutex); // equivalent to MUTEX_INIT
void mutex_finish(struct mutex *mutex);
void mutex_lock(struct mutex *mutex);
void mutex_unlock(struct mutex *mutex);

void condition_init(struct condition *condition);
void condition_finish(struct condition *condition);
// Both functions unlock the mutex while they wait, and may return spuriously.
void condition_wait(struct condition *condition, struct mutex *mutex);
// Waits until a time of clock_ns(); returns false when that time has come.
bool condition_wait_until(struct condition *condition, struct mutex *mutex, uint64_t deadline_ns);
void condition_wake_one(struct condition *condition);
void condition_wake_all(struct condition *condition);

typedef void (*thread_fn)(void *context);

struct thread {
    thread_handle handle;
    thread_fn fn;
    void *context;
};

// Starts a thread in which all signals are blocked, so that their handlers run in one of the
// caller's threads. Returns 0 or a value of errno.
int thread_start(struct thread *thread, thread_fn fn, void *context);
void thread_join(struct thread *thread);
// Lets the thread end by itself; its struct must stay in memory until the process ends.
void thread_detach(struct thread *thread);

#endif
