#include "test.h"

#include "base/clock.h"
#include "base/thread.h"

struct shared {
    struct mutex mutex;
    struct condition changed;
    int value;
};

static void set_value(void *context)
{
    struct shared *shared = context;
    mutex_lock(&shared->mutex);
    shared->value = 7;
    condition_wake_all(&shared->changed);
    mutex_unlock(&shared->mutex);
}

static struct shared make_shared(void)
{
    struct shared shared = {.mutex = MUTEX_INIT};
    condition_init(&shared.changed);
    return shared;
}

TEST(a_condition_wakes_who_waits)
{
    struct shared shared = make_shared();
    struct thread thread;
    CHECK(thread_start(&thread, set_value, &shared) == 0);
    mutex_lock(&shared.mutex);
    while (shared.value == 0)
        condition_wait(&shared.changed, &shared.mutex);
    mutex_unlock(&shared.mutex);
    thread_join(&thread);
    CHECK(shared.value == 7);
    condition_finish(&shared.changed);
    mutex_finish(&shared.mutex);
}

// A wait may end early without a reason, but must not report that the deadline has passed.
TEST(a_deadline_ends_a_wait)
{
    struct shared shared = make_shared();
    const uint64_t deadline_ns = clock_ns() + 20 * 1000 * 1000;
    mutex_lock(&shared.mutex);
    while (condition_wait_until(&shared.changed, &shared.mutex, deadline_ns))
        continue;
    mutex_unlock(&shared.mutex);
    CHECK(clock_ns() >= deadline_ns);
    CHECK(!condition_wait_until(&shared.changed, &shared.mutex, 0));
    condition_finish(&shared.changed);
}

TEST(clocks_go_on)
{
    const uint64_t start_ns = clock_ns(), wall_ns = clock_wall_ns();
    clock_sleep(0.01);
    CHECK(clock_seconds_since(start_ns) >= 0.01);
    CHECK(clock_wall_ns() > wall_ns);
    CHECK(wall_ns / UINT64_C(1000000000) > UINT64_C(1700000000)); // after November 2023
}

TEST_MAIN(TEST_CASE(a_condition_wakes_who_waits), TEST_CASE(a_deadline_ends_a_wait),
          TEST_CASE(clocks_go_on))
