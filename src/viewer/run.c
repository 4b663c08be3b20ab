// The main loop of the viewer, from a command line to an exit code.
#include "viewer/run.h"

#include "base/clock.h"
#include "base/file.h"
#include "cli/exit_code.h"
#include "cli/options.h"
#include "image/image.h"
#include "viewer/core/changes.h"
#include "viewer/core/device.h"
#include "viewer/core/edit.h"
#include "viewer/core/exposure.h"
#include "viewer/core/frame.h"
#include "viewer/core/load.h"
#include "viewer/core/long_work.h"
#include "viewer/core/messages.h"
#include "viewer/core/reload.h"
#include "viewer/core/report.h"
#include "viewer/core/viewer.h"
#include "viewer/core/watch.h"
#include "viewer/panel/panel.h"
#include "viewer/script/script.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// The default size of the window.
#define DEFAULT_WIDTH 1280u
#define DEFAULT_HEIGHT 720u
// In each frame of a script, the camera moves by this time, however long the frame takes, so that
// the images are the same on all devices.
#define SCRIPT_FRAME_SECONDS (1.0 / 30.0)
// A frame that took longer, because something was loaded, moves the camera only by this time.
#define LONGEST_FRAME_SECONDS 0.25
// The time, in seconds, to wait for events if nothing else is to be done.
#define REST_WAIT_SECONDS 0.1

// --- a frame -------------------------------------------------------------------------------------

static void take_window(struct viewer *viewer)
{
    bool waits = viewer->stage.is_resting && !viewer->shell.script;
    window_poll(&viewer->shell.window, waits ? REST_WAIT_SECONDS : 0.0);
    uint64_t now = clock_ns();
    viewer->shell.frame_seconds = (double)(now - viewer->shell.frame_ns) * 1e-9;
    viewer->shell.frame_ns = now;
    arena_finish(&viewer->shell.frame_arena);
}

// Adopts the size of the window. The event also arrives if the window was damaged and must be
// presented again.
static void take_size(struct viewer *viewer)
{
    const struct window *window = &viewer->shell.window;
    viewer->stage.is_resting = false;
    if (window->width != viewer->stage.screen.width ||
        window->height != viewer->stage.screen.height)
        viewer_changed(viewer, CHANGE_CAMERA);
}

// Makes a dropped image the environment.
static void take_image(struct viewer *viewer, const char *path)
{
    struct surroundings to = viewer->document.surroundings;
    if (strlen(path) >= sizeof to.image) {
        viewer_message(viewer, MESSAGE_ERROR, "%s: the path has %zu bytes; expected at most %zu",
                       path, strlen(path), sizeof to.image - 1);
        return;
    }
    // Unused bytes are 0, because states are compared byte by byte.
    memset(to.image, 0, sizeof to.image);
    memcpy(to.image, path, strlen(path));
    to.kind = SURROUNDINGS_IMAGE;
    if (edit_surroundings(viewer, &to, "surroundings.image"))
        viewer_message(viewer, MESSAGE_NOTE, "%s lights the scene now", path_name(path));
}

static void take_file(struct viewer *viewer, const char *path)
{
    if (!image_has_known_name(path))
        viewer_open_scene(viewer, path, false);
    else if (viewer->document.has_scene)
        take_image(viewer, path);
    else
        viewer_message(viewer, MESSAGE_WARNING,
                       "%s: an image becomes the environment of a scene; open a scene first", path);
}

static void take_event(struct viewer *viewer, const struct event *event)
{
    const struct gui *gui = &viewer->shell.gui;
    gui_event(&viewer->shell.gui, event);
    bool is_mouse = event->kind == EVENT_BUTTON || event->kind == EVENT_SCROLL;
    bool begins = event->down || event->kind == EVENT_SCROLL;
    if (event->kind == EVENT_CLOSE)
        viewer->shell.wants_quit = true;
    else if (event->kind == EVENT_RESIZE)
        take_size(viewer);
    else if (event->kind == EVENT_DROP)
        take_file(viewer, event->path);
    else if (is_mouse && begins && gui->wants_mouse)
        return;
    else if (event->kind == EVENT_KEY && event->down && gui->wants_keys)
        return;
    else
        viewer_event(viewer, event);
}

