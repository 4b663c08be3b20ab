// liblampyris: the path tracer as a C library. This header is its reference; docs/library.md has
// examples. C11 and C++17.
//
//   struct lampyris_context *context;
//   struct lampyris_scene *scene;
//   struct lampyris_render *render;
//   lampyris_context_create(NULL, &context);
//   lampyris_scene_load(context, "cornell.json", NULL, &scene);
//   lampyris_render_begin(scene, "{\"spp\": 64}", NULL, &render);
//   lampyris_render_step(render, NULL, NULL);
//   lampyris_render_save(render, "cornell.exr", NULL);
//
// The bits of a picture are those of `lampyris render` with the same scene and settings on the same
// device and driver: whatever the steps, the callbacks and the threads.
//
// Errors: functions return a status, which is the exit code of the command line.
// lampyris_context_error() says more. An object that was to be made is NULL then.
//
// Structs that are passed begin with their size, which the caller sets to sizeof: a later library
// then knows which members there are. Zero means the default of every other member. Of a struct
// that is filled in, members that an older library does not know are left as they were.
//
// Threads: one thread at a time may use a context and all that was made from it. Several threads
// may use one context each, at the same time: they share no state but the process's memory budget
// (memory_bytes) and what the Vulkan driver shares. Callbacks are called in the thread that called
// the library, but a log's, which worker threads of that call may call, one at a time. A callback
// must not call functions of its own context; those of another are allowed.
//
// The library never exits, prints (unless there is no log), handles signals, or changes the locale,
// the working directory or the environment. It reads the variables of the Vulkan loader and, for
// tests of fallbacks, LAMPYRIS_LIMITS.
//
// Ownership: who creates releases; every release accepts NULL. The order does not matter: a context
// lives until what was made from it is released, and so does the geometry of a scene that is being
// rendered. Texts that are passed are copied; paths and texts are UTF-8 and end with NUL.
//
// Units: metres, radiance in W/(sr m^2) in linear Rec. 709 primaries, seconds.
#ifndef LAMPYRIS_LAMPYRIS_H
#define LAMPYRIS_LAMPYRIS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && defined(LAMPYRIS_BUILDS_LIBRARY)
#define LAMPYRIS_API __declspec(dllexport)
#elif defined(_WIN32)
#define LAMPYRIS_API __declspec(dllimport)
#else
#define LAMPYRIS_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

enum lampyris_status {
    LAMPYRIS_OK = 0,
    LAMPYRIS_INPUT = 2,  // an argument, a file or a document; memory beyond the budget
    LAMPYRIS_DEVICE = 3, // the device, its driver or the system; a fault of the library
    LAMPYRIS_OUTPUT = 4, // a file that was to be written
    LAMPYRIS_NO_VULKAN = 69,
    LAMPYRIS_STOPPED = 130 // a callback asked to stop
};

// The library's version, "0.1.0".
LAMPYRIS_API const char *lampyris_version(void);

// --- contexts ------------------------------------------------------------------------------------
// A context is a device, a log and the last error. The device is opened by the first render.

struct lampyris_context;

enum lampyris_log_level {
    LAMPYRIS_LOG_ERROR,
    LAMPYRIS_LOG_WARNING,
    LAMPYRIS_LOG_NOTE,
    LAMPYRIS_LOG_DEBUG
};

struct lampyris_context_params {
    size_t size;
    const char *device; // index or part of a name; NULL: the fastest kind
    // Called with one line without a newline. NULL: warnings go to standard error.
    void (*log)(void *user, enum lampyris_log_level level, const char *message);
    void *user;
    enum lampyris_log_level log_level; // with `log`: up to and including this level
    // The limit for the host's memory of all contexts of the process, in bytes; 0: as it was, at
    // first none.
    uint64_t memory_bytes;
    bool validation; // with Vulkan's validation layers, whose messages go to the log
};

// params NULL: defaults.
LAMPYRIS_API enum lampyris_status
lampyris_context_create(const struct lampyris_context_params *params,
                        struct lampyris_context **out);
LAMPYRIS_API void lampyris_context_release(struct lampyris_context *context);

// The last error of a context. Texts are valid until the next call with this context, and "" where
// there is nothing to say.
struct lampyris_error {
    size_t size;
    enum lampyris_status status;
    const char *message;  // a sentence for people: file, place, value, what was expected
    const char *file;     // the file that is wrong
    const char *place;    // in a document: a JSON pointer, "/materials/white/roughness"
    const char *expected; // the part of the message that says what was expected: "[0, 1]"
};

