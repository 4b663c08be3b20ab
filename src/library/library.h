// Declarations that the library's files share: its objects, and how a call begins and ends.
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
    char *device;     // owns params.device; may be NULL
    bool is_open;     // the device is open
    uint32_t refs;    // one for the caller, and one for each scene, render and picture
    uint32_t renders; // number of renders, each of which uses the device
    struct lampyris_context_params params;
    struct log_target log;
    struct mutex log_mutex;
    // The thread's log before the call; valid while a call is in progress.
    const struct log_target *former_log;
    struct c_locale number_format;
    bool is_busy; // a call is in progress
    struct gpu_device_info devices[GPU_MAX_DEVICES];
    uint32_t device_count; // 0: not listed yet
    struct err err;        // error of the last call
    char expected[256];
    enum lampyris_status status;
};

// Begins a call and directs messages to the context's log. Returns false if another call is in
// progress; the caller then returns LAMPYRIS_INPUT.
bool library_enter(struct lampyris_context *context);
// Ends a call. Clears context->err if `ok` is set. Returns the status of the call.
enum lampyris_status library_leave(struct lampyris_context *context, bool ok);
// Opens the device if it is not open. A lost device is opened again if no render uses it.
bool library_open_device(struct lampyris_context *context, struct err *err);
void library_unref(struct lampyris_context *context);

// Copies a struct of the caller, which begins with its size, to `to`. Members that the caller's
// struct lacks become zero. If `from` is NULL, all members become zero. Fails with ERR_USAGE if the
// struct is longer than `size` and the additional members are not zero.
bool library_take(void *to, size_t size, const void *from, const char *what, struct err *err);
// Copies to the caller's struct as many members as its size covers.
bool library_give(void *to, const void *from, size_t size, struct err *err);

// --- progress.c ---

// Forwards progress reports from the layers below to the caller.
struct library_progress {
    struct lampyris_progress user;
    struct progress progress;
    const struct job *job; // NULL: there is no job yet
    _Atomic bool is_stopped;
};

bool library_progress_init(struct library_progress *out, const struct lampyris_progress *user,
                           const struct job *job, struct err *err);

// --- scene.c, scene_read.c ---

// A scene as it was last read. Renders share it; it is freed when `refs` is 0.
struct loaded {
    struct scene scene;
    uint32_t refs;
};

struct scene_mesh {
    struct scene_array array;
    struct arena arena; // owns the copied arrays and the name
};

// A change of the document that the command line can make as well, with -D.
struct scene_edit {
    char *key, *value;
    struct scene_edit *next;
};

struct lampyris_scene {
    struct lampyris_context *context;
    struct arena arena;        // owns all data that live as long as the scene
    const char *path;          // path of the scene's file; for a document given as text,
                               // "FOLDER/document.json"
    const char *document_path; // path of the document: the file itself, or a .json file beside the
                               // model
    json_t *document;          // NULL: the document has not been needed yet
    bool is_text;              // the document was given as text; there is no file
    bool is_edited;            // the document differs from the file
    bool is_model;             // the file is a model, not a scene in this program's format
    struct scene_override *overrides;
    uint32_t override_count;
    bool allow_outside_paths, is_strict;
    struct scene_mesh *meshes;
    uint32_t mesh_count, mesh_capacity;
    struct scene_edit *edits, **last_edit;
    bool is_repeatable;    // a command line can render the same scene
    struct loaded *loaded; // NULL: not read since the last change
};

// Makes scene->document if there is none.
bool scene_need_document(struct lampyris_scene *scene, struct err *err);
// Reads the scene if it has not been read since its last change. The caller releases *out with
// loaded_release().
bool scene_need(struct lampyris_scene *scene, struct library_progress *progress,
                struct loaded **out, struct err *err);
void loaded_release(struct loaded *loaded); // accepts NULL

// --- pointer.c ---

// Returns the value that a JSON pointer (RFC 6901) names. If there is none, returns NULL and sets
// *err.
json_t *pointer_find(json_t *document, const char *pointer, struct err *err);
// Sets the value that a JSON pointer names, and takes over the reference to `value`. *is_made says
// whether missing objects or an array element were added, or the whole document was replaced.
bool pointer_set(json_t **document, const char *pointer, json_t *value, bool *is_made,
                 struct err *err);
bool pointer_remove(json_t *document, const char *pointer, struct err *err);
// Returns a JSON pointer as a key for -D, such as "materials.white.base_color[1]", in `arena`.
// Returns NULL if -D cannot name the place, or when out of memory.
char *pointer_key(const char *pointer, struct arena *arena);

// --- settings.c ---

// The settings of a render that are not settings of a scene.
struct render_wishes {
    struct job_goal goal;
    uint32_t aovs, camera;
    const char *resume; // path of a checkpoint, in the render's arena; NULL: none
};

// Reads settings from the JSON text `json`. The scene's settings are stored in *scene, all others
// in *out.
bool render_read_settings(const char *json, struct scene *scene, struct arena *arena,
                          struct render_wishes *out, struct err *err);

// --- render.c ---

struct lampyris_render {
    struct lampyris_context *context;
    struct loaded *loaded;
    struct scene adapted; // shares all arrays of `loaded` except the cameras
    struct arena arena;
    struct arena texts; // strings that are valid until the next step
    struct job job;
    struct render_wishes wishes;
    struct library_progress progress;
    const char *command; // command line that loads the scene, without settings; NULL: there is none
    bool is_judged;      // the film was read and its error estimated since the last step
    bool has_step;
    bool is_over; // the device failed; no further step is possible
    struct lampyris_part *parts;
    uint32_t part_count;
};

// Reads the film and estimates its error, unless that was done since the last step.
bool render_need_film(struct lampyris_render *render, struct err *err);

// --- repeat.c ---

// Returns the beginning of the command line that renders the scene, in `arena`. Returns NULL if
// there is none, or when out of memory.
const char *repeat_begin(const struct lampyris_scene *scene, struct arena *arena);
// Returns the command line that renders the present film, in `arena`. Returns NULL if there is
// none, or when out of memory.
const char *repeat_command(const struct lampyris_render *render, struct arena *arena);

#endif
