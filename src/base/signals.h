// SIGINT and SIGTERM stop the program gracefully, as do SIGHUP, SIGXCPU and SIGUSR1, by which
// terminals and batch systems announce the end. A SIGINT or SIGTERM that follows any of these ends
// the program at once.
#ifndef LAMPYRIS_BASE_SIGNALS_H
#define LAMPYRIS_BASE_SIGNALS_H

#include <stdbool.h>

// Installs handlers for these signals, except for those that the program was started to ignore, as
// by nohup. Ignores SIGPIPE and SIGXFSZ, so that a closed pipe, or a file beyond the size limit, is
// a write error and does not lose the images. Call it once, before threads start.
void signals_install(void);

// Returns the signal that requested the stop, or 0.
int signals_received(void);
bool signals_received_sigterm(void); // whether that signal is SIGTERM
// Returns whether there is time to do more than finish the wave in flight. There is none after
// SIGXCPU if a hard limit on CPU time follows, at which the program is killed.
bool signals_leave_time(void);
// Sets the files that a second signal removes before it ends the program, such as temporary files.
// The list must stay valid until it is replaced. Call it from one thread only.
void signals_set_leftovers(const char *const *paths, unsigned count);

// Returns 128 + the signal received, as shells do; 0 if there was none.
int signal_exit_code(void);

#endif
