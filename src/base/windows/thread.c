#include "base/thread.h"

#include "base/clock.h"
#include <errno.h>
#include <process.h>
#include <windows.h>

_Static_assert(sizeof(struct mutex) == sizeof(SRWLOCK), "a mutex is an SRWLOCK");
_Static_assert(sizeof(struct condition) == sizeof(CONDITION_VARIABLE), "a condition is a variable");

static SRWLOCK *lock_of(struct mutex *mutex)
{
    return (SRWLOCK *)&mutex->lock;
}

static CONDITION_VARIABLE *variable_of(struct condition *condition)
{
    return (CONDITION_VARIABLE *)&condition->variable;
}

void mutex_init(struct mutex *mutex)
{
    InitializeSRWLock(lock_of(mutex));
}

void mutex_finish(struct mutex *mutex)
{
    (void)mutex;
}

void mutex_lock(struct mutex *mutex)
{
    AcquireSRWLockExclusive(lock_of(mutex));
}

void mutex_unlock(struct mutex *mutex)
{
    ReleaseSRWLockExclusive(lock_of(mutex));
}

void condition_init(struct condition *condition)
{
    InitializeConditionVariable(variable_of(condition));
}

void condition_finish(struct condition *condition)
{
    (void)condition;
}

void condition_wait(struct condition *condition, struct mutex *mutex)
{
    SleepConditionVariableSRW(variable_of(condition), lock_of(mutex), INFINITE, 0);
}

// The time is rounded up to milliseconds. A wait that ends before the deadline returns true, and
// the caller waits again.
bool condition_wait_until(struct condition *condition, struct mutex *mutex, uint64_t deadline_ns)
{
    const uint64_t now_ns = clock_ns();
    const uint64_t left_ns = deadline_ns > now_ns ? deadline_ns - now_ns : 0;
    SleepConditionVariableSRW(variable_of(condition), lock_of(mutex),
                              (DWORD)((left_ns + 999999) / 1000000), 0);
    return clock_ns() < deadline_ns;
}

void condition_wake_one(struct condition *condition)
{
    WakeConditionVariable(variable_of(condition));
}

void condition_wake_all(struct condition *condition)
{
    WakeAllConditionVariable(variable_of(condition));
}

static unsigned __stdcall thread_main(void *argument)
{
    const struct thread *thread = argument;
    thread->fn(thread->context);
    return 0;
}

int thread_start(struct thread *thread, thread_fn fn, void *context)
{
    thread->fn = fn;
    thread->context = context;
    thread->handle = (void *)_beginthreadex(NULL, 0, thread_main, thread, 0, NULL);
    return thread->handle ? 0 : errno;
}

void thread_join(struct thread *thread)
{
    WaitForSingleObject(thread->handle, INFINITE);
    CloseHandle(thread->handle);
}

void thread_detach(struct thread *thread)
{
    CloseHandle(thread->handle);
}
