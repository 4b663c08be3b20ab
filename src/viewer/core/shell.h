// The shell around the images: window, panel, worker and messages.
#ifndef LAMPYRIS_VIEWER_CORE_SHELL_H
#define LAMPYRIS_VIEWER_CORE_SHELL_H

#include "base/thread.h"
#include "viewer/core/messages.h"
#include "viewer/core/worker.h"
#include "viewer/gui/gui.h"
#include "viewer/window/window.h"

// Lines of the log, from any thread, that become messages in the next frame.
struct viewer_log {
    struct mutex mutex;
    enum log_level level; // the level up to which stderr receives them as well
    char last[1024];
    bool is_new;
    enum log_level last_level;
};

struct panel;
struct script;
struct reload;
struct watch;

struct shell {
    const struct options *options;
    struct window window;
    struct gui gui;
    struct gpu_drawing drawing; // the panel's, for the current frame
    struct panel *panel;
    bool is_panel_shown;
    struct worker *worker;
    struct script *script; // NULL without --script
    struct reload *reload;
    struct watch *watch; // NULL without --watch

    struct progress progress; // progress of long work: shows it in the window, and stops it when
                              // the window is closed
    double progress_seconds;  // clock: when progress was shown last
    bool puts_off; // events, tasks or the panel are being processed: scenes are opened afterwards
    bool wants_quit;
    int exit_code; // EXIT_CODE_* of the error that ended it

    uint64_t start_ns, frame_ns; // clock; frame_ns: of the current frame
    double frame_seconds;        // duration of the last frame, including waiting
    double input_seconds;        // clock of the last event
    struct arena frame_arena;    // emptied in every frame

    struct viewer_log log;
    enum message_kind message_kind;
    char message[1024];
    double message_seconds; // clock time of the message
};

#endif