LAMPYRIS_API void lampyris_context_error(const struct lampyris_context *context,
                                         struct lampyris_error *out);

// Texts are valid as long as the context.
struct lampyris_device {
    size_t size;
    const char *name, *driver;
    const char *kind;      // "discrete GPU", "integrated GPU", "virtual GPU", "CPU", "other"
    const char *unusable;  // "", or what it lacks
    uint64_t memory_bytes; // of its largest heap
    bool is_cpu;
};

// Lists the devices of the machine. *count is 0 after an error.
LAMPYRIS_API enum lampyris_status lampyris_device_count(struct lampyris_context *context,
                                                        uint32_t *count);
LAMPYRIS_API enum lampyris_status lampyris_device_at(struct lampyris_context *context,
                                                     uint32_t index, struct lampyris_device *out);

// --- progress ------------------------------------------------------------------------------------

struct lampyris_moment {
    size_t size;
    const char *phase; // "Loading", "Building BVH", "Compiling", "Rendering" ...
    double fraction;   // of the phase that is over, in [0, 1]; 0 while it is not known
    uint64_t samples;  // that every pixel has
    double seconds;    // of rendering
    uint64_t rays;
};

struct lampyris_progress {
    size_t size;
    // Called often: while rendering after every wave, of at most about a tenth of a second on a
    // GPU. false: stop. The call in progress then returns LAMPYRIS_STOPPED soon, after the wave in
    // flight.
    bool (*report)(void *user, const struct lampyris_moment *moment);
    void *user;
};

// --- scenes --------------------------------------------------------------------------------------
// A scene is a document (docs/scene-format.md) or a model. It is read when it is first needed, and
// after every change: what is wrong in it is found by lampyris_scene_check() and
// lampyris_render_begin().

struct lampyris_scene;

struct lampyris_scene_params {
    size_t size;
    // Overrides "KEY=VALUE" as for `lampyris render -D`; ended by NULL. NULL: none.
    const char *const *overrides;
    bool allow_outside_paths; // files may name files outside of their own folder
    bool is_strict;           // a missing image is an error instead of pink
};

// Loads .json, .gltf, .glb, .obj or .ply. params NULL: defaults.
LAMPYRIS_API enum lampyris_status lampyris_scene_load(struct lampyris_context *context,
                                                      const char *path,
                                                      const struct lampyris_scene_params *params,
                                                      struct lampyris_scene **out);
// Takes a document as text. Paths in it are relative to `folder`; NULL: the working directory.
LAMPYRIS_API enum lampyris_status lampyris_scene_parse(struct lampyris_context *context,
                                                       const char *json, const char *folder,
                                                       const struct lampyris_scene_params *params,
                                                       struct lampyris_scene **out);
LAMPYRIS_API void lampyris_scene_release(struct lampyris_scene *scene);

// Reads, changes and removes a value of the document by a JSON pointer (RFC 6901): "" is all of it,
// "/materials/white/base_color/0" a number, "/shapes/-" the place behind the last shape. A model
// has the document {"lampyris": 1, "base": {"file": ...}}, whose "edits" change it. Objects on the
// way to a value that is set are made where there are none. Overrides are applied to the document
// before it is read, and do not stand in it.
//
// The text is released by lampyris_text_release().
LAMPYRIS_API enum lampyris_status lampyris_scene_get(struct lampyris_scene *scene,
                                                     const char *pointer, char **json);
LAMPYRIS_API enum lampyris_status lampyris_scene_set(struct lampyris_scene *scene,
                                                     const char *pointer, const char *json);
LAMPYRIS_API enum lampyris_status lampyris_scene_remove(struct lampyris_scene *scene,
                                                        const char *pointer);
LAMPYRIS_API void lampyris_text_release(char *text);

