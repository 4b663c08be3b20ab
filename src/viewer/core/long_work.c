// Shows the progress of work that takes longer than a frame, and stops the work on request.
#include "viewer/core/long_work.h"

#include "base/clock.h"
#include "base/signals.h"
#include "viewer/core/messages.h"
#include "viewer/core/viewer.h"

// The time after which work counts as long, and the time between updates of the progress, in
// seconds.
#define LONG_WORK_SECONDS 0.3
#define PROGRESS_SECONDS 0.1

bool viewer_is_ending(const struct viewer *viewer)
{
    return viewer->shell.wants_quit || viewer->shell.window.should_close || signals_received() != 0;
}

static bool should_stop(void *context)
{
    return viewer_is_ending(context);
}

static void report_progress(void *context, const char *phase, double fraction)
{
    viewer_show_progress(context, phase, fraction);
}

static bool has_picture(const struct viewer *viewer)
{
    return viewer->stage.display.pixels.handle &&
           viewer->stage.screen.width == viewer->shell.window.width &&
           viewer->stage.screen.height == viewer->shell.window.height &&
           viewer->stage.display.pixels.bytes >=
               (uint64_t)viewer->stage.screen.width * viewer->stage.screen.height * 4;
}

// Processes events during the work: keys that are released are no longer held, all other input is
// ignored.
static void poll_meanwhile(struct viewer *viewer)
{
    window_poll(&viewer->shell.window, 0.0);
    for (uint32_t i = 0; i < viewer->shell.window.event_count; i++) {
        const struct event *event = &viewer->shell.window.events[i];
        bool lets_go = (event->kind == EVENT_KEY || event->kind == EVENT_BUTTON) && !event->down;
        if (!lets_go && event->kind != EVENT_FOCUS)
            continue;
        gui_event(&viewer->shell.gui, event);
        viewer_event(viewer, event);
    }
}

// If drawing fails, the next frame reports it.
void viewer_show_progress(struct viewer *viewer, const char *phase, double fraction)
{
    struct err err = {0};
    double now = viewer_seconds(viewer);
    bool is_long = clock_seconds_since(viewer->shell.frame_ns) > LONG_WORK_SECONDS;
    if (viewer->shell.puts_off || !is_long ||
        now - viewer->shell.progress_seconds < PROGRESS_SECONDS || !viewer->shell.window.handle)
        return;
    viewer->shell.progress_seconds = now;
    poll_meanwhile(viewer);
    if (!has_picture(viewer) || viewer->shell.window.is_minimised)
        return;
    gui_begin(&viewer->shell.gui, viewer->shell.window.width, viewer->shell.window.height,
              PROGRESS_SECONDS);
    gui_progress(&viewer->shell.gui, phase, fraction);
    gui_end(&viewer->shell.gui, &viewer->shell.drawing);
    if (gpu_screen_draw(&viewer->stage.gpu, &viewer->stage.screen, &viewer->stage.display.pixels,
                        &viewer->shell.drawing, &err))
        swapchain_show(&viewer->stage.gpu, &viewer->stage.swapchain, &viewer->shell.window,
                       &viewer->stage.screen, &err);
}

struct progress viewer_progress(struct viewer *viewer)
{
    return (struct progress){report_progress, should_stop, viewer};
}
