#define _GNU_SOURCE // nftw
#include "base/signals.h"
#include "base/temporary_folder.h"
#include "test.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

// Runs a function in a child process, because signals change the process. Returns its exit status.
static int run_child(int (*run)(void))
{
    pid_t child = fork();
    if (child == 0)
        _exit(run());
    int status = 0;
    if (child < 0 || waitpid(child, &status, 0) != child)
        return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -2;
}

static int first_signal(void)
{
    signals_install();
    if (signals_received() != 0 || signal_exit_code() != 0)
        return 1;
    raise(SIGINT);
    return signals_received() == SIGINT ? signal_exit_code() : 2;
}

static int second_signal(void)
{
    signals_install();
    raise(SIGINT);
    raise(SIGTERM);
    return 3; // not reached
}

static int batch_signals(void)
{
    static const int numbers[] = {SIGUSR1, SIGHUP, SIGXCPU, SIGXCPU, SIGHUP, SIGUSR1};
    signals_install();
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        raise(numbers[i]);
    return signals_received() == SIGUSR1 && signals_leave_time() ? signal_exit_code() : 2;
}

static int hard_limit(void)
{
    const struct rlimit limit = {.rlim_cur = 5000, .rlim_max = 6000};
    signals_install();
    if (setrlimit(RLIMIT_CPU, &limit) != 0 || !signals_leave_time())
        return 1;
    raise(SIGXCPU);
    return signals_leave_time() ? 2 : 0;
}

static int ignored_by_parent(void)
{
    signal(SIGINT, SIG_IGN);
    signal(SIGHUP, SIG_IGN);
    signals_install();
    raise(SIGINT);
    raise(SIGHUP);
    return signals_received() ? 1 : 0;
}

static int file_too_large(void)
{
    const struct rlimit limit = {.rlim_cur = 1, .rlim_max = 1};
    char folder[512];
    signals_install();
    if (!temporary_enter(folder, sizeof folder))
        return 1;
    int fd = open("file", O_WRONLY | O_CREAT, 0600);
    temporary_leave(folder);
    if (fd < 0 || setrlimit(RLIMIT_FSIZE, &limit) != 0)
        return 1;
    return write(fd, "x", 1) == 1 && write(fd, "y", 1) < 0 && errno == EFBIG ? 0 : 2;
}

static int reader_gone(void)
{
    signals_install();
    int ends[2];
    if (pipe(ends) != 0)
        return 1;
    close(ends[0]);
    return write(ends[1], "x", 1) < 0 && errno == EPIPE ? 0 : 2;
}

TEST(the_first_signal_sets_a_flag)
{
    CHECK(run_child(first_signal) == 130, "%d", run_child(first_signal));
}

TEST(the_second_signal_ends_at_once)
{
    CHECK(run_child(second_signal) == 143, "%d", run_child(second_signal));
}

TEST(batch_systems_ask_and_do_not_insist)
{
    CHECK(run_child(batch_signals) == 128 + SIGUSR1, "%d", run_child(batch_signals));
}

TEST(a_hard_limit_leaves_no_time)
{
    CHECK(run_child(hard_limit) == 0, "%d", run_child(hard_limit));
}

TEST(a_file_that_is_too_large_is_an_error_of_writing)
{
    CHECK(run_child(file_too_large) == 0, "%d", run_child(file_too_large));
}

TEST(what_the_parent_ignores_stays_ignored)
{
    CHECK(run_child(ignored_by_parent) == 0, "%d", run_child(ignored_by_parent));
}

TEST(a_reader_that_goes_away_is_an_error_of_writing)
{
    CHECK(run_child(reader_gone) == 0, "%d", run_child(reader_gone));
}

TEST_MAIN(TEST_CASE(the_first_signal_sets_a_flag), TEST_CASE(the_second_signal_ends_at_once),
          TEST_CASE(batch_systems_ask_and_do_not_insist), TEST_CASE(a_hard_limit_leaves_no_time),
          TEST_CASE(a_file_that_is_too_large_is_an_error_of_writing),
          TEST_CASE(what_the_parent_ignores_stays_ignored),
          TEST_CASE(a_reader_that_goes_away_is_an_error_of_writing))
