#include "base/signals.h"

#include <signal.h>
#include <stddef.h>
#include <sys/resource.h>
#include <unistd.h>

// Signal handlers take no context, so these must be globals.
static volatile sig_atomic_t received;
static const char *const *volatile leftovers;
static volatile sig_atomic_t leftover_count;

// Returns whether a second signal of this kind ends the program. SIGHUP, SIGXCPU and SIGUSR1 only
// request a stop, because they may be sent more than once: SIGHUP by a closing terminal, SIGXCPU by
// the kernel every second, SIGUSR1 by batch systems.
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
            unlink(leftovers[i]); // async-signal-safe, like _exit (POSIX)
        _exit(128 + signal);
    }
    received = signal;
}

void signals_set_leftovers(const char *const *paths, unsigned count)
{
    leftover_count = 0; // the handler must not see a list that is being changed
    leftovers = paths;
    leftover_count = (sig_atomic_t)count;
}

static void install(int signal)
{
    struct sigaction old;
    if (sigaction(signal, NULL, &old) == 0 && old.sa_handler == SIG_IGN)
        return;
    // With SA_RESTART, reads and writes of files are not interrupted. The program polls the flag
    // between steps.
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
    signal(SIGXFSZ, SIG_IGN); // write() then fails with EFBIG instead
}

int signals_received(void)
{
    return received;
}

bool signals_received_sigterm(void)
{
    return received == SIGTERM;
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
