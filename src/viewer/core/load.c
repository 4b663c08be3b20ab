// Opens and closes scenes.
#include "viewer/core/load.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/log.h"
#include "cli/options.h"
#include "cli/scene_options.h"
#include "scene/json/scene_write.h"
#include "viewer/core/changes.h"
#include "viewer/core/exposure.h"
#include "viewer/core/frame.h"
#include "viewer/core/messages.h"
#include "viewer/core/save.h"
#include "viewer/core/viewer.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

// Sets the options for a scene. Options of the command line apply only to the scene that is named
// there.
static void set_options(struct viewer *viewer, const char *path)
{
    const struct options *given = viewer->shell.options;
    struct scene_options *options = &viewer->document.scene_options;
    bool is_given = given->argument_count > 0 && strcmp(given->arguments[0], path) == 0;
    *options = given->scene;
    options->path = path;
    if (is_given)
        return;
    options->overrides = NULL;
    options->override_count = 0;
    options->camera = options->gltf_scene = options->animation = options->variant = NULL;
    options->environment = (struct environment_option){0};
    options->anisotropy = true;
    options->environment_strength = options->at_seconds = NAN;
    options->aperture_mm = options->focus_distance = NAN;
    options->environment_rotate_degrees = 0.0;
}

// A newly loaded scene. It is complete before the old one is closed.
struct opened {
    struct scene scene, pristine;
    struct arena pristine_arena;
    struct geometry geometry;
    struct scene_load_params params;
    uint32_t camera;
};

struct geometry_params viewer_geometry_params(const struct viewer *viewer,
                                              const struct scene *scene,
                                              const struct camera *camera)
{
    const struct device_options *options = &viewer->shell.options->device;
    return (struct geometry_params){
        .scene = scene,
        .bvh = options->bvh,
        .instancing = options->instances,
        .bvh_cache = options->bvh_cache,
        .progress = &viewer->shell.progress,
        .camera = camera,
    };
}

static void forget(struct opened *opened)
{
    geometry_finish(&opened->geometry);
    arena_finish(&opened->pristine_arena);
    scene_finish(&opened->scene);
}

static bool open_scene(struct viewer *viewer, struct opened *out, struct err *err)
{
    const struct scene_options *options = &viewer->document.scene_options;
    const struct progress *progress = &viewer->shell.progress;
    *out = (struct opened){.params = options_scene_params(options, progress)};
    if (!scene_load(&out->params, &out->scene, err))
        return false;
    out->scene.progress = out->params.progress = NULL;
    bool ok = scene_snapshot(&out->pristine_arena, &out->scene, &out->pristine, err) &&
              options_adapt_scene(options, progress, &out->scene, &out->camera, err);
    if (ok) {
        viewer_picture_size(viewer, &out->scene.settings.width, &out->scene.settings.height);
        scene_frame_camera(&out->scene);
        struct geometry_params params =
            viewer_geometry_params(viewer, &out->scene, &out->scene.cameras[out->camera]);
        ok = geometry_create(&params, &out->geometry, err);
    }
    if (ok && progress_should_stop(progress))
        ok = err_set(err, ERR_STOPPED, "%s: loading was stopped", out->params.path);
    if (!ok)
        forget(out);
    return ok;
}

static void set_methods(struct viewer *viewer)
{
    const struct device_options *options = &viewer->shell.options->device;
    struct method method;
    // Clears padding, too, because methods are compared byte by byte.
    memset(&method, 0, sizeof method);
    method.settings = viewer->document.scene.settings;
    method.wave = options->wave;
    method.workgroup = options->workgroup;
    method.compile_all = options->features == FEATURES_ALL;
    method.merge_classes = options->classes == CLASSES_MERGED;
    for (uint32_t side = 0; side < VIEWER_SIDES; side++)
        viewer->stage.sides[side].method = method;
}

void viewer_find_bounds(struct viewer *viewer)
{
    const struct flat_scene *flat = &viewer->document.geometry.flat;
    const double low[3] = {flat->bounds_min[0], flat->bounds_min[1], flat->bounds_min[2]};
    const double high[3] = {flat->bounds_max[0], flat->bounds_max[1], flat->bounds_max[2]};
    flat_to_world(flat, low, viewer->document.bounds_min);
    flat_to_world(flat, high, viewer->document.bounds_max);
}

// Makes the camera orbit the centre of a model that has no camera of its own, because models are
// viewed from all sides.
static void orbit_model(struct viewer *viewer)
{
    if (!viewer->document.scene.camera_is_framed ||
        !(viewer->document.bounds_min[0] <= viewer->document.bounds_max[0]))
        return;
    viewer->view.rig.mode = CAMERA_RIG_ORBIT;
    for (int c = 0; c < 3; c++)
        viewer->view.rig.target[c] =
            0.5 * viewer->document.bounds_min[c] + 0.5 * viewer->document.bounds_max[c];
    viewer->view.wants_target = false;
}

void viewer_go_home(struct viewer *viewer)
{
    struct camera camera = viewer->document.scene.cameras[viewer->view.camera_index];
    if (viewer->document.scene.camera_is_framed) {
        struct scene fitted = viewer->document.scene; // only the camera is changed in this copy
        fitted.cameras = &camera;
        viewer_picture_size(viewer, &fitted.settings.width, &fitted.settings.height);
        scene_frame_camera(&fitted);
        orbit_model(viewer);
    }
    edit_camera(viewer, &camera, "camera.reset");
}

