// What the files of the library share: its objects, and how a call begins and ends.
#ifndef LAMPYRIS_LIBRARY_LIBRARY_H
#define LAMPYRIS_LIBRARY_LIBRARY_H

#include "base/c_locale.h"
#include "base/log.h"
#include "base/thread.h"
#include "job/job.h"
#include <jansson.h>
#include <lampyris/lampyris.h>
#include <stdatomic.h>

// --- context.c ---

struct lampyris_context {
    struct gpu gpu;
    struct gpu_params gpu_params;
    char *device;     // what gpu_params names; or NULL
    bool is_open;     // the device
    uint32_t refs;    // its own, and those of scenes, renders and pictures
    uint32_t renders; // that use the device
    struct lampyris_context_params params;
    struct log_target log;
    struct mutex log_mutex;
    // Of the thread, while a call is in progress.
    const struct log_target *former_log;
    struct c_locale number_format;
    bool is_busy; // a call is in progress
    struct gpu_device_info devices[GPU_MAX_DEVICES];
    uint32_t device_count; // 0: not listed yet
    struct err err;        // of the last call
    char expected[256];
    enum lampyris_status status;
};

// Begins a call: no other is in progress, and messages go to the context's log. On failure the call
// returns LAMPYRIS_INPUT.
bool library_enter(struct lampyris_context *context);
// Ends it; returns the status of context->err, which `ok` says to be none.
enum lampyris_status library_leave(struct lampyris_context *context, bool ok);
// Opens the device, if that was not done yet; one that was lost is opened again if no render uses
// it.
bool library_open_device(struct lampyris_context *context, struct err *err);
void library_unref(struct lampyris_context *context);

// Copies a struct of the caller's, which begins with its size: `from` may be NULL, and members that
// it does not have are zero. ERR_USAGE where it has more than is known here.
bool library_take(void *to, size_t size, const void *from, const char *what, struct err *err);
// Copies to a struct of the caller's the members that it has.
bool library_give(void *to, const void *from, size_t size, struct err *err);

// --- progress.c ---

// The caller's progress, as the layers below report to it.
struct library_progress {
    struct lampyris_progress user;
    struct progress progress;
    const struct job *job; // NULL: there is none yet
    _Atomic bool is_stopped;
};

bool library_progress_init(struct library_progress *out, const struct lampyris_progress *user,
                           const struct job *job, struct err *err);

// --- scene.c, scene_read.c ---

// A scene as it was read, which renders share.
struct loaded {
    struct scene scene;
    uint32_t refs;
};

struct scene_mesh {
    struct scene_array array;
    struct arena arena; // holds the copies, and the name
};

// A change of the document that the command line can make, too.
struct scene_edit {
    char *key, *value;
    struct scene_edit *next;
};

struct lampyris_scene {
    struct lampyris_context *context;
    struct arena arena;        // what lives as long as the scene
    const char *path;          // the file, or the name of the text
    const char *document_path; // that of the document: the file's, or one beside the model
    json_t *document;          // NULL: the file is not needed as one yet
    bool is_text;              // there is no file
    bool is_edited;            // the document is no longer that of the file
    bool is_model;             // the file is none of our own format
    struct scene_override *overrides;
    uint32_t override_count;
    bool allow_outside_paths, is_strict;
    struct scene_mesh *meshes;
    uint32_t mesh_count, mesh_capacity;
    struct scene_edit *edits, **last_edit;
    bool is_repeatable;    // by a command line
    struct loaded *loaded; // NULL: not read since it was changed
};

// Makes scene->document, if there is none.
bool scene_need_document(struct lampyris_scene *scene, struct err *err);
// Reads the scene, if that was not done since it was changed; *out counts as one more use.
bool scene_need(struct lampyris_scene *scene, struct library_progress *progress,
                struct loaded **out, struct err *err);
void loaded_release(struct loaded *loaded); // accepts NULL

// --- pointer.c ---

// The value that a JSON pointer (RFC 6901) leads to; NULL with *err set where there is none.
json_t *pointer_find(json_t *document, const char *pointer, struct err *err);
// Sets one; takes the reference to `value`. *is_made: objects on the way, or an element of an
// array, were added.
bool pointer_set(json_t **document, const char *pointer, json_t *value, bool *is_made,
                 struct err *err);
bool pointer_remove(json_t *document, const char *pointer, struct err *err);
// The same place as a key of -D, "materials.white.base_color[1]", in `arena`; NULL where -D cannot
// name it.
char *pointer_key(const char *pointer, struct arena *arena);

// --- settings.c ---

// What the settings of a render say besides those of the scene.
struct render_wishes {
    struct job_goal goal;
    uint32_t aovs, camera;
    const char *resume; // in the render's arena; NULL: none
};

// Reads the JSON object into the scene's settings and the wishes.
bool render_read_settings(const char *json, struct scene *scene, struct arena *arena,
                          struct render_wishes *out, struct err *err);

// --- render.c ---

struct lampyris_render {
    struct lampyris_context *context;
    struct loaded *loaded;
    struct scene adapted; // shares the arrays of `loaded`, but for cameras and settings
    struct arena arena;
    struct arena texts; // until the next step
    struct job job;
    struct render_wishes wishes;
    struct library_progress progress;
    const char *command; // that loads the scene, without settings; NULL: there is none
    bool is_judged;      // the film, since the last step
    bool has_step;
    bool is_over; // the device failed
    struct lampyris_part *parts;
    uint32_t part_count;
};

// Reads and judges the film, unless that was done since the last step.
bool render_need_film(struct lampyris_render *render, struct err *err);

// --- repeat.c ---

// The beginning of the command that renders the scene, in `arena`; NULL where there is none, or no
// memory for it.
const char *repeat_begin(const struct lampyris_scene *scene, struct arena *arena);
// The command that renders the film as it is; NULL likewise.
const char *repeat_command(const struct lampyris_render *render, struct arena *arena);

#endif
