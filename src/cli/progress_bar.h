// Draws the progress on stderr, and keeps messages apart from it. On a terminal, the progress is
// one line, with the elapsed and the remaining time:
//
//   Rendering: [++++++++++++                  ]  41% (12.3 s | 17.7 s)
//
// Elsewhere, plain lines are printed every few seconds. Nothing is shown before a phase has taken
// one second; from then on, a terminal shows each phase when it begins. After a phase of at least
// one second, a line with its time remains.
#ifndef LAMPYRIS_CLI_PROGRESS_BAR_H
#define LAMPYRIS_CLI_PROGRESS_BAR_H

#include "base/log.h"
#include "base/progress.h"
#include "base/thread.h"
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

struct progress_bar {
    FILE *stream;
    bool is_terminal, is_quiet;
    struct mutex mutex; // protects the stream and the members below: messages come from any thread
    bool line_open;     // the bar is on the terminal's current line
    bool shown;         // the current phase has been shown
    char phase[32];
    uint64_t phase_start_ns, shown_ns;
    // Start of the phase, or the last time at which the fraction decreased: the remaining time is
    // extrapolated from the progress since then.
    double from_fraction;
    uint64_t from_ns;
};

void progress_bar_init(struct progress_bar *bar, FILE *stream);
// Ends the phase, and the bar's line, before other output. May be called repeatedly.
void progress_bar_finish(struct progress_bar *bar);

// Returns the listener for long-running work. It stops the work after a signal.
struct progress progress_bar_listener(struct progress_bar *bar);

// A sink for log_configure, with the bar as its context. An error ends the phase.
void progress_bar_log(void *context, enum log_level level, const char *message);

// The listener calls this function. The time (clock_ns) is an argument so that tests can choose it.
void progress_bar_update(struct progress_bar *bar, const char *phase, double fraction,
                         uint64_t now_ns);

#endif