// Sets the initial view as the scene and the command line say.
static void set_view(struct viewer *viewer)
{
    const struct settings *settings = &viewer->document.scene.settings;
    viewer->view.camera = viewer->document.scene.cameras[viewer->view.camera_index];
    viewer->view.wants_target = true;
    frame_budget_init(&viewer->view.pace, viewer->view.pace.target_ms);
    camera_rig_init(&viewer->view.rig, &viewer->view.camera, viewer->document.bounds_min,
                    viewer->document.bounds_max);
    orbit_model(viewer);
    memset(viewer->view.saved, 0, sizeof viewer->view.saved);
    set_methods(viewer);
    viewer->stage.shown.exposure = settings->exposure;
    viewer->stage.shown.exposure_is_auto = settings->exposure_is_auto;
    viewer_begin_exposure(viewer);
    viewer->stage.shown.tone = settings->tone_curve;
    viewer->stage.shown.spp_limit =
        options_given(viewer->shell.options, OPTION_SPP) ? (uint32_t)settings->spp : 0;
}

// Replaces the names of the cameras in the current and the saved views, because the old scene,
// which owned these names, has been freed.
static void rename_cameras(struct viewer *viewer)
{
    const char *name = viewer->document.scene.cameras[viewer->view.camera_index].name;
    viewer->view.camera.name = name;
    for (uint32_t i = 0; i < VIEWER_SAVED_VIEWS; i++)
        viewer->view.saved[i].camera.name = name;
}

static void set_title(struct viewer *viewer)
{
    char title[256];
    snprintf(title, sizeof title, "%s - Lampyris", path_name(viewer->document.scene_path));
    window_set_title(&viewer->shell.window, title);
}

static void adopt(struct viewer *viewer, const struct opened *opened, bool keep_view)
{
    viewer_close_scene(viewer);
    viewer->document.scene = opened->scene;
    viewer->document.pristine = opened->pristine;
    viewer->document.pristine_arena = opened->pristine_arena;
    viewer->document.geometry = opened->geometry;
    viewer->document.load_params = opened->params;
    viewer->view.camera_index = opened->camera;
    viewer->document.original = surroundings_keep(&viewer->document.scene);
    viewer->document.surroundings = surroundings_default();
    viewer->document.has_scene = true;
    pose_init(viewer);
    set_title(viewer);
    viewer_find_bounds(viewer);
    if (keep_view)
        rename_cameras(viewer);
    else
        set_view(viewer);
    viewer_changed(viewer, CHANGE_METHOD);
}

bool viewer_load_scene(struct viewer *viewer, const char *path, bool keep_view, struct err *err)
{
    const struct scene_options before = viewer->document.scene_options;
    char old_path[sizeof viewer->document.scene_path];
    struct opened opened;
    uint64_t start = clock_ns();
    if (strlen(path) >= sizeof viewer->document.scene_path)
        return err_set(err, ERR_INPUT, "a path of %zu bytes: expected fewer than %zu", strlen(path),
                       sizeof viewer->document.scene_path);
    memcpy(old_path, viewer->document.scene_path, sizeof old_path);
    memmove(viewer->document.scene_path, path, strlen(path) + 1);
    set_options(viewer, viewer->document.scene_path);
    if (!open_scene(viewer, &opened, err)) {
        memcpy(viewer->document.scene_path, old_path, sizeof old_path);
        viewer->document.scene_options = before;
        return false;
    }
    adopt(viewer, &opened, keep_view && viewer->document.has_scene);
    viewer->document.load_seconds = clock_seconds_since(start);
    for (uint32_t i = 0; i < viewer->document.scene.note_count; i++)
        log_info("%s", viewer->document.scene.notes[i]);
    return true;
}

bool viewer_open_scene(struct viewer *viewer, const char *path, bool keep_view)
{
    struct err err = {0};
    if (viewer->shell.puts_off) {
        snprintf(viewer->document.wanted_path, sizeof viewer->document.wanted_path, "%s", path);
        viewer->document.wanted_keeps_view = keep_view;
        return true;
    }
    if (viewer_load_scene(viewer, path, keep_view, &err)) {
        viewer_message(viewer, MESSAGE_NOTE, "%s %s in %.2f s", keep_view ? "reloaded" : "opened",
                       viewer->document.scene_path, viewer->document.load_seconds);
        return true;
    }
    viewer_message(viewer, MESSAGE_ERROR, "%s", err.msg);
    return false;
}

void viewer_close_scene(struct viewer *viewer)
{
    save_waiting_scene(viewer, true);
    if (viewer->shell.worker) {
        rebuild_cancel(viewer);
        pose_finish(viewer);
    }
    for (uint32_t side = 0; side < VIEWER_SIDES; side++)
        viewer_close_side(viewer, side);
    history_clear(viewer->document.history);
    geometry_finish(&viewer->document.geometry);
    arena_finish(&viewer->document.surroundings_arena);
    arena_finish(&viewer->document.pristine_arena);
    scene_finish(&viewer->document.scene);
    if (viewer->stage.display.gpu)
        display_forget(&viewer->stage.display);
    viewer->document.pristine = (struct scene){0};
    viewer->document.has_scene = viewer->stage.has_kept = false;
    viewer->document.picked = (struct picked){0};
    viewer->document.chosen_material = viewer->document.chosen_light =
        viewer->document.chosen_object = 0;
    viewer->document.has_choice = false;
}
