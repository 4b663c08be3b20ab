#include "signals.h"

#include <signal.h>
#include <stddef.h>
#include <unistd.h>

// A handler is given no context, so these must be globals.
static volatile sig_atomic_t received;
static const char *const *volatile leftovers;
static volatile sig_atomic_t leftover_count;

static void handle(int signal)
{
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
    install(SIGINT);
    install(SIGTERM);
    signal(SIGPIPE, SIG_IGN);
}

int signals_received(void)
{
    return received;
}

int signal_exit_code(void)
{
    return received ? 128 + received : 0;
}
