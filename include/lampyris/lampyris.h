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
// A picture has the same bits as the picture of `lampyris render` with the same scene and settings
// on the same device and driver. The bits do not depend on steps, callbacks or the number of
// threads.
//
// Errors: functions return a status, whose value is the exit code of the command line program.
// lampyris_context_error() returns the details. A function that fails to make an object sets the
// caller's pointer to NULL.
//
// Structs begin with the member `size`, which the caller sets to sizeof the struct. It tells a
// later version of the library which members the caller knows. In any other member, zero means the
// default value. If the library fills in a struct, it leaves members that it does not know
// unchanged.
//
// Threads: a context, and all objects made from it, may be used by one thread at a time. Several
// threads may each use a context of their own at the same time: contexts share only the process's
// memory budget (memory_bytes) and what the Vulkan driver shares. Callbacks are called by the
// thread that called the library. The only exception is the log, which worker threads of that call
// may also call, one at a time. A callback must not call functions of its own context, but may call
// those of other contexts.
//
// The library never exits, handles signals, or changes the locale, the working directory or the
// environment. It prints only if a context has no log. It reads the environment variables of the
// Vulkan loader and, for tests of fallbacks, LAMPYRIS_LIMITS.
//
// Ownership: the caller releases each object that it created; all release functions accept NULL.
// The order does not matter: a context stays alive until all objects made from it are released, and
// a scene's geometry until all its renders are. Strings passed to the library are copied. All
// strings, including paths, are UTF-8 and end with NUL.
//
// Units: metres, seconds, and radiance in W/(sr m^2) in linear Rec. 709 primaries.
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
    LAMPYRIS_INPUT = 2,  // a wrong argument, file or document, or more memory needed than the
                         // budget
    LAMPYRIS_DEVICE = 3, // a failure of the device, its driver or the system, or a bug of the
                         // library
    LAMPYRIS_OUTPUT = 4, // a file could not be written
    LAMPYRIS_NO_VULKAN = 69,
    LAMPYRIS_STOPPED = 130 // a callback requested a stop
};

// Returns the library's version, such as "0.1.0".
LAMPYRIS_API const char *lampyris_version(void);

// --- contexts ------------------------------------------------------------------------------------
// A context holds a device, a log and the last error. The first render opens the device.

struct lampyris_context;

enum lampyris_log_level {
    LAMPYRIS_LOG_ERROR,
    LAMPYRIS_LOG_WARNING,
    LAMPYRIS_LOG_NOTE,
    LAMPYRIS_LOG_DEBUG
};

struct lampyris_context_params {
    size_t size;
    const char *device; // index or part of a name; NULL: the first device of the fastest kind
    // The library calls `log` with one line, without a newline. NULL: warnings are printed to
    // standard error.
    void (*log)(void *user, enum lampyris_log_level level, const char *message);
    void *user;
    enum lampyris_log_level log_level; // the least important level that is passed to `log`
    // The limit, in bytes, for the host memory of all contexts of the process. 0 leaves the limit
    // unchanged; at first there is no limit.
    uint64_t memory_bytes;
    bool validation; // enables Vulkan's validation layers, whose messages go to the log
};

// `params` may be NULL, for the defaults.
LAMPYRIS_API enum lampyris_status
lampyris_context_create(const struct lampyris_context_params *params,
                        struct lampyris_context **out);
LAMPYRIS_API void lampyris_context_release(struct lampyris_context *context);

// The last error of a context. Strings are valid until the next call with this context. They are ""
// if there is nothing to report.
struct lampyris_error {
    size_t size;
    enum lampyris_status status;
    const char *message;  // for people: the file, the place, the wrong value and what was expected
    const char *file;     // the file that has the error
    const char *place;    // place of the error in the document, as a JSON pointer:
                          // "/materials/white/roughness"
    const char *expected; // the part of the message that says what was expected: "[0, 1]"
};

LAMPYRIS_API void lampyris_context_error(const struct lampyris_context *context,
                                         struct lampyris_error *out);

// A device of the machine. Strings are valid as long as the context exists.
struct lampyris_device {
    size_t size;
    const char *name, *driver;
    const char *kind;      // "discrete GPU", "integrated GPU", "virtual GPU", "CPU", "other"
    const char *unusable;  // "", or why the renderer cannot use the device
    uint64_t memory_bytes; // size of the device's largest device-local heap
    bool is_cpu;
};

