#define _GNU_SOURCE // pthread_setattr_default_np
#include "base/parallel.h"
#include "test.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>

enum { COUNT = 100003 };

struct visits {
    _Atomic unsigned char seen[COUNT];
    _Atomic size_t chunks;
    _Atomic unsigned highest_thread;
    size_t grain;
    _Atomic bool chunk_too_large;
};

static void visit(void *context, size_t begin, size_t end, unsigned thread)
{
    struct visits *visits = context;
    visits->chunks++;
    if (end <= begin || end - begin > visits->grain)
        visits->chunk_too_large = true;
    unsigned highest = visits->highest_thread;
    while (thread > highest &&
           !atomic_compare_exchange_weak(&visits->highest_thread, &highest, thread))
        continue;
    for (size_t i = begin; i < end; i++)
        visits->seen[i]++;
}

static void check_each_once(size_t count, size_t grain, unsigned threads)
{
    static struct visits visits;
    memset(&visits, 0, sizeof visits);
    visits.grain = grain ? grain : 1;
    parallel_for(count, grain, threads, visit, &visits);
    for (size_t i = 0; i < COUNT; i++)
        if (visits.seen[i] != (i < count)) {
            CHECK(false, "%zu of %zu (grain %zu, %u threads) seen %d times", i, count, grain,
                  threads, visits.seen[i]);
            return;
        }
    CHECK(!visits.chunk_too_large, "grain %zu", grain);
    unsigned limit = threads ? threads : cpu_count();
    CHECK(visits.highest_thread < limit, "thread %u of %u", visits.highest_thread, limit);
}

TEST(every_index_is_visited_once)
{
    static const size_t counts[] = {0, 1, 2, 63, 64, 65, COUNT};
    static const size_t grains[] = {0, 1, 7, 64, COUNT, SIZE_MAX};
    static const unsigned threads[] = {0, 1, 2, 3, 16};
    for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++)
        for (size_t g = 0; g < sizeof grains / sizeof grains[0]; g++)
            for (size_t t = 0; t < sizeof threads / sizeof threads[0]; t++)
                check_each_once(counts[c], grains[g], threads[t]);
}

static void count_items(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    atomic_fetch_add((_Atomic size_t *)context, end - begin);
}

TEST(counts_near_the_largest_do_not_wrap)
{
    _Atomic size_t sum = 0;
    parallel_for(SIZE_MAX, SIZE_MAX / 2, 4, count_items, &sum);
    CHECK(sum == SIZE_MAX, "%zu", (size_t)sum);
}

TEST(absurd_thread_numbers_are_capped)
{
    check_each_once(COUNT, 1, 1000000);
}

// The stacks are larger than the address space, so no thread starts.
TEST(work_is_done_when_no_thread_can_be_started)
{
    pthread_attr_t before, huge;
    REQUIRE(pthread_getattr_default_np(&before) == 0 && pthread_attr_init(&huge) == 0);
    REQUIRE(pthread_attr_setstacksize(&huge, (size_t)1 << 48) == 0);
    REQUIRE(pthread_setattr_default_np(&huge) == 0);
    static struct visits visits;
    visits.grain = 100;
    parallel_for(COUNT, 100, 4, visit, &visits);
    pthread_setattr_default_np(&before);
    CHECK(visits.chunks == COUNT / 100 + 1, "%zu", (size_t)visits.chunks);
    CHECK(visits.highest_thread == 0, "thread %u started", visits.highest_thread);
}

TEST(there_is_a_cpu)
{
    CHECK(cpu_count() >= 1 && cpu_count() <= PARALLEL_MAX_THREADS, "%u", cpu_count());
}

TEST_MAIN(TEST_CASE(every_index_is_visited_once), TEST_CASE(counts_near_the_largest_do_not_wrap),
          TEST_CASE(absurd_thread_numbers_are_capped),
          TEST_CASE(work_is_done_when_no_thread_can_be_started), TEST_CASE(there_is_a_cpu))
