#include "base/thread.h"

#include "base/clock.h"

#include <signal.h>
#include <time.h>

#define SECOND_NS UINT64_C(1000000000)

void mutex_init(struct mutex *mutex)
{
    pthread_mutex_init(&mutex->lock, NULL);
}

void mutex_finish(struct mutex *mutex)
{
    pthread_mutex_destroy(&mutex->lock);
}

void mutex_lock(struct mutex *mutex)
{
    pthread_mutex_lock(&mutex->lock);
}

void mutex_unlock(struct mutex *mutex)
{
    pthread_mutex_unlock(&mutex->lock);
}

// Deadlines are times of the monotonic clock. macOS has no condition variables on that clock, but
// can wait for a duration.
void condition_init(struct condition *condition)
{
#ifdef __APPLE__
    pthread_cond_init(&condition->variable, NULL);
#else
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(&condition->variable, &attributes);
    pthread_condattr_destroy(&attributes);
#endif
}

void condition_finish(struct condition *condition)
{
    pthread_cond_destroy(&condition->variable);
}

void condition_wait(struct condition *condition, struct mutex *mutex)
{
    pthread_cond_wait(&condition->variable, &mutex->lock);
}

static struct timespec timespec_of(uint64_t ns)
{
    return (struct timespec){.tv_sec = (time_t)(ns / SECOND_NS), .tv_nsec = (long)(ns % SECOND_NS)};
}

bool condition_wait_until(struct condition *condition, struct mutex *mutex, uint64_t deadline_ns)
{
#ifdef __APPLE__
    const uint64_t now_ns = clock_ns();
    const struct timespec left = timespec_of(deadline_ns > now_ns ? deadline_ns - now_ns : 0);
    return pthread_cond_timedwait_relative_np(&condition->variable, &mutex->lock, &left) == 0;
#else
    const struct timespec deadline = timespec_of(deadline_ns);
    return pthread_cond_timedwait(&condition->variable, &mutex->lock, &deadline) == 0;
#endif
}

void condition_wake_one(struct condition *condition)
{
    pthread_cond_signal(&condition->variable);
}

void condition_wake_all(struct condition *condition)
{
    pthread_cond_broadcast(&condition->variable);
}

static void *thread_main(void *argument)
{
    const struct thread *thread = argument;
    thread->fn(thread->context);
    return NULL;
}

int thread_start(struct thread *thread, thread_fn fn, void *context)
{
    sigset_t all, previous;
    sigfillset(&all);
    thread->fn = fn;
    thread->context = context;
    pthread_sigmask(SIG_SETMASK, &all, &previous);
    int result = pthread_create(&thread->handle, NULL, thread_main, thread);
    pthread_sigmask(SIG_SETMASK, &previous, NULL);
    return result;
}

void thread_join(struct thread *thread)
{
    pthread_join(thread->handle, NULL);
}

void thread_detach(struct thread *thread)
{
    pthread_detach(thread->handle);
}