// Returns the number of devices of the machine; *count is 0 after an error.
LAMPYRIS_API enum lampyris_status lampyris_device_count(struct lampyris_context *context,
                                                        uint32_t *count);
LAMPYRIS_API enum lampyris_status lampyris_device_at(struct lampyris_context *context,
                                                     uint32_t index, struct lampyris_device *out);

// --- progress ------------------------------------------------------------------------------------

struct lampyris_moment {
    size_t size;
    const char *phase; // "Loading", "Building BVH", "Compiling", "Rendering" ...
    double fraction;   // completed fraction of the phase, in [0, 1]; 0 if it is not known
    uint64_t samples;  // samples per pixel so far
    double seconds;    // rendering time so far
    uint64_t rays;
};

struct lampyris_progress {
    size_t size;
    // The library calls `report` often: while rendering, after every wave, which takes at most
    // about a tenth of a second on a GPU. Return false to request a stop. The call in progress then
    // returns LAMPYRIS_STOPPED as soon as the current wave has ended.
    bool (*report)(void *user, const struct lampyris_moment *moment);
    void *user;
};

// --- scenes --------------------------------------------------------------------------------------
// A scene is a document (docs/scene-format.md) or a model. The library reads it when it is first
// needed, and again after each change. So errors in a scene are reported by lampyris_scene_check()
// and lampyris_render_begin().

struct lampyris_scene;

struct lampyris_scene_params {
    size_t size;
    // Overrides "KEY=VALUE", as for `lampyris render -D`, ended by NULL. NULL: no overrides.
    const char *const *overrides;
    bool allow_outside_paths; // the scene may refer to files outside its own folder
    bool is_strict;           // a missing image is an error; otherwise its texture is pink
};

// Loads a .json, .gltf, .glb, .obj, .ply or .stl file. `params` may be NULL, for the defaults.
LAMPYRIS_API enum lampyris_status lampyris_scene_load(struct lampyris_context *context,
                                                      const char *path,
                                                      const struct lampyris_scene_params *params,
                                                      struct lampyris_scene **out);
// Parses a document. Paths in it are relative to `folder`; NULL: to the working directory.
LAMPYRIS_API enum lampyris_status lampyris_scene_parse(struct lampyris_context *context,
                                                       const char *json, const char *folder,
                                                       const struct lampyris_scene_params *params,
                                                       struct lampyris_scene **out);
LAMPYRIS_API void lampyris_scene_release(struct lampyris_scene *scene);

// The following functions read, change and remove a value of the document. A JSON pointer (RFC
// 6901) names the value: "" is the whole document, "/materials/white/base_color/0" a number, and
// "/shapes/-" the place after the last shape. The document of a model is {"lampyris": 1, "base":
// {"file": ...}}; its "edits" change the model. lampyris_scene_set() creates missing objects on the
// way to the value. Overrides are applied when the document is read; the document itself does not
// contain them.
//
// The caller releases the text *json by lampyris_text_release().
LAMPYRIS_API enum lampyris_status lampyris_scene_get(struct lampyris_scene *scene,
                                                     const char *pointer, char **json);
LAMPYRIS_API enum lampyris_status lampyris_scene_set(struct lampyris_scene *scene,
                                                     const char *pointer, const char *json);
LAMPYRIS_API enum lampyris_status lampyris_scene_remove(struct lampyris_scene *scene,
                                                        const char *pointer);
LAMPYRIS_API void lampyris_text_release(char *text);

// A triangle mesh in arrays. A stride is the distance in bytes from one element to the next; 0
// means no gaps. The arrays need no alignment.
struct lampyris_mesh {
    size_t size;
    uint32_t vertex_count, triangle_count;
    const void *positions; // three floats per vertex, in metres
    size_t position_stride;
    const void *normals; // three floats per vertex, of any length; NULL: the normals of the
                         // triangles
    size_t normal_stride;
    const void *uvs; // two floats per vertex, as in glTF: (0, 0) is an image's upper left corner
    size_t uv_stride;
    const void *colors; // four floats per vertex, linear RGBA, which scale the material's colour;
                        // may be NULL
    size_t color_stride;
    const void *indices; // three uint32_t per triangle; NULL: triangle i has vertices 3 i, 3 i + 1,
                         // 3 i + 2
    size_t index_stride;
    const char *material; // name of a material in the document; NULL: a grey material
    // If true, the arrays are not copied, and are read each time the scene is read: the caller must
    // keep them until the scene is released or the mesh of this name is replaced. If false, they
    // are copied in this call.
    bool is_borrowed;
};

