// SIGINT and SIGTERM ask the program to stop in good order; a second one ends it at once.
#ifndef LAMPYRIS_APP_SIGNALS_H
#define LAMPYRIS_APP_SIGNALS_H

// Handles SIGINT and SIGTERM, unless the parent had them ignored, and ignores SIGPIPE: a reader
// that goes away is an error of writing, which must not lose the pictures. Call once, before
// threads start.
void signals_install(void);

// The signal that asked to stop, or 0.
int signals_received(void);
// Files that a second signal removes before it ends the program: those that live only as long as
// it does. The list must stay until it is replaced; call from one thread.
void signals_set_leftovers(const char *const *paths, unsigned count);

// 128 + that signal, as shells have it; 0 when there was none.
int signal_exit_code(void);

#endif
