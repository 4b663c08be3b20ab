// Saves images and scenes. The viewer's thread copies the data of an image, which takes
// milliseconds; the worker's thread compresses and writes it.
#include "viewer/core/save.h"

#include "base/file.h"
#include "base/file_system.h"
#include "base/hash.h"
#include "cli/options.h"
#include "job/film_error.h"
#include "output/layers.h"
#include "output/metadata.h"
#include "scene/json/scene_write.h"
#include "viewer/core/frame.h"
#include "viewer/core/messages.h"
#include "viewer/core/viewer.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NUMBERS_MAX 9999u

// An image that waits to be written. Its arena owns all of its data.
struct saving {
    struct arena arena;
    const char *path; // NULL: the first free number is determined when the image is written
    const char *stem, *extension;
    struct image image;
    uint8_t (*display)[4]; // pixels of a PNG; NULL if `image` is saved
    struct layers layers;
    struct metadata metadata;
    const float (*mean)[3]; // pixels whose hash the metadata contains; NULL: no hash
};

// --- names ---------------------------------------------------------------------------------------

// Returns "box" for "folder/box.json"; files are saved in the working directory.
static char *stem_of(const struct viewer *viewer, struct arena *arena)
{
    const char *name = path_name(viewer->document.scene_path);
    const char *extension = path_extension(name);
    size_t length = strlen(name);
    if (*extension)
        length -= strlen(extension) + 1;
    return length ? arena_printf(arena, "%.*s", (int)length, name)
                  : arena_strdup(arena, "lampyris");
}

// Returns the first free name. Only one thread chooses names, so that no two images get the same
// one.
static char *free_name(struct arena *arena, const char *stem, const char *extension,
                       struct err *err)
{
    for (uint32_t number = 1; number <= NUMBERS_MAX; number++) {
        char *path = arena_printf(arena, "%s-%04u.%s", stem, number, extension);
        if (!path) {
            err_memory(err, "names of files", 0);
            return NULL;
        }
        if (!file_exists(path))
            return path;
    }
    err_set(err, ERR_OUTPUT, "%s-0001.%s to %s-%u.%s all exist; delete or rename some", stem,
            extension, stem, NUMBERS_MAX, extension);
    return NULL;
}

// --- metadata ------------------------------------------------------------------------------------

// Describes the current film of a side in the same form as `render` describes its output.
static bool describe(const struct viewer *viewer, uint32_t side, const struct film_image *film,
                     struct saving *saving, struct err *err)
{
    const struct view *view = &viewer->stage.sides[side];
    const struct render_stats *stats = &view->job.renderer.stats;
    struct settings settings = view->scene.settings;
    settings.tone_curve = (enum tone_curve)viewer->stage.shown.tone;
    const struct job_seconds seconds = {
        .load = viewer->document.load_seconds,
        .bvh = viewer->document.geometry.bvh.stats.build_seconds,
        .upload = stats->upload_seconds,
        .compile = stats->compile_seconds,
        .render = view->seconds,
    };
    const struct job_look look = view_newest_look(view);
    const struct half_error none = film_error_none("the error was not estimated");
    bool is_even = film->least_samples == film->most_samples;
    const struct metadata_params params = {
        .job = &view->job,
        .load = &viewer->document.load_params,
        .settings = &settings,
        .film = film,
        .error = look.samples == (double)film->least_samples ? &look.error : &none,
        .seconds = &seconds,
        .ended_by = is_even ? "spp" : "signal",
        .command = viewer->shell.options->command_line,
        .samples = film->most_samples,
        .exposure = viewer->stage.shown.exposure,
        .camera = viewer->view.camera_index,
    };
    layers_list(film, view->job.renderer.aovs, &saving->layers);
    return metadata_make(&params, &saving->arena, &saving->metadata, err);
}

