// The interactive viewer: what its parts share.
//
// One thread runs all of it, frame by frame (viewer_frame), but for jobs of the worker. A frame
// takes what happened (window, script), changes the scene and the cameras by it, renders for as
// long as a frame may take, and shows what there is.
#ifndef LAMPYRIS_APP_VIEWER_VIEWER_H
#define LAMPYRIS_APP_VIEWER_VIEWER_H

#include "display.h"
#include "edit.h"
#include "geometry.h"
#include "gui.h"
#include "options.h"
#include "pace.h"
#include "rig.h"
#include "screen.h"
#include "swapchain.h"
#include "view.h"
#include "window.h"
#include "worker.h"

#define VIEWER_SIDES 2u
#define VIEWER_SAVED_VIEWS 16u
#define VIEWER_NO_OBJECT UINT32_MAX

// What is seen of what is rendered. Plain data, undone as TARGET_LOOK.
struct shown {
    uint32_t what;      // SHOWN_*
    float exposure;     // stops
    uint32_t tone;      // enum tone_curve
    uint32_t automatic; // range of false colours: found from the picture
    double range[2];
    uint32_t denoise, denoise_temporal, denoise_iterations;
    uint32_t split;  // two sides
    double split_at; // part of the width
    uint32_t nearest;
    uint32_t spp_limit; // samples of a pixel after which the picture rests; 0: none
    uint32_t unused;
};

struct saved_view {
    bool is_used;
    struct camera camera;
};

struct picked {
    bool is_some;
    uint32_t object, material; // indices; VIEWER_NO_OBJECT: the surroundings
    uint32_t primitive;
    double position[3], distance;
};

// Of the last frames: what the panel tells.
struct frame_stats {
    double fps;      // over the last half second
    double frame_ms; // the last frame, all of it
    double render_ms, denoise_ms, display_ms, panel_ms, present_ms;
    uint64_t frames;
    double kernel_ms[KERNEL_COUNT]; // a frame, a running mean
    double rays_per_second, samples_per_second;
};

enum message_kind { MESSAGE_NOTE, MESSAGE_WARNING, MESSAGE_ERROR };

struct history;
struct script;
struct reload;
struct watch;

struct viewer {
    const struct options *options;
    struct progress progress; // of long work: shows it in the window, and asks to stop when closed
    struct gpu gpu;
    struct window window;
    struct swapchain swapchain;
    struct gpu_screen screen;
    struct gui gui;
    struct display display;
    struct worker *worker;
    struct history *history;
    struct script *script; // NULL without --script
    struct reload *reload;
    struct watch *watch; // NULL without --watch

    // The scene, as edited.
    char scene_path[SURROUNDINGS_PATH_MAX];
    bool has_scene;
    struct scene scene;
    struct scene pristine; // as loaded: copies of the arrays that are edited, for scene_write
    struct arena pristine_arena;
    struct surroundings_original original;
    struct surroundings surroundings;
    struct arena surroundings_arena;
    struct geometry geometry;
    double load_seconds;

    struct camera camera;  // of all sides
    uint32_t camera_index; // of the scene's, that it began with
    struct rig rig;
    struct saved_view saved[VIEWER_SAVED_VIEWS];
    bool is_moving;       // the camera moved in the last frames
    double moved_seconds; // clock of the last movement
    struct view sides[VIEWER_SIDES];
    uint32_t side_count;
    uint32_t edited_side; // whose method the panel shows
    struct shown shown;
    struct picked picked;
    uint32_t chosen_material, chosen_light, chosen_object; // in the panel's lists
    struct pace pace;
    struct frame_stats stats;
    bool is_panel_shown;
    bool is_paused;
    bool wants_quit;
    int exit_code; // of what ended it, EXIT_CODE_*

    enum change changes[VIEWER_SIDES]; // asked for in this frame, by side
    bool shaders_changed;              // reload.c made new kernels
    const struct kernel_set *kernels;  // of reload.c; NULL: the embedded ones
    uint64_t start_ns, frame_ns;       // clock; of the frame that runs
    enum message_kind message_kind;
    char message[1024];
    double message_seconds;   // clock: when it came
    struct arena frame_arena; // emptied in every frame
};

