// Everything around the images: window, panel, worker and messages.
#ifndef LAMPYRIS_VIEWER_CORE_SHELL_H
#define LAMPYRIS_VIEWER_CORE_SHELL_H

#include "base/thread.h"
#include "viewer/core/messages.h"
#include "viewer/core/worker.h"
#include "viewer/gui/gui.h"
#include "viewer/window/window.h"

// Lines of the log, written by any thread, which become messages in the next frame.
struct viewer_log {
    struct mutex mutex;
    enum log_level level; // messages up to this level are also written to stderr
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
    struct gpu_drawing drawing; // triangles of the panel for the current frame
    struct panel *panel;
    bool is_panel_shown;
    struct worker *worker;
    struct script *script; // NULL without --script
    struct reload *reload;
    struct watch *watch; // NULL without --watch

    // Progress listener of long work: shows progress in the window, and stops the work when the
    // window is closed.
    struct progress progress;
    double progress_seconds; // time at which progress was last shown
    // True while events, tasks or the panel are being processed; scenes are then opened afterwards.
    bool puts_off;
    bool wants_quit;
    int exit_code; // EXIT_CODE_* of the error that ended the viewer

    // Times of the clock: at the start, and at the start of the current frame.
    uint64_t start_ns, frame_ns;
    double frame_seconds;     // duration of the last frame, waiting included
    double input_seconds;     // time of the last event
    struct arena frame_arena; // emptied at each frame

    struct viewer_log log;
    enum message_kind message_kind;
    char message[1024];
    double message_seconds; // clock time of the message
};

#endif
