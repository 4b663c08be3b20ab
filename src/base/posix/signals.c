#include "base/signals.h"

#include <signal.h>
#include <stddef.h>
#include <sys/resource.h>
#include <unistd.h>

// A handler is given no context, so these must be globals.
static volatile sig_atomic_t received;
static const char *const *volatile leftovers;
static volatile sig_atomic_t leftover_count;

// A terminal that closes sends SIGHUP more than once, the kernel SIGXCPU every second, and a batch
// system its notice to whom it likes: these ask once, and do not insist.
static bool insists(int signal)
{
    return signal == SIGINT || signal == SIGTERM;
}

static void handle(int signal)
{
    if (received && !insists(signal))
        return;
    if (received) {
        for (int i = 0; i < leftover_count; i++)
            unlink(leftovers[i]); // async-signal-safe, as _exit is (POSIX)
        _exit(128 + signal);
    }
    received = signal;
}

void signals_set_leftovers(const char *const *paths, unsigned count)
{
    leftover_count = 0; // before the list changes, and set again only after it has
    leftovers = paths;
    leftover_count = (sig_atomic_t)count;
}

static void install(int signal)
{
    struct sigaction old;
    if (sigaction(signal, NULL, &old) == 0 && old.sa_handler == SIG_IGN)
        return;
    // SA_RESTART: files are read and written to the end; the flag is looked at between steps.
    struct sigaction action = {.sa_handler = handle, .sa_flags = SA_RESTART};
    sigemptyset(&action.sa_mask);
    sigaction(signal, &action, NULL);
}

void signals_install(void)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP, SIGXCPU, SIGUSR1};
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        install(signals[i]);
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN); // write() then fails with EFBIG
}

int signals_received(void)
{
    return received;
}

bool signals_leave_time(void)
{
    struct rlimit cpu;
    return received != SIGXCPU || getrlimit(RLIMIT_CPU, &cpu) != 0 || cpu.rlim_max == RLIM_INFINITY;
}

int signal_exit_code(void)
{
    return received ? 128 + received : 0;
}