// Adds the camera, and whether the scene was edited, which complete the description of the image's
// inputs.
static bool add_view(const struct viewer *viewer, struct saving *saving, struct err *err)
{
    char *steps = arena_printf(&saving->arena, "%u", edit_undo_count(viewer));
    return metadata_set(&saving->metadata, "lampyris:view",
                        camera_to_json(&saving->arena, &viewer->view.camera), err) &&
           metadata_set(&saving->metadata, "lampyris:edits", steps, err);
}

// --- on the worker's thread ----------------------------------------------------------------------

// Adds the FNV hash of the image. For a large image this takes as long as a frame, so it is
// computed here.
static bool set_hash(struct saving *saving, struct err *err)
{
    uint64_t pixels = (uint64_t)saving->image.width * saving->image.height;
    uint64_t hash = hash_bytes(HASH_INIT, saving->mean, pixels * sizeof *saving->mean);
    const char *text = arena_printf(&saving->arena, "%016" PRIx64, hash);
    return metadata_set(&saving->metadata, "lampyris:image_hash", text, err);
}

// Converts display values to the linear values whose sRGB encoding they are; encoding these again
// gives the same bytes.
static bool decode_display(struct saving *saving, struct err *err)
{
    float linear[256];
    uint64_t pixels = (uint64_t)saving->image.width * saving->image.height;
    for (int code = 0; code < 256; code++)
        linear[code] = image_srgb_to_linear((float)code / 255.0f);
    saving->image.pixels = arena_alloc(&saving->arena, pixels, sizeof *saving->image.pixels);
    if (!saving->image.pixels)
        return err_memory(err, "the picture", pixels * sizeof *saving->image.pixels);
    for (uint64_t i = 0; i < pixels; i++)
        for (int c = 0; c < 3; c++)
            saving->image.pixels[i][c] = linear[saving->display[i][c]];
    return true;
}

static bool write_picture(void *context, struct err *err)
{
    struct saving *saving = context;
    if (!saving->path)
        saving->path = free_name(&saving->arena, saving->stem, saving->extension, err);
    if (!saving->path || (saving->mean && !set_hash(saving, err)) ||
        (saving->display && !decode_display(saving, err)))
        return false;
    const struct image_write_params params = {
        .path = saving->path,
        .image = &saving->image,
        .layers = saving->layers.list,
        .layer_count = saving->layers.count,
        .attributes = saving->metadata.list,
        .attribute_count = saving->metadata.count,
        .tone = TONE_NONE,
    };
    return image_write(&params, err);
}

static void finish(struct saving *saving)
{
    arena_finish(&saving->arena);
    free(saving);
}

static void picture_done(void *context, void *viewer, bool ok, const struct err *err)
{
    struct saving *saving = context;
    if (ok)
        viewer_message(viewer, MESSAGE_NOTE, "wrote %s (%u x %u)", saving->path,
                       saving->image.width, saving->image.height);
    else
        viewer_message(viewer, MESSAGE_ERROR, "%s", err->msg);
    finish(saving);
}

// --- on the viewer's thread ----------------------------------------------------------------------

static struct saving *begin(const struct viewer *viewer, const char *path, const char *extension,
                            struct err *err)
{
    struct saving *saving = calloc(1, sizeof *saving);
    if (!saving) {
        err_memory(err, "the picture", sizeof *saving);
        return NULL;
    }
    saving->extension = extension;
    saving->stem = stem_of(viewer, &saving->arena);
    saving->path = path ? arena_strdup(&saving->arena, path) : NULL;
    bool ok = saving->stem && (saving->path || !path);
    if (!ok)
        err_memory(err, "names of files", 0);
    else if (path && !path_has_extension(path, extension))
        ok = err_set(err, ERR_USAGE, "%s: expected a name that ends in .%s", path, extension);
    if (ok)
        return saving;
    finish(saving);
    return NULL;
}

