#include "signals.h"
#include "test.h"

#include <errno.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

// Runs a function in a child, since signals change the process; returns the exit status.
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

static int ignored_by_parent(void)
{
    signal(SIGINT, SIG_IGN);
    signals_install();
    raise(SIGINT);
    return signals_received() ? 1 : 0;
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

TEST(what_the_parent_ignores_stays_ignored)
{
    CHECK(run_child(ignored_by_parent) == 0, "%d", run_child(ignored_by_parent));
}

TEST(a_reader_that_goes_away_is_an_error_of_writing)
{
    CHECK(run_child(reader_gone) == 0, "%d", run_child(reader_gone));
}

TEST_MAIN(TEST_CASE(the_first_signal_sets_a_flag), TEST_CASE(the_second_signal_ends_at_once),
          TEST_CASE(what_the_parent_ignores_stays_ignored),
          TEST_CASE(a_reader_that_goes_away_is_an_error_of_writing))