static void take_events(struct viewer *viewer)
{
    if (viewer->shell.window.event_count > 0)
        viewer->shell.input_seconds = viewer_seconds(viewer);
    for (uint32_t i = 0; i < viewer->shell.window.event_count; i++)
        take_event(viewer, &viewer->shell.window.events[i]);
}

static void take_work(struct viewer *viewer)
{
    if (viewer->shell.watch)
        watch_poll(viewer);
    worker_poll(viewer->shell.worker, viewer);
    viewer_log_show(viewer);
}

static double motion_seconds(const struct viewer *viewer)
{
    return viewer->shell.script ? SCRIPT_FRAME_SECONDS
                                : fmin(viewer->shell.frame_seconds, LONGEST_FRAME_SECONDS);
}

static void draw_panel(struct viewer *viewer)
{
    gui_begin(&viewer->shell.gui, viewer->shell.window.width, viewer->shell.window.height,
              viewer->shell.frame_seconds);
    panel_draw(viewer);
    gui_end(&viewer->shell.gui, &viewer->shell.drawing);
    if (!viewer->shell.gui.is_busy && viewer_holds_nothing(viewer))
        edit_close(viewer);
}

static bool look_at_errors(struct viewer *viewer, struct err *err)
{
    for (uint32_t side = 0; side < viewer->stage.side_count; side++)
        if (!view_look_at_error(viewer, side, err))
            return false;
    return true;
}

static bool run_script(struct viewer *viewer, struct err *err)
{
    if (!viewer->shell.script || script_step(viewer->shell.script, viewer, err))
        return true;
    if (err->code == ERR_NONE)
        viewer->shell.wants_quit = true;
    else if (viewer->shell.exit_code == EXIT_CODE_OK)
        viewer->shell.exit_code = EXIT_CODE_CHECK_FAILED;
    return err->code == ERR_NONE;
}

// Runs a frame, in this order: window, script, events, files and jobs, camera, panel, changes,
// rendering, display, statistics. Returns false if the viewer cannot continue.
static bool run_frame(struct viewer *viewer, struct err *err)
{
    take_window(viewer);
    if (!run_script(viewer, err))
        return false;
    if (viewer->shell.wants_quit)
        return true;
    viewer->shell.puts_off = true;
    take_events(viewer);
    take_work(viewer);
    viewer_move_camera(viewer, motion_seconds(viewer));
    pose_play(viewer, motion_seconds(viewer));
    draw_panel(viewer);
    viewer->shell.puts_off = false;
    bool ok = viewer_apply_changes(viewer, err) && viewer_answer_click(viewer, err) &&
              viewer_render(viewer, err) && look_at_errors(viewer, err) &&
              viewer_find_exposure(viewer, err) && viewer_show(viewer, err);
    if (ok)
        viewer_count_frame(viewer);
    return ok;
}

// --- start and end -------------------------------------------------------------------------------

static void set_up(struct viewer *viewer, const struct options *options)
{
    viewer->shell.options = options;
    viewer->shell.start_ns = viewer->shell.frame_ns = clock_ns();
    viewer->shell.progress = viewer_progress(viewer);
    viewer->stage.frame_progress = (struct progress){NULL, viewer_frame_is_over, viewer};
    viewer->stage.swapchain.vsync =
        options_given(options, OPTION_VSYNC) ? options->view.vsync : true;
    viewer->stage.side_count = 1;
    viewer->shell.is_panel_shown = true;
    viewer->stage.shown = (struct shown){
        .automatic = 1,
        .denoise = options->view.denoise,
        .denoise_temporal = 1,
        .denoise_iterations = 5,
        .split_at = 0.5,
    };
    double frame_ms = options->view.frame_ms;
    frame_budget_init(&viewer->view.pace, frame_ms > 0.0 ? frame_ms : 33.0);
    viewer_log_begin(viewer, options->log_level);
}