// Triangles in arrays. Strides are the distances in bytes from one element to the next; 0: without
// gaps. No alignment is required.
struct lampyris_mesh {
    size_t size;
    uint32_t vertex_count, triangle_count;
    const void *positions; // three floats a vertex, metres
    size_t position_stride;
    const void *normals; // three floats a vertex, of any length; NULL: those of the triangles
    size_t normal_stride;
    const void *uvs; // two floats a vertex, as in glTF: (0, 0) is a picture's upper left corner
    size_t uv_stride;
    const void *colors; // four floats a vertex, linear RGBA, which scale the material's; or NULL
    size_t color_stride;
    const void *indices; // three uint32_t a triangle; NULL: vertices 3 i, 3 i + 1, 3 i + 2
    size_t index_stride;
    const char *material; // name of a material of the document; NULL: grey
    // The arrays are not copied, but read whenever the scene is: the caller keeps them until the
    // scene is released or the mesh of this name is replaced. false: they are copied now.
    bool is_borrowed;
};

// Adds a mesh and, unless there is one of this name already, the shape
// {"type": "mesh", "array": NAME, "name": NAME, "material": ...} at the end of the document's
// "shapes", where a "transform" may be set. A mesh of the same name is replaced; `material` then
// has no effect. Names have letters, digits, "_" and "-".
LAMPYRIS_API enum lampyris_status lampyris_scene_add_mesh(struct lampyris_scene *scene,
                                                          const char *name,
                                                          const struct lampyris_mesh *mesh);

// Reads the scene now, to find what is wrong in it.
LAMPYRIS_API enum lampyris_status lampyris_scene_check(struct lampyris_scene *scene,
                                                       const struct lampyris_progress *progress);

// --- renders -------------------------------------------------------------------------------------

struct lampyris_render;

// Prepares a render on the context's device; later changes of the scene do not concern it. Several
// renders may be under way. `settings` is a JSON object, NULL: {}. Its keys, all optional:
//   the keys of a scene file's "film" and "settings": "width", "height", "spp", "seed",
//       "max_bounces", "mis" ..., which replace the file's;
//   "error": the render ends when its local relMSE is below this, or at "spp" if that is given;
//   "seconds": it ends after this time of rendering;
//   "adaptive": true: tiles have numbers of samples of their own, by their error;
//   "camera": the name or the index of a camera of the scene;
//   "aov": a list of layers besides the radiance, as for `lampyris render --aov`;
//   "resume": a checkpoint that the render goes on from.
// The goal of these decides how samples are planned, and is that of steps without another one.
LAMPYRIS_API enum lampyris_status lampyris_render_begin(struct lampyris_scene *scene,
                                                        const char *settings,
                                                        const struct lampyris_progress *progress,
                                                        struct lampyris_render **out);
LAMPYRIS_API void lampyris_render_release(struct lampyris_render *render);

// The goals of a step, which ends at the first that is reached. All count from the beginning of the
// render.
struct lampyris_goal {
    size_t size;
    uint64_t samples; // per pixel; 0: as many as `seconds` and `error` take
    double seconds;   // of rendering; 0: no limit
    double error;     // upper bound of the local relMSE; 0: none
};

// Renders until the goal, or that of the settings (goal NULL), is reached. Returns at once if it is
// already. After LAMPYRIS_STOPPED the film has what was rendered so far, and the next step goes on:
// it ends the pass over the picture that was stopped, which may take more samples than its goal.
// After LAMPYRIS_DEVICE it has the last film that was read, if any, and no step is possible.
// Adaptive renders have no other goal than that of their settings.
LAMPYRIS_API enum lampyris_status lampyris_render_step(struct lampyris_render *render,
                                                       const struct lampyris_goal *goal,
                                                       const struct lampyris_progress *progress);

// The state of a render. Texts are valid until the next step of the render.
struct lampyris_state {
    size_t size;
    uint32_t width, height;
    uint64_t samples;                // per pixel; the mean where pixels have different numbers
    uint64_t samples_total;          // of all pixels
    uint64_t pixels_without_samples; // black
    uint64_t samples_dropped;        // had a contribution that was not finite
    const char *ended_by; // what ended the last step: "spp", "time", "error", "signal" (a
                          // callback), "device", "memory"; "" before the first
    double seconds_load, seconds_bvh, seconds_upload, seconds_compile, seconds_render;
    double seconds_judge; // reading the film and estimating its error
    double seconds_write;
    uint64_t rays_closest, rays_shadow;
    // The local relMSE of the picture, estimated from two halves of the samples
    // (docs/convergence.md). Blind to bias. NAN where it is not known.
    double error, error_low, error_high; // with its 95 % interval
    double error_at_most;                // the upper end of a one-sided interval of 95 %
    const char *error_why;               // why there is no interval; "" where there is
    uint64_t hash;                       // of the radiance: equal for equal bits
};

