#include "viewer/core/worker.h"

#include "test.h"

#include <signal.h>
#include <stdatomic.h>
#include <time.h>

struct task {
    atomic_int *started; // number of tasks that have started
    atomic_bool *gate;   // the task waits until this is true; NULL: it does not wait
    int number;          // number of tasks that had started before this one
    bool fails;
    bool is_signal_blocked;
};

struct tally { // passed to `done` in place of the viewer
    int done, in_order, failed;
    struct worker *again; // adds one more job from within a job
    struct task *task;
};

static void rest(void)
{
    nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
}

static bool run(void *context, struct err *err)
{
    struct task *task = context;
    sigset_t blocked;
    pthread_sigmask(SIG_SETMASK, NULL, &blocked);
    task->is_signal_blocked = sigismember(&blocked, SIGINT) == 1;
    task->number = atomic_fetch_add(task->started, 1);
    while (task->gate && !atomic_load(task->gate))
        rest();
    return task->fails ? err_set(err, ERR_OUTPUT, "task %d", task->number) : true;
}

static void done(void *context, void *viewer, bool ok, const struct err *err)
{
    struct task *task = context;
    struct tally *tally = viewer;
    char expected[32];
    snprintf(expected, sizeof expected, "task %d", task->number);
    CHECK(ok != task->fails && (ok || strcmp(err->msg, expected) == 0), "%d %s", ok, err->msg);
    CHECK(task->is_signal_blocked, "signals interrupt the worker");
    tally->in_order += task->number == tally->done;
    tally->failed += !ok;
    tally->done++;
    if (tally->again) {
        struct worker_task job = {"again", run, done, tally->task};
        CHECK(worker_add(tally->again, &job), "from inside of done");
        tally->again = NULL;
    }
}

static void wait_until_idle(struct worker *worker, struct tally *tally)
{
    while (!worker_is_idle(worker)) {
        worker_poll(worker, tally);
        rest();
    }
}

TEST(jobs_run_in_their_order)
{
    struct worker *worker;
    struct err err;
    struct task tasks[50];
    struct tally tally = {0};
    atomic_int started = 0;
    REQUIRE(worker_create(&worker, &err), "%s", err.msg);
    CHECK(worker_is_idle(worker), "at first");
    for (int i = 0; i < 50; i++) {
        tasks[i] = (struct task){.started = &started, .fails = i % 3 == 0};
        CHECK(worker_add(worker, &(struct worker_task){"some", run, done, &tasks[i]}), "%d", i);
    }
    CHECK(tally.done == 0, "only worker_poll calls done");
    wait_until_idle(worker, &tally);
    CHECK(tally.done == 50 && tally.in_order == 50, "%d done, %d in order", tally.done,
          tally.in_order);
    CHECK(tally.failed == 17, "%d", tally.failed);
    worker_destroy(worker, &tally);
    CHECK(tally.done == 50, "%d", tally.done);
}

TEST(a_full_list_takes_no_more)
{
    struct worker *worker;
    struct err err;
    atomic_int started = 0;
    atomic_bool gate = false;
    struct task tasks[66];
    struct tally tally = {0};
    REQUIRE(worker_create(&worker, &err), "%s", err.msg);
    for (int i = 0; i < 66; i++) {
        tasks[i] = (struct task){.started = &started, .gate = &gate};
        bool is_taken = worker_add(worker, &(struct worker_task){"wait", run, done, &tasks[i]});
        CHECK(is_taken == (i < 64), "%d: %d", i, is_taken);
    }
    CHECK(worker_count(worker, "wait") == 64, "%u", worker_count(worker, "wait"));
    CHECK(worker_count(worker, "other") == 0, "%u", worker_count(worker, "other"));
    worker_poll(worker, &tally);
    CHECK(tally.done == 0 && !worker_is_idle(worker), "%d", tally.done);
    atomic_store(&gate, true);
    worker_destroy(worker, &tally); // no job is lost
    CHECK(tally.done == 64 && tally.in_order == 64, "%d, %d", tally.done, tally.in_order);
}

TEST(done_may_add_a_job)
{
    struct worker *worker;
    struct err err;
    atomic_int started = 0;
    struct task first = {.started = &started}, second = {.started = &started};
    REQUIRE(worker_create(&worker, &err), "%s", err.msg);
    struct tally tally = {.again = worker, .task = &second};
    worker_add(worker, &(struct worker_task){"first", run, done, &first});
    wait_until_idle(worker, &tally);
    CHECK(tally.done == 2 && tally.in_order == 2, "%d", tally.done);
    worker_destroy(worker, &tally);
    worker_destroy(NULL, NULL);
}

TEST_MAIN(TEST_CASE(jobs_run_in_their_order), TEST_CASE(a_full_list_takes_no_more),
          TEST_CASE(done_may_add_a_job))
