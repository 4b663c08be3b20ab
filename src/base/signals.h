// SIGINT and SIGTERM stop the program gracefully, and so do SIGHUP, SIGXCPU and SIGUSR1, with which
// terminals and batch systems announce the end. A SIGINT or SIGTERM after any of them ends it at
// once.
#ifndef LAMPYRIS_BASE_SIGNALS_H
#define LAMPYRIS_BASE_SIGNALS_H

#include <stdbool.h>

// Installs handlers for these signals, except for those that the parent process ignores, as nohup
// does. Ignores SIGPIPE and SIGXFSZ: a closed pipe, and a file that exceeds the size limit, are
// write errors that must not lose the images. Call once, before threads start.
void signals_install(void);

// Returns the signal that requested the stop, or 0.
int signals_received(void);
// Returns whether there is time for more than the wave in flight: not after SIGXCPU where a hard
// limit of the processor's time follows, at which the program is killed.
bool signals_leave_time(void);
// Sets the files that a second signal removes before it ends the program: those that only live as
// long as the process. The list must stay valid until it is replaced; call from one thread.
void signals_set_leftovers(const char *const *paths, unsigned count);

// Returns 128 + that signal, as in shells; 0 if there was none.
int signal_exit_code(void);

#endif
