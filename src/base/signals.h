// SIGINT and SIGTERM ask the program to stop in good order, and so do SIGHUP, SIGXCPU and SIGUSR1,
// with which terminals and batch systems announce the end; a SIGINT or SIGTERM after any of them
// ends it at once.
#ifndef LAMPYRIS_BASE_SIGNALS_H
#define LAMPYRIS_BASE_SIGNALS_H

#include <stdbool.h>

// Handles those signals, but for those that the parent had ignored, as nohup does. Ignores SIGPIPE
// and SIGXFSZ: a reader that goes away, and a file that exceeds the limit of its size, are errors
// of writing, which must not lose the pictures. Call once, before threads start.
void signals_install(void);

// The signal that asked to stop, or 0.
int signals_received(void);
// Returns whether there is time for more than the wave in flight: not after SIGXCPU where a hard
// limit of the processor's time follows, at which the program is killed.
bool signals_leave_time(void);
// Files that a second signal removes before it ends the program: those that live only as long as
// it does. The list must stay until it is replaced; call from one thread.
void signals_set_leftovers(const char *const *paths, unsigned count);

// 128 + that signal, as shells have it; 0 when there was none.
int signal_exit_code(void);

#endif