// --- viewer.c ------------------------------------------------------------------------------------
// Runs until it is closed, the script ends or a signal comes; returns the exit code.
int viewer_run(const struct options *options);
// One turn of the loop. False: it cannot go on.
bool viewer_frame(struct viewer *viewer, struct err *err);
// What has to be done anew before the next samples; both sides, or one.
void viewer_changed(struct viewer *viewer, enum change change);
void viewer_side_changed(struct viewer *viewer, uint32_t side, enum change change);
void viewer_message(struct viewer *viewer, enum message_kind kind, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
double viewer_seconds(const struct viewer *viewer); // since it began
// The size of the picture at rest: the window's.
void viewer_picture_size(const struct viewer *viewer, uint32_t *width, uint32_t *height);
// Draws a frame with a progress bar, from inside of long work; at most ten a second.
void viewer_show_progress(struct viewer *viewer, const char *phase, double fraction);

// --- load.c --------------------------------------------------------------------------------------
// Replaces the scene; on failure the old one stays, with a message. keep_view: camera, methods and
// what is shown stay as they are (reloading).
bool viewer_open_scene(struct viewer *viewer, const char *path, bool keep_view);
void viewer_close_scene(struct viewer *viewer);
// Does what `changes` asks for. False: the device failed.
bool viewer_apply_changes(struct viewer *viewer, struct err *err);
// After a lost device: opens it again and creates everything anew. False: it could not be had.
bool viewer_recover(struct viewer *viewer, struct err *err);

// --- keys.c --------------------------------------------------------------------------------------
// Keys and mouse of the picture, not of the panel. `held` state inside; also gamepad-like repeat.
void viewer_event(struct viewer *viewer, const struct event *event);
void viewer_move_camera(struct viewer *viewer, double seconds); // by what is held
struct key_help {
    const char *keys, *help;
};
extern const struct key_help viewer_keys[]; // ended by {NULL}: for the panel and the manual

// --- pick.c --------------------------------------------------------------------------------------
// What is seen at a pixel of the window. False: the device failed.
bool viewer_pick(struct viewer *viewer, double x, double y, struct picked *out, struct err *err);

// --- panel.c -------------------------------------------------------------------------------------
void panel_draw(struct viewer *viewer);

// --- save.c --------------------------------------------------------------------------------------
// Both take the picture as it is now and write it on the worker's thread; a message tells when it
// is there. path NULL: "NAME-0001.png" in the working directory, the first number that is free.
bool save_png(struct viewer *viewer, const char *path, bool with_panel); // as it is shown
// Side `side`'s film, linear, with metadata and the AOVs it has; denoised only where asked for.
bool save_exr(struct viewer *viewer, uint32_t side, const char *path, bool denoised);
bool save_scene(struct viewer *viewer, const char *path); // "save as scene JSON"

// --- script.c ------------------------------------------------------------------------------------
bool script_open(const char *path, struct script **out, struct err *err);
void script_close(struct script *script); // accepts NULL
// Before the frame's events are read: pushes what is due. False: a command failed (err: file, line,
// what was expected), or the script ended (viewer->wants_quit is set then, and err is empty).
bool script_step(struct script *script, struct viewer *viewer, struct err *err);

// --- reload.c ------------------------------------------------------------------------------------
bool reload_create(const struct options *options, struct reload **out, struct err *err);
void reload_destroy(struct reload *reload, struct viewer *viewer); // accepts NULL
void reload_shaders(struct viewer *viewer); // on the worker's thread; sets viewer->kernels
bool reload_can_compile(const struct reload *reload, const char **why_not);
const char *reload_errors(const struct reload *reload); // "file:line: …" a line; "" without any
const char *reload_folder(const struct reload *reload);

// --- watch.c -------------------------------------------------------------------------------------
bool watch_create(struct viewer *viewer, struct watch **out, struct err *err);
void watch_destroy(struct watch *watch); // accepts NULL
void watch_poll(struct viewer *viewer);  // reloads what has changed and then rested for a moment

#endif