// Adds a mesh. If no mesh has this name yet, also adds the shape {"type": "mesh", "array": NAME,
// "name": NAME, "material": ...} at the end of the document's "shapes"; a "transform" may be set
// there. Otherwise replaces the mesh of this name, and ignores `material`. A name consists of
// letters, digits, "_" and "-".
LAMPYRIS_API enum lampyris_status lampyris_scene_add_mesh(struct lampyris_scene *scene,
                                                          const char *name,
                                                          const struct lampyris_mesh *mesh);

// Reads the scene now, so that errors in it are found.
LAMPYRIS_API enum lampyris_status lampyris_scene_check(struct lampyris_scene *scene,
                                                       const struct lampyris_progress *progress);

// --- renders -------------------------------------------------------------------------------------

struct lampyris_render;

// Prepares a render on the context's device. Later changes of the scene do not affect it. Several
// renders may exist at the same time. `settings` is a JSON object; NULL means {}. All its keys are
// optional:
//   the keys of a scene file's "film" and "settings", such as "width", "height", "spp", "seed",
//       "max_bounces" and "mis": they replace the file's values;
//   "error": the render ends when its local relMSE is below this, at the latest after "spp" samples
//       if "spp" is given;
//   "seconds": the render ends after this rendering time;
//   "adaptive": if true, each tile gets a number of samples according to its error;
//   "camera": the name or the index of one of the scene's cameras;
//   "aov": a list of layers in addition to the radiance, as for `lampyris render --aov`;
//   "resume": the path of a checkpoint from which the render continues.
// "spp", "error" and "seconds" are the render's goal. Samplers that need the number of samples in
// advance use it, and it is the goal of steps that have no goal of their own.
LAMPYRIS_API enum lampyris_status lampyris_render_begin(struct lampyris_scene *scene,
                                                        const char *settings,
                                                        const struct lampyris_progress *progress,
                                                        struct lampyris_render **out);
LAMPYRIS_API void lampyris_render_release(struct lampyris_render *render);

// The goal of a step. The step ends when the first of its limits is reached; all are counted from
// the beginning of the render.
struct lampyris_goal {
    size_t size;
    uint64_t samples; // samples per pixel; 0: limited only by `seconds` and `error`
    double seconds;   // rendering time; 0: no limit
    double error;     // upper bound of the local relMSE; 0: no limit
};

// Renders until the goal is reached. If `goal` is NULL, the goal of the settings applies. Returns
// at once if the goal has been reached already. After LAMPYRIS_STOPPED the film has the samples
// rendered so far, and the next step continues: it completes the interrupted pass over the picture,
// so it may render more samples than its goal. After LAMPYRIS_DEVICE no further step is possible;
// the film is then the last one that was read from the device, if any. Adaptive renders can only
// have the goal of their settings.
LAMPYRIS_API enum lampyris_status lampyris_render_step(struct lampyris_render *render,
                                                       const struct lampyris_goal *goal,
                                                       const struct lampyris_progress *progress);

// The state of a render. Strings are valid until the render's next step.
struct lampyris_state {
    size_t size;
    uint32_t width, height;
    uint64_t samples;                // samples per pixel; their mean if pixels have different
                                     // numbers
    uint64_t samples_total;          // sum over all pixels
    uint64_t pixels_without_samples; // pixels that are still black because they have no samples
    uint64_t samples_dropped;        // samples with a contribution that was not finite
    const char *ended_by; // what ended the last step: "spp", "time", "error", "signal" (a
                          // callback), "device" or "memory"; "" before the first step
    double seconds_load, seconds_bvh, seconds_upload, seconds_compile, seconds_render;
    double seconds_judge; // time for reading the film and estimating its error
    double seconds_write;
    uint64_t rays_closest, rays_shadow;
    // The local relMSE of the picture, estimated from two halves of the samples
    // (docs/convergence.md). The estimate does not include bias. NAN if it is not known.
    double error, error_low, error_high; // the estimate and its 95 % confidence interval
    double error_at_most;                // upper end of the one-sided 95 % confidence interval
    const char *error_why;               // why there is no interval; "" if there is one
    uint64_t hash;                       // hash of the radiance; equal bits have equal hashes
};

// Returns the state. If a step was made since the last call, reads the film from the device first
// and estimates its error.
LAMPYRIS_API enum lampyris_status lampyris_render_state(struct lampyris_render *render,
                                                        struct lampyris_state *out);

