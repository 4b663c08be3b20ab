#include "base/signals.h"

#include "base/windows/wide.h"
#include <signal.h>
#include <stddef.h>
#include <windows.h>

// The handler runs in a thread of its own, and takes no context.
static volatile LONG received;
static const char *const *volatile leftovers;
static volatile LONG leftover_count;

static void end_at_once(int number)
{
    for (LONG i = 0; i < leftover_count; i++) {
        wchar_t *path = wide_from(leftovers[i]);
        if (path)
            DeleteFileW(path);
    }
    ExitProcess(128u + (unsigned)number);
}

// Ctrl-C counts as SIGINT, Ctrl-Break as SIGTERM; a repetition of either ends the program at once.
// Closing the window, logging out and shutting down count as SIGTERM; the system then ends the
// process after a few seconds, or as soon as this handler returns.
static BOOL WINAPI handle(DWORD event)
{
    const int number = event == CTRL_C_EVENT ? SIGINT : SIGTERM;
    const bool has_time = event == CTRL_C_EVENT || event == CTRL_BREAK_EVENT;
    if (InterlockedCompareExchange(&received, number, 0) != 0 && has_time)
        end_at_once(number);
    if (!has_time)
        Sleep(INFINITE);
    return TRUE;
}

void signals_set_leftovers(const char *const *paths, unsigned count)
{
    leftover_count = 0; // the handler must not see a list that is being changed
    leftovers = paths;
    leftover_count = (LONG)count;
}

void signals_install(void)
{
    SetConsoleCtrlHandler(handle, TRUE);
}

int signals_received(void)
{
    return (int)received;
}

bool signals_received_sigterm(void)
{
    return received == SIGTERM;
}

bool signals_leave_time(void)
{
    return true;
}

int signal_exit_code(void)
{
    return received ? 128 + (int)received : 0;
}
