// What takes longer than a frame: how far it is, and whether it is to stop.
#include "viewer/core/viewer.h"

#include "base/clock.h"
#include "cli/signals.h"

// What takes longer shows how far it is, so often.
#define LONG_WORK_SECONDS 0.3
#define PROGRESS_SECONDS 0.1

bool viewer_is_ending(const struct viewer *viewer)
{
    return viewer->wants_quit || viewer->window.should_close || signals_received() != 0;
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
    return viewer->display.pixels.handle && viewer->screen.width == viewer->window.width &&
           viewer->screen.height == viewer->window.height &&
           viewer->display.pixels.bytes >=
               (uint64_t)viewer->screen.width * viewer->screen.height * 4;
}

// What is let go of meanwhile is held no more; all else that happens meanwhile is not for the scene
// that is to come.
static void poll_meanwhile(struct viewer *viewer)
{
    window_poll(&viewer->window, 0.0);
    for (uint32_t i = 0; i < viewer->window.event_count; i++) {
        const struct event *event = &viewer->window.events[i];
        bool lets_go = (event->kind == EVENT_KEY || event->kind == EVENT_BUTTON) && !event->down;
        if (!lets_go && event->kind != EVENT_FOCUS)
            continue;
        gui_event(&viewer->gui, event);
        viewer_event(viewer, event);
    }
}

// A failure shows in the next frame.
void viewer_show_progress(struct viewer *viewer, const char *phase, double fraction)
{
    struct err err = {0};
    double now = viewer_seconds(viewer);
    bool is_long = clock_seconds_since(viewer->frame_ns) > LONG_WORK_SECONDS;
    if (viewer->puts_off || !is_long || now - viewer->progress_seconds < PROGRESS_SECONDS ||
        !viewer->window.handle)
        return;
    viewer->progress_seconds = now;
    poll_meanwhile(viewer);
    if (!has_picture(viewer) || viewer->window.is_minimised)
        return;
    gui_begin(&viewer->gui, viewer->window.width, viewer->window.height, PROGRESS_SECONDS);
    gui_progress(&viewer->gui, phase, fraction);
    gui_end(&viewer->gui, &viewer->drawing);
    if (gpu_screen_draw(&viewer->gpu, &viewer->screen, &viewer->display.pixels, &viewer->drawing,
                        &err))
        swapchain_show(&viewer->gpu, &viewer->swapchain, &viewer->window, &viewer->screen, &err);
}

struct progress viewer_progress(struct viewer *viewer)
{
    return (struct progress){report_progress, should_stop, viewer};
}