// A layer of the picture. Strings are valid until the next step.
struct lampyris_layer {
    size_t size;
    const char *name;       // "radiance", "albedo", "depth", "half_a" ...
    uint32_t channel_count; // 1 to 3
    const char *channels;   // names of the channels, separated by commas: "R,G,B", "X,Y,Z",
                            // "object,material"
    bool is_integer;        // values are uint32_t; otherwise float
};

// Describes a layer. Layer 0 is "radiance". Returns LAMPYRIS_INPUT if there is no layer `index`.
LAMPYRIS_API enum lampyris_status lampyris_render_layer(struct lampyris_render *render,
                                                        uint32_t index, struct lampyris_layer *out);
// Copies a layer to the caller's memory, rows from the top. The channels of a pixel are adjacent
// and have 4 bytes each. A stride is the distance in bytes between pixels or between rows; 0 means
// no gaps.
LAMPYRIS_API enum lampyris_status lampyris_render_read(struct lampyris_render *render,
                                                       const char *layer, void *to,
                                                       size_t pixel_stride, size_t row_stride);

struct lampyris_save_params {
    size_t size;
    bool half_float; // EXR: 16 bits per value
};

// Writes the picture as .exr, .png, .jpg, .hdr or .pfm; only .exr contains the layers. All but .pfm
// contain metadata about the render. If writing fails, an older file stays intact. `params` may be
// NULL, for the defaults.
LAMPYRIS_API enum lampyris_status lampyris_render_save(struct lampyris_render *render,
                                                       const char *path,
                                                       const struct lampyris_save_params *params);
// Writes a checkpoint. A render continues from it with the setting "resume", or by the command line
// `lampyris render --checkpoint PATH --resume`.
LAMPYRIS_API enum lampyris_status lampyris_render_checkpoint(struct lampyris_render *render,
                                                             const char *path);
// Returns the command line that renders the same bits, valid until the next step. It is "" if there
// is none, for a scene in memory or a film whose pixels have different numbers of samples.
LAMPYRIS_API enum lampyris_status lampyris_render_repeat(struct lampyris_render *render,
                                                         const char **command);

// A part of the renderer: a feature, a lobe, a kind of emitter, a kernel or a buffer.
struct lampyris_part {
    size_t size;
    const char *kind, *name;
    const char *reason; // why it is left out; "" if it is not left out
    uint64_t bytes;     // size of a buffer; if it is left out, the size that it would have
    bool is_left_out;   // left out because the scene does not need it
};

// Describes a part. Returns LAMPYRIS_INPUT if there is no part `index`.
LAMPYRIS_API enum lampyris_status lampyris_render_part(struct lampyris_render *render,
                                                       uint32_t index, struct lampyris_part *out);

// --- pictures ------------------------------------------------------------------------------------

struct lampyris_picture;

// Reads an .exr, .hdr, .pfm, .png or .jpg file as linear RGB. `layer` names a layer of an EXR file;
// NULL: the radiance.
LAMPYRIS_API enum lampyris_status lampyris_picture_load(struct lampyris_context *context,
                                                        const char *path, const char *layer,
                                                        struct lampyris_picture **out);
LAMPYRIS_API void lampyris_picture_release(struct lampyris_picture *picture);
// Returns the pixels, interleaved RGB, rows from the top, without gaps. The pixels are valid as
// long as the picture exists.
LAMPYRIS_API const float *lampyris_picture_pixels(const struct lampyris_picture *picture,
                                                  uint32_t *width, uint32_t *height);

// A metric with its 95 % confidence interval, estimated from tiles of the picture.
struct lampyris_interval {
    double value, low, high;
};

// Error metrics; docs/comparing.md has the formulas. NAN if no pixel is finite in both pictures.
struct lampyris_metrics {
    size_t size;
    struct lampyris_interval mse, relmse, local_relmse;
    double smape, psnr, ssim, flip, hdr_flip;
    double max;                // greatest |x - r| of a channel
    uint64_t pixels_nonfinite; // pixels that are not finite in either picture; they are not
                               // compared
    uint64_t pixels_differing; // pixels whose bits differ
};

// Compares a picture with a reference: interleaved RGB, width x height pixels each, without gaps.
LAMPYRIS_API enum lampyris_status lampyris_compare(struct lampyris_context *context,
                                                   const float *picture, const float *reference,
                                                   uint32_t width, uint32_t height,
                                                   struct lampyris_metrics *out);

#ifdef __cplusplus
}
#endif

#endif