// Passes an image to the worker, and takes ownership of `saving`. `ok` tells whether it is
// complete.
static bool hand_over(struct viewer *viewer, struct saving *saving, bool ok, struct err *err)
{
    if (ok && !worker_add(viewer->shell.worker,
                          &(struct worker_task){"picture", write_picture, picture_done, saving}))
        ok = err_set(err, ERR_OUTPUT,
                     "not saved, because too many pictures are waiting to be written");
    if (ok)
        return true;
    if (saving)
        finish(saving);
    viewer_message(viewer, MESSAGE_ERROR, "%s", err->msg);
    return false;
}

// Draws the last image without the panel; the next frame is drawn as usual. If this fails, the
// display is unchanged.
static void draw_alone(struct viewer *viewer)
{
    struct display_call call = viewer->stage.last_call;
    const uint32_t whole[4] = {0, 0, call.width, call.height};
    struct err ignored = {0};
    if (call.side_count == 0 || memcmp(call.picture, whole, sizeof whole) == 0)
        return;
    memcpy(call.picture, whole, sizeof whole);
    if (display_draw(&viewer->stage.display, &call, &ignored))
        viewer->stage.last_call = call;
}

static bool copy_display(struct viewer *viewer, bool with_panel, struct saving *saving,
                         struct err *err)
{
    struct gpu_screen *screen = &viewer->stage.screen;
    uint64_t pixels = (uint64_t)screen->width * screen->height;
    saving->image.width = screen->width;
    saving->image.height = screen->height;
    if (!screen->is_drawn || viewer->stage.display.pixels.bytes < pixels * 4)
        return err_set(err, ERR_OUTPUT, "there is no picture yet");
    if (with_panel)
        return gpu_screen_read(&viewer->stage.gpu, screen, &saving->arena, &saving->display, err);
    draw_alone(viewer);
    saving->display = arena_alloc(&saving->arena, pixels, sizeof *saving->display);
    return saving->display ? gpu_download(&viewer->stage.gpu, &viewer->stage.display.pixels, 0,
                                          saving->display, pixels * 4, err)
                           : err_memory(err, "the picture", pixels * 4);
}

bool save_png(struct viewer *viewer, const char *path, bool with_panel)
{
    struct err err = {0};
    struct saving *saving = begin(viewer, path, "png", &err);
    bool ok = saving && copy_display(viewer, with_panel, saving, &err) &&
              (!viewer->document.has_scene || add_view(viewer, saving, &err)) &&
              metadata_set(&saving->metadata, "lampyris:version", LAMPYRIS_VERSION, &err);
    return hand_over(viewer, saving, ok, &err);
}

static bool copy_denoised(struct viewer *viewer, const struct view *view, struct saving *saving,
                          struct err *err)
{
    const struct denoiser *denoiser = &view->denoiser;
    uint64_t pixels = (uint64_t)saving->image.width * saving->image.height;
    if (!denoiser->gpu || denoiser->width != saving->image.width ||
        denoiser->height != saving->image.height)
        return err_set(err, ERR_OUTPUT, "the picture is not denoised: denoising is switched off");
    float(*four)[4] = arena_alloc(&saving->arena, pixels, sizeof *four);
    saving->image.pixels = arena_alloc(&saving->arena, pixels, sizeof *saving->image.pixels);
    if (!four || !saving->image.pixels)
        return err_memory(err, "the picture", pixels * sizeof *four);
    if (!gpu_download(&viewer->stage.gpu, &denoiser->picture, 0, four, pixels * sizeof *four, err))
        return false;
    for (uint64_t i = 0; i < pixels; i++)
        memcpy(saving->image.pixels[i], four[i], sizeof *saving->image.pixels);
    return metadata_set(&saving->metadata, "lampyris:denoised",
                        "denoised pictures are biased previews, see docs/denoising.md", err);
}

