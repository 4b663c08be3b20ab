// The shell around the pictures: the window, the panel, who works and what is told.
#ifndef LAMPYRIS_VIEWER_CORE_SHELL_H
#define LAMPYRIS_VIEWER_CORE_SHELL_H

#include "base/thread.h"
#include "viewer/core/messages.h"
#include "viewer/core/worker.h"
#include "viewer/gui/gui.h"
#include "viewer/window/window.h"

// Lines of the log, which come from any thread, become messages of the next frame.
struct viewer_log {
    struct mutex mutex;
    enum log_level level; // up to which stderr has it, too
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
    struct gpu_drawing drawing; // of the panel, for the frame that runs
    struct panel *panel;
    bool is_panel_shown;
    struct worker *worker;
    struct script *script; // NULL without --script
    struct reload *reload;
    struct watch *watch; // NULL without --watch

    struct progress progress; // of long work: shows it in the window, and asks to stop when closed
    double progress_seconds;  // clock: when progress was shown last
    bool puts_off; // events, tasks or the panel are in hand: scenes are opened afterwards
    bool wants_quit;
    int exit_code; // of what ended it, EXIT_CODE_*

    uint64_t start_ns, frame_ns; // clock; of the frame that runs
    double frame_seconds;        // that the last frame took, waiting included
    double input_seconds;        // clock of the last event
    struct arena frame_arena;    // emptied in every frame

    struct viewer_log log;
    enum message_kind message_kind;
    char message[1024];
    double message_seconds; // clock: when it came
};

#endif