static bool open_window(struct viewer *viewer, struct err *err)
{
    const struct options *options = viewer->shell.options;
    bool has_size = options_given(options, OPTION_SIZE);
    const struct window_params params = {
        .title = "Lampyris",
        .width = has_size ? options->scene.settings.width : DEFAULT_WIDTH,
        .height = has_size ? options->scene.settings.height : DEFAULT_HEIGHT,
        .headless = options->view.headless,
    };
    if (options->view.headless && !options->view.script)
        return err_set(err, ERR_USAGE,
                       "--headless: expected --script FILE, because there is no window for input");
    return (!options->view.script ||
            script_open(options->view.script, &viewer->shell.script, err)) &&
           window_open(&params, &viewer->shell.window, err);
}

static bool open_all(struct viewer *viewer, struct err *err)
{
    const struct options *options = viewer->shell.options;
    if (!open_window(viewer, err) || !worker_create(&viewer->shell.worker, err) ||
        !history_create(&viewer->document.history, err) ||
        !gui_create(viewer->shell.window.scale, &viewer->shell.gui, err) ||
        !panel_create(&viewer->shell.panel, err) || !viewer_open_device(viewer, err) ||
        !reload_create(options, &viewer->shell.reload, err) ||
        (options->view.watch && !watch_create(viewer, &viewer->shell.watch, err)))
        return false;
    if (options->argument_count == 0)
        return true;
    // The scene of the command line must exist, as for any command. An empty window is shown first,
    // for the progress of loading.
    return viewer_show(viewer, err) && viewer_load_scene(viewer, options->arguments[0], false, err);
}

// Waits for jobs that write files, then frees everything in the reverse order of creation.
static void close_all(struct viewer *viewer)
{
    watch_destroy(viewer->shell.watch);
    if (viewer->shell.reload)
        reload_stop(viewer->shell.reload);
    worker_destroy(viewer->shell.worker, viewer);
    viewer->shell.worker = NULL;
    if (viewer->document.history)
        viewer_close_scene(viewer);
    reload_destroy(viewer->shell.reload, viewer);
    viewer_close_device(viewer);
    panel_destroy(viewer->shell.panel);
    gui_finish(&viewer->shell.gui);
    history_destroy(viewer->document.history);
    window_close(&viewer->shell.window);
    script_close(viewer->shell.script);
    arena_finish(&viewer->shell.frame_arena);
    frame_times_finish(&viewer->stage.moving_times);
    frame_times_finish(&viewer->stage.resting_times);
    viewer_log_end(viewer);
}

static bool run_frames(struct viewer *viewer, struct err *err)
{
    while (!viewer_is_ending(viewer))
        if (!run_frame(viewer, err) && !(viewer->stage.gpu.lost && viewer_recover(viewer, err)))
            return false;
    return true;
}

// Prints an error and returns the exit code. Closing the window during loading is a normal end.
static int fail(struct viewer *viewer, const struct err *err)
{
    if (err->code == ERR_STOPPED)
        return EXIT_CODE_OK;
    viewer_print(viewer, LOG_ERROR, err->msg);
    return viewer->shell.exit_code != EXIT_CODE_OK ? viewer->shell.exit_code : exit_code(err->code);
}

int viewer_run(const struct options *options)
{
    struct viewer *viewer = calloc(1, sizeof *viewer);
    struct err err = {0};
    if (!viewer) {
        err_memory(&err, "the viewer", sizeof *viewer);
        return command_fail(&err);
    }
    set_up(viewer, options);
    bool ok = open_all(viewer, &err) && run_frames(viewer, &err);
    int code = ok ? viewer->shell.exit_code : fail(viewer, &err);
    if (viewer->stage.stats.frames > 0)
        viewer_report(viewer);
    close_all(viewer);
    if (code == EXIT_CODE_OK && viewer->stage.gpu.validation_messages > 0) {
        err_set(&err, ERR_BUG, "the validation layers reported %u messages",
                viewer->stage.gpu.validation_messages);
        code = command_fail(&err);
    }
    free(viewer);
    return code;
}
