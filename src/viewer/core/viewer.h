// The interactive viewer: what its parts share.
//
// One thread runs all of it, frame by frame (viewer/run.c), but for jobs of the worker. A frame
// takes what happened (window, script), changes the scene and the cameras by it, renders for as
// long as a frame may take, and shows what there is.
#ifndef LAMPYRIS_VIEWER_CORE_VIEWER_H
#define LAMPYRIS_VIEWER_CORE_VIEWER_H

#include "viewer/core/document.h"
#include "viewer/core/shell.h"
#include "viewer/core/stage.h"
#include "viewer/core/viewpoint.h"

struct viewer {
    struct document document;
    struct viewpoint view;
    struct stage stage;
    struct shell shell;
};

// --- messages.c ----------------------------------------------------------------------------------
// From here on what the log says, up to that level, is told by the viewer; and no more.
void viewer_log_begin(struct viewer *viewer, enum log_level level);
void viewer_log_end(struct viewer *viewer);
void viewer_log_show(struct viewer *viewer); // in the window: what has come since the last frame
void viewer_print(const struct viewer *viewer, enum log_level level, const char *text); // to stderr
void viewer_message(struct viewer *viewer, enum message_kind kind, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
double viewer_seconds(const struct viewer *viewer); // since it began

// --- long_work.c ---------------------------------------------------------------------------------
struct progress viewer_progress(struct viewer *viewer); // of work between frames
bool viewer_is_ending(const struct viewer *viewer);     // it was closed, or a signal came
// Draws a frame with a progress bar, from inside of long work; at most ten a second.
void viewer_show_progress(struct viewer *viewer, const char *phase, double fraction);

// --- frame.c -------------------------------------------------------------------------------------
// The size of the picture at rest: the window's.
void viewer_picture_size(const struct viewer *viewer, uint32_t *width, uint32_t *height);
// Where in the window it is shown: x, y, width, height, pixels. In the middle of what the panel
// leaves, and all of it: scaled down while the panel is shown. What is rendered is the same.
void viewer_picture_place(const struct viewer *viewer, uint32_t place[4]);
// The x in the window of the line of a split view.
double viewer_split_x(const struct viewer *viewer);
bool viewer_frame_is_over(void *viewer); // as a progress asks: whether to stop rendering
// How many samples of a pixel a side still wants, now.
uint64_t viewer_samples_left(const struct viewer *viewer, const struct view *view);
// Samples for as long as the frame may take.
bool viewer_render(struct viewer *viewer, struct err *err);
// What there is, denoised where asked for, with the panel over it, on the screen and in the window.
bool viewer_show(struct viewer *viewer, struct err *err);
// --- exposure.c ----------------------------------------------------------------------------------
// The picture or its light is another one: where the exposure is automatic, it is found anew.
static inline void viewer_begin_exposure(struct viewer *viewer)
{
    viewer->stage.exposure_samples = viewer->stage.shown.exposure_is_auto ? 1 : 0;
}
// Finds it when it is time to.
bool viewer_find_exposure(struct viewer *viewer, struct err *err);
// What display_draw shows now, for those who want the same in another way.
void viewer_display_call(const struct viewer *viewer, struct display_call *out);

// --- report.c ------------------------------------------------------------------------------------
// When it ends: how fast, and how good. To stdout, as --json or --quiet say.
void viewer_report(struct viewer *viewer);
void frame_times_add(struct frame_times *times, double ms);
// The value below which that part of them is, in [0, 1]; NAN without any. Puts them in order.
double frame_times_quantile(struct frame_times *times, double part);
void frame_times_finish(struct frame_times *times);
void viewer_count_frame(struct viewer *viewer); // statistics of the frame that ends

// --- load.c --------------------------------------------------------------------------------------
// Replaces the scene; on failure the old one stays, with a message. keep_view: camera, methods and
// what is shown stay as they are (reloading). While events, jobs or the panel are in hand, the
// scene is opened afterwards, in the same frame, and the answer is true.
bool viewer_open_scene(struct viewer *viewer, const char *path, bool keep_view);
void viewer_close_scene(struct viewer *viewer);
// The same without a message. ERR_STOPPED where the window was closed meanwhile.
bool viewer_load_scene(struct viewer *viewer, const char *path, bool keep_view, struct err *err);
struct geometry_params viewer_geometry_params(const struct viewer *viewer,
                                              const struct scene *scene,
                                              const struct camera *camera);
void viewer_find_bounds(struct viewer *viewer); // of the geometry as it is
// The scene's camera; one that was made up is fitted to the picture as it is now, and turns about
// the middle of the scene.
void viewer_go_home(struct viewer *viewer);

// --- changes.c -----------------------------------------------------------------------------------
// What has to be done anew before the next samples; both sides, or one.
void viewer_changed(struct viewer *viewer, enum change change);
void viewer_side_changed(struct viewer *viewer, uint32_t side, enum change change);
// Does what `changes` asks for. False: the device failed.
bool viewer_apply_changes(struct viewer *viewer, struct err *err);
// AOV_* that renderers have to have for it, and no others.
uint32_t viewer_aovs(const struct shown *shown);
// Gives back what a side has on the device.
void viewer_close_side(struct viewer *viewer, uint32_t side);

// --- device.c ------------------------------------------------------------------------------------
bool viewer_open_device(struct viewer *viewer, struct err *err);
void viewer_close_device(struct viewer *viewer);
// After a lost device: opens it again; all pictures begin anew. False: it could not be had.
bool viewer_recover(struct viewer *viewer, struct err *err);

// --- pick.c --------------------------------------------------------------------------------------
// What is seen at a pixel of the window. False: the device failed.
bool viewer_pick(struct viewer *viewer, double x, double y, struct picked *out, struct err *err);
// The scene's number of a surface in a renderer's flat scene, as AOV ids have it less 1.
uint32_t viewer_object(const struct renderer *renderer, bool is_shape, uint32_t primitive,
                       uint32_t flat_instance);

// --- save.c --------------------------------------------------------------------------------------
// Both take the picture as it is now and write it on the worker's thread; a message tells when it
// is there. path NULL: "NAME-0001.png" in the working directory, the first number that is free.
bool save_png(struct viewer *viewer, const char *path, bool with_panel); // as it is shown
// Side `side`'s film, linear, with metadata and the AOVs it has; denoised only where asked for.
bool save_exr(struct viewer *viewer, uint32_t side, const char *path, bool denoised);
bool save_scene(struct viewer *viewer, const char *path); // "save as scene JSON"

// --- reload.c ------------------------------------------------------------------------------------
bool reload_create(const struct options *options, struct reload **out, struct err *err);
// Before worker_destroy: what is being compiled ends at once. Accepts NULL.
void reload_stop(struct reload *reload);
// When no renderer is left, but before gpu_close. Accepts NULL.
void reload_destroy(struct reload *reload, struct viewer *viewer);
// Compiles on the worker's thread; then sets viewer->stage.kernels and shaders_changed. Whoever
// finds that the device refuses the new ones sets viewer->stage.kernels back to what it was.
void reload_shaders(struct viewer *viewer);
bool reload_can_compile(const struct reload *reload, const char **why_not);
const char *reload_errors(const struct reload *reload); // "file:line: …" a line; "" without any
const char *reload_folder(const struct reload *reload);

// --- watch.c -------------------------------------------------------------------------------------
bool watch_create(struct viewer *viewer, struct watch **out, struct err *err);
void watch_destroy(struct watch *watch); // accepts NULL
void watch_poll(struct viewer *viewer);  // reloads what has changed and then rested for a moment

#endif