// Reads the film from the device, and judges it, unless that was done since the last step.
LAMPYRIS_API enum lampyris_status lampyris_render_state(struct lampyris_render *render,
                                                        struct lampyris_state *out);

// Texts are valid until the next step.
struct lampyris_layer {
    size_t size;
    const char *name;       // "radiance", "albedo", "depth", "half_a" ...
    uint32_t channel_count; // 1 to 3
    const char *channels;   // their names, separated by commas: "R,G,B", "X,Y,Z", "object,material"
    bool is_integer;        // uint32_t, else float
};

// "radiance" comes first. LAMPYRIS_INPUT from the number of layers on.
LAMPYRIS_API enum lampyris_status lampyris_render_layer(struct lampyris_render *render,
                                                        uint32_t index, struct lampyris_layer *out);
// Copies a layer to the caller's memory: channels side by side, 4 bytes each, rows from the top.
// Strides are the distances in bytes between pixels and between rows; 0: without gaps.
LAMPYRIS_API enum lampyris_status lampyris_render_read(struct lampyris_render *render,
                                                       const char *layer, void *to,
                                                       size_t pixel_stride, size_t row_stride);

struct lampyris_save_params {
    size_t size;
    bool half_float; // EXR: 16 bits a value
};

// Writes .exr, with the layers and how it was made, or .png. An older file stays intact if that
// fails. params NULL: defaults.
LAMPYRIS_API enum lampyris_status lampyris_render_save(struct lampyris_render *render,
                                                       const char *path,
                                                       const struct lampyris_save_params *params);
// Writes a checkpoint, from which "resume" and `lampyris render --checkpoint PATH --resume` go on.
LAMPYRIS_API enum lampyris_status lampyris_render_checkpoint(struct lampyris_render *render,
                                                             const char *path);
// The command that renders the same bits. "" if there is none: of a scene in memory, or of a film
// whose pixels have different numbers of samples. Valid until the next step.
LAMPYRIS_API enum lampyris_status lampyris_render_repeat(struct lampyris_render *render,
                                                         const char **command);

// A part that kernels may have: a feature, a lobe, a kind of emitter, a kernel, a buffer.
struct lampyris_part {
    size_t size;
    const char *kind, *name;
    const char *reason; // why it is left out; "" where it is not
    uint64_t bytes;     // of a buffer: that it has, or would have
    bool is_left_out;   // the scene does not need it
};

// LAMPYRIS_INPUT from the number of parts on.
LAMPYRIS_API enum lampyris_status lampyris_render_part(struct lampyris_render *render,
                                                       uint32_t index, struct lampyris_part *out);

// --- pictures ------------------------------------------------------------------------------------

struct lampyris_picture;

// Reads .exr, .hdr, .png or .jpg as linear RGB. layer: of an EXR file; NULL: the radiance.
LAMPYRIS_API enum lampyris_status lampyris_picture_load(struct lampyris_context *context,
                                                        const char *path, const char *layer,
                                                        struct lampyris_picture **out);
LAMPYRIS_API void lampyris_picture_release(struct lampyris_picture *picture);
// Interleaved RGB, rows from the top, without gaps; valid as long as the picture.
LAMPYRIS_API const float *lampyris_picture_pixels(const struct lampyris_picture *picture,
                                                  uint32_t *width, uint32_t *height);

// A measure with its 95 % interval over tiles of the picture.
struct lampyris_interval {
    double value, low, high;
};

// docs/comparing.md has the formulas. NAN without a pixel that is finite in both.
struct lampyris_metrics {
    size_t size;
    struct lampyris_interval mse, relmse, local_relmse;
    double smape, psnr, ssim, flip, hdr_flip;
    double max;                // greatest |x - r| of a channel
    uint64_t pixels_nonfinite; // in either picture; left out
    uint64_t pixels_differing; // not bit-equal
};

// Compares with a reference: both are interleaved RGB without gaps, of width x height pixels.
LAMPYRIS_API enum lampyris_status lampyris_compare(struct lampyris_context *context,
                                                   const float *picture, const float *reference,
                                                   uint32_t width, uint32_t height,
                                                   struct lampyris_metrics *out);

#ifdef __cplusplus
}
#endif

#endif