static bool copy_film(struct viewer *viewer, uint32_t side, bool denoised, struct saving *saving,
                      struct err *err)
{
    struct view *view = &viewer->stage.sides[side];
    struct film_image film;
    if (side >= viewer->stage.side_count || !view->is_ready)
        return err_set(err, ERR_OUTPUT, "there is no picture yet");
    if (!job_copy_film(&view->job, &saving->arena, &film, err) ||
        !describe(viewer, side, &film, saving, err) || !add_view(viewer, saving, err))
        return false;
    saving->image = (struct image){film.width, film.height, film.mean};
    saving->mean = (const float(*)[3])film.mean;
    return !denoised || copy_denoised(viewer, view, saving, err);
}

bool save_exr(struct viewer *viewer, uint32_t side, const char *path, bool denoised)
{
    struct err err = {0};
    struct saving *saving = begin(viewer, path, "exr", &err);
    bool ok = saving && copy_film(viewer, side, denoised, saving, &err);
    return hand_over(viewer, saving, ok, &err);
}

// Writes the scene on the viewer's own thread, because scenes are small and might be edited in the
// meantime.
static bool write_scene(struct viewer *viewer, const char *path)
{
    struct arena arena = {0};
    struct err err = {0};
    bool is_outside = false;
    bool ok = viewer->document.has_scene || err_set(&err, ERR_OUTPUT, "there is no scene to save");
    const struct view *view = &viewer->stage.sides[viewer->stage.edited_side];
    struct settings settings = view->method.settings;
    viewer_picture_size(viewer, &settings.width, &settings.height);
    settings.exposure = viewer->stage.shown.exposure;
    settings.exposure_is_auto = viewer->stage.shown.exposure_is_auto;
    settings.tone_curve = (enum tone_curve)viewer->stage.shown.tone;
    if (viewer->stage.shown.spp_limit > 0)
        settings.spp = viewer->stage.shown.spp_limit;
    if (ok && !path) {
        const char *stem = stem_of(viewer, &arena);
        path = stem ? free_name(&arena, stem, "json", &err) : NULL;
        ok = path || err.code != ERR_NONE || err_memory(&err, "names of files", 0);
    }
    const struct scene_write_params params = {
        .path = path,
        .load = &viewer->document.load_params,
        .before = &viewer->document.pristine,
        .scene = &viewer->document.scene,
        .camera = &viewer->view.camera,
        .settings = &settings,
        .is_outside = &is_outside,
        .pose = pose_has_animation(viewer) ? &viewer->document.pose.shown : NULL,
    };
    ok = ok && path && scene_write(&params, &err);
    if (ok)
        viewer_message(viewer, MESSAGE_NOTE, "wrote %s%s", path,
                       is_outside
                           ? "; the scene names files outside of its folder, so loading it needs "
                             "--allow-outside-paths"
                           : "");
    else
        viewer_message(viewer, MESSAGE_ERROR, "%s", err.msg);
    arena_finish(&arena);
    return ok;
}

// Returns whether the scene must be saved later: until the requested pose is loaded, camera and
// lights belong to another time. While an animation is playing, the displayed pose is saved.
static bool has_to_wait(const struct viewer *viewer)
{
    return pose_is_pending(viewer) && !pose_is_played(viewer);
}

bool save_scene(struct viewer *viewer, const char *path)
{
    struct document *document = &viewer->document;
    if (!has_to_wait(viewer))
        return write_scene(viewer, path);
    if (document->waits_to_save || strlen(path ? path : "") >= sizeof document->save_path) {
        viewer_message(viewer, MESSAGE_ERROR, "%s: not saved: %s", path ? path : "the scene",
                       document->waits_to_save ? "another file waits for the animation's pose"
                                               : "its path is too long");
        return false;
    }
    snprintf(document->save_path, sizeof document->save_path, "%s", path ? path : "");
    document->waits_to_save = true;
    return true;
}

void save_waiting_scene(struct viewer *viewer, bool at_once)
{
    struct document *document = &viewer->document;
    if (!document->waits_to_save || (!at_once && has_to_wait(viewer)))
        return;
    document->waits_to_save = false;
    write_scene(viewer, document->save_path[0] ? document->save_path : NULL);
}
