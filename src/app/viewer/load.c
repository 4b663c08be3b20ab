// Scenes come and go, and what was changed takes effect.
#include "viewer.h"

#include "clock.h"
#include "file.h"
#include "log.h"
#include "render_job.h"
#include "scene_write.h"
#include "tuned.h"
#include <stdio.h>
#include <string.h>

// How long after the last change the picture is taken for resting, seconds: between two steps of a
// hand on the mouse there is less.
#define REST_SECONDS 0.15
#define SPEED_PART 0.5 // of the distance to what is seen, a second

uint32_t viewer_aovs(const struct shown *shown)
{
    bool denoises = shown->denoise && shown->what == SHOWN_RADIANCE;
    return display_aovs(shown->what) | (denoises ? DENOISE_AOVS : 0);
}

void viewer_changed(struct viewer *viewer, enum change change)
{
    for (uint32_t side = 0; side < VIEWER_SIDES; side++)
        viewer_side_changed(viewer, side, change);
}

void viewer_side_changed(struct viewer *viewer, uint32_t side, enum change change)
{
    if (change > viewer->changes[side])
        viewer->changes[side] = change;
    if (change >= CHANGE_CAMERA)
        viewer->sides[side].changed_seconds = viewer_seconds(viewer);
    viewer->is_resting = false;
}

// --- scenes --------------------------------------------------------------------------------------

// What the command line says of its own scene says nothing of another one.
static void set_options(struct viewer *viewer, const char *path)
{
    const struct options *given = viewer->options;
    struct options *options = &viewer->scene_options;
    bool is_given = given->argument_count > 0 && strcmp(given->arguments[0], path) == 0;
    *options = *given;
    options->arguments[0] = path;
    options->argument_count = 1;
    options->progress = &viewer->progress;
    if (is_given)
        return;
    options->overrides = NULL;
    options->override_count = 0;
    options->camera = options->scene = options->animation = options->variant = NULL;
    options->environment = (struct environment_option){0};
    static const enum option_id others[] = {OPTION_ENV, OPTION_ENV_ROTATE, OPTION_ENV_STRENGTH,
                                            OPTION_AT,  OPTION_APERTURE,   OPTION_FOCUS_DISTANCE};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        options->given[others[i]] = false;
    options->environment_rotate_degrees = 0.0;
}

// All of a scene that is there before the old one goes.
struct opened {
    struct scene scene, pristine;
    struct arena pristine_arena;
    struct geometry geometry;
    struct scene_load_params params;
    uint32_t camera;
};

static struct geometry_params geometry_params(const struct viewer *viewer,
                                              const struct scene *scene)
{
    const struct options *options = &viewer->scene_options;
    return (struct geometry_params){
        .scene = scene,
        .bvh = {options->bvh, options->node, options->bvh_optimize},
        .instancing = options->instances,
        .bvh_cache = options->bvh_cache,
        .progress = &viewer->progress,
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
    const struct options *options = &viewer->scene_options;
    *out = (struct opened){.params = job_scene_params(options)};
    if (!scene_load(&out->params, &out->scene, err))
        return false;
    out->scene.progress = out->params.progress = NULL;
    bool ok = scene_snapshot(&out->pristine_arena, &out->scene, &out->pristine, err) &&
              job_adapt_scene(options, &out->scene, &out->camera, err);
    if (ok) {
        viewer_picture_size(viewer, &out->scene.settings.width, &out->scene.settings.height);
        scene_frame_camera(&out->scene);
        struct geometry_params params = geometry_params(viewer, &out->scene);
        ok = geometry_create(&params, &out->geometry, err);
    }
    if (ok && progress_should_stop(&viewer->progress))
        ok = err_set(err, ERR_STOPPED, "%s: loading was stopped", out->params.path);
    if (!ok)
        forget(out);
    return ok;
}

static void set_methods(struct viewer *viewer)
{
    const struct options *options = &viewer->scene_options;
    struct method method;
    memset(&method, 0, sizeof method); // all bytes: they are compared
    method.settings = viewer->scene.settings;
    method.wave = options->wave;
    method.workgroup = options->workgroup;
    method.everything = options->features == FEATURES_ALL;
    method.merge_classes = options->classes == CLASSES_MERGED;
    for (uint32_t side = 0; side < VIEWER_SIDES; side++)
        viewer->sides[side].method = method;
}

static void find_bounds(struct viewer *viewer)
{
    const struct flat_scene *flat = &viewer->geometry.flat;
    for (int c = 0; c < 3; c++) {
        viewer->bounds_min[c] = (double)flat->bounds_min[c] + flat->origin[c];
        viewer->bounds_max[c] = (double)flat->bounds_max[c] + flat->origin[c];
    }
}

// As the scene and the command line say.
static void set_view(struct viewer *viewer)
{
    const struct settings *settings = &viewer->scene.settings;
    viewer->camera = viewer->scene.cameras[viewer->camera_index];
    viewer->wants_target = true;
    pace_init(&viewer->pace, viewer->pace.target_ms);
    rig_init(&viewer->rig, &viewer->camera, viewer->bounds_min, viewer->bounds_max);
    memset(viewer->saved, 0, sizeof viewer->saved);
    set_methods(viewer);
    viewer->shown.exposure = settings->exposure;
    viewer->shown.tone = settings->tone_curve;
    viewer->shown.spp_limit =
        options_given(viewer->options, OPTION_SPP) ? (uint32_t)settings->spp : 0;
}

// Cameras that outlive the scene that they came with.
static void rename_cameras(struct viewer *viewer)
{
    const char *name = viewer->scene.cameras[viewer->camera_index].name;
    viewer->camera.name = name;
    for (uint32_t i = 0; i < VIEWER_SAVED_VIEWS; i++)
        viewer->saved[i].camera.name = name;
}

static void set_title(struct viewer *viewer)
{
    char title[256];
    snprintf(title, sizeof title, "%s - Lampyris", path_name(viewer->scene_path));
    window_set_title(&viewer->window, title);
}

static void adopt(struct viewer *viewer, const struct opened *opened, bool keep_view)
{
    viewer_close_scene(viewer);
    viewer->scene = opened->scene;
    viewer->pristine = opened->pristine;
    viewer->pristine_arena = opened->pristine_arena;
    viewer->geometry = opened->geometry;
    viewer->load_params = opened->params;
    viewer->camera_index = opened->camera;
    viewer->original = surroundings_keep(&viewer->scene);
    viewer->surroundings = surroundings_default();
    viewer->has_scene = true;
    set_title(viewer);
    find_bounds(viewer);
    if (keep_view)
        rename_cameras(viewer);
    else
        set_view(viewer);
    viewer_changed(viewer, CHANGE_METHOD);
}

bool viewer_load_scene(struct viewer *viewer, const char *path, bool keep_view, struct err *err)
{
    const struct options before = viewer->scene_options;
    char old_path[sizeof viewer->scene_path];
    struct opened opened;
    uint64_t start = clock_ns();
    if (strlen(path) >= sizeof viewer->scene_path)
        return err_set(err, ERR_INPUT, "a path of %zu bytes: expected fewer than %zu", strlen(path),
                       sizeof viewer->scene_path);
    memcpy(old_path, viewer->scene_path, sizeof old_path);
    memmove(viewer->scene_path, path, strlen(path) + 1);
    set_options(viewer, viewer->scene_path);
    if (!open_scene(viewer, &opened, err)) {
        memcpy(viewer->scene_path, old_path, sizeof old_path);
        viewer->scene_options = before;
        return false;
    }
    adopt(viewer, &opened, keep_view && viewer->has_scene);
    viewer->load_seconds = clock_seconds_since(start);
    for (uint32_t i = 0; i < viewer->scene.note_count; i++)
        log_info("%s", viewer->scene.notes[i]);
    return true;
}

bool viewer_open_scene(struct viewer *viewer, const char *path, bool keep_view)
{
    struct err err = {0};
    if (viewer->puts_off) {
        snprintf(viewer->wanted_path, sizeof viewer->wanted_path, "%s", path);
        viewer->wanted_keeps_view = keep_view;
        return true;
    }
    if (viewer_load_scene(viewer, path, keep_view, &err)) {
        viewer_message(viewer, MESSAGE_NOTE, "%s %s in %.2f s", keep_view ? "reloaded" : "opened",
                       viewer->scene_path, viewer->load_seconds);
        return true;
    }
    viewer_message(viewer, MESSAGE_ERROR, "%s", err.msg);
    return false;
}

void viewer_close_scene(struct viewer *viewer)
{
    for (uint32_t side = 0; side < VIEWER_SIDES; side++)
        viewer_close_side(viewer, side);
    history_clear(viewer->history);
    geometry_finish(&viewer->geometry);
    arena_finish(&viewer->surroundings_arena);
    arena_finish(&viewer->pristine_arena);
    scene_finish(&viewer->scene);
    if (viewer->display.gpu)
        display_forget(&viewer->display);
    viewer->pristine = (struct scene){0};
    viewer->has_scene = viewer->has_kept = false;
    viewer->picked = (struct picked){0};
    viewer->chosen_material = viewer->chosen_light = viewer->chosen_object = 0;
}

// --- sides ---------------------------------------------------------------------------------------

void viewer_close_side(struct viewer *viewer, uint32_t side)
{
    struct view *view = &viewer->sides[side];
    denoiser_finish(&view->denoiser);
    renderer_finish(&view->renderer);
    view->denoiser = (struct denoiser){0};
    view->is_ready = view->is_preview = false;
    view_begin(view);
}

// The viewer's scene as this side renders it.
static void settle_scene(struct viewer *viewer, struct view *view)
{
    uint32_t limit = viewer->shown.spp_limit;
    view->scene = viewer->scene;
    view->scene.settings = view->method.settings;
    viewer_picture_size(viewer, &view->scene.settings.width, &view->scene.settings.height);
    if (limit > 0)
        view->scene.settings.spp = limit;
    view->scene.cameras = &viewer->camera;
    view->scene.camera_count = 1;
}

static bool build_side(struct viewer *viewer, struct view *view, struct err *err)
{
    const struct method *method = &view->method;
    struct tuned tuned = tuned_sizes(&viewer->scene_options, &viewer->gpu);
    view->is_ready = false;
    renderer_finish(&view->renderer);
    settle_scene(viewer, view);
    const struct renderer_params params = {
        .gpu = &viewer->gpu,
        .scene = &view->scene,
        .geometry = &viewer->geometry,
        .kernels = viewer->kernels,
        .wave = method->wave ? method->wave : tuned.wave,
        .wave_is_wish = !method->wave,
        .workgroup = method->workgroup ? method->workgroup : tuned.workgroup,
        .aovs = viewer_aovs(&viewer->shown),
        .everything = method->everything,
        .merge_classes = method->merge_classes,
        .open_ended = viewer->shown.spp_limit == 0,
        .progress = &viewer->progress,
    };
    if (!renderer_create(&params, &view->renderer, err))
        return false;
    view->renderer.progress = &viewer->frame_progress;
    view->seen = view->renderer.stats;
    view->usual_wave = view->renderer.plan.wave_slots;
    view->is_ready = true;
    view->is_preview = false;
    return true;
}

static bool keep_history(struct viewer *viewer, struct view *view, struct err *err)
{
    const struct denoise_call call = {
        .renderer = &view->renderer,
        .camera = &view->renderer.camera,
        .iterations = viewer->shown.denoise_iterations,
        .temporal = viewer->shown.denoise_temporal,
    };
    bool has_something = view->denoiser.gpu && view_samples(view) > 0;
    return !has_something || denoiser_keep(&view->denoiser, &call, err);
}

// The film is emptied, for the camera as it is now and a picture of that size.
static bool look_anew(struct viewer *viewer, struct view *view, const uint32_t size[2],
                      struct err *err)
{
    bool fits;
    if (!keep_history(viewer, view, err) ||
        !renderer_look(&view->renderer, &viewer->camera, size[0], size[1], &fits, err))
        return false;
    if (fits)
        return true;
    return build_side(viewer, view, err) &&
           renderer_look(&view->renderer, &viewer->camera, size[0], size[1], &fits, err) &&
           (fits || err_set(err, ERR_BUG, "a new renderer does not take its own camera"));
}

static bool is_changing(const struct viewer *viewer, const struct view *view)
{
    return viewer_seconds(viewer) - view->changed_seconds < REST_SECONDS;
}

static bool wants_preview(const struct viewer *viewer, const struct view *view)
{
    return viewer->pace.shrink > 1 && is_changing(viewer, view);
}

static bool keep_picture(struct viewer *viewer, struct err *err)
{
    struct display_call call;
    viewer_display_call(viewer, &call);
    viewer->has_kept = call.side_count > 0;
    return !viewer->has_kept || display_keep(&viewer->display, &call, err);
}

static bool update_denoiser(struct viewer *viewer, struct view *view, enum change change,
                            struct err *err)
{
    if (!viewer->shown.denoise) {
        denoiser_finish(&view->denoiser);
        view->denoiser = (struct denoiser){0};
        return true;
    }
    if (!view->denoiser.gpu)
        return denoiser_create(&viewer->gpu, &view->denoiser, err);
    if (change >= CHANGE_METHOD)
        denoiser_forget(&view->denoiser);
    return true;
}

// From a small picture to a sharp one: until that has samples, the small one is shown.
static bool sharpens(const struct viewer *viewer, uint32_t side)
{
    const struct view *view = &viewer->sides[side];
    return view->is_ready && view->is_preview && viewer->changes[side] < CHANGE_CAMERA &&
           !wants_preview(viewer, view);
}

// While it changes all the time a picture keeps its size, but for good reason.
static void wanted_size(const struct viewer *viewer, const struct view *view, bool keeps_size,
                        uint32_t size[2])
{
    viewer_picture_size(viewer, &size[0], &size[1]);
    if (!wants_preview(viewer, view))
        return;
    for (int i = 0; i < 2; i++)
        size[i] = pace_shrunk(size[i], viewer->pace.shrink);
    if (!keeps_size)
        return;
    size[0] = view->renderer.frame.width;
    size[1] = view->renderer.frame.height;
}

// Brings a side to where the changes and the clock want it: built anew, looking elsewhere, small
// while it changes, or at full size when it rests.
static bool update_side(struct viewer *viewer, uint32_t side, struct err *err)
{
    struct view *view = &viewer->sides[side];
    enum change change = viewer->changes[side];
    bool is_small = wants_preview(viewer, view);
    bool is_to_build = !view->is_ready || change >= CHANGE_METHOD;
    uint32_t size[2];
    if (is_to_build && !build_side(viewer, view, err))
        return false;
    bool is_small_already = !is_to_build && change < CHANGE_CAMERA && view->is_preview;
    wanted_size(viewer, view, is_small_already, size);
    const struct gpu_frame *frame = &view->renderer.frame;
    bool looks = frame->width != size[0] || frame->height != size[1] || change == CHANGE_CAMERA;
    if (looks && !look_anew(viewer, view, size, err))
        return false;
    if (looks || is_to_build) {
        view_begin(view);
        for (uint32_t i = 0; i < VIEWER_SIDES; i++)
            viewer->sides[i].turn_seconds = 0.0;
    }
    view->is_preview = is_small;
    return update_denoiser(viewer, view, change, err);
}

// --- changes -------------------------------------------------------------------------------------

static bool refresh_geometry(struct viewer *viewer, struct err *err)
{
    struct geometry_params params = geometry_params(viewer, &viewer->scene);
    for (uint32_t side = 0; side < VIEWER_SIDES; side++) { // they use what is replaced
        renderer_finish(&viewer->sides[side].renderer);
        viewer->sides[side].is_ready = false;
    }
    if (!geometry_refresh(&params, &viewer->geometry, err))
        return false;
    find_bounds(viewer);
    return true;
}

static bool apply(struct viewer *viewer, struct err *err)
{
    enum change most = CHANGE_NONE;
    for (uint32_t side = 0; side < VIEWER_SIDES; side++)
        most = viewer->changes[side] > most ? viewer->changes[side] : most;
    if (most >= CHANGE_TABLES && !refresh_geometry(viewer, err))
        return false;
    uint32_t width, height;
    viewer_picture_size(viewer, &width, &height);
    viewer->side_count = viewer->shown.split ? VIEWER_SIDES : 1;
    pace_choose(&viewer->pace, width, height * viewer->side_count);
    if (most >= CHANGE_CAMERA)
        viewer->has_kept = false;
    bool has_to_keep = false;
    for (uint32_t side = 0; side < viewer->side_count; side++)
        has_to_keep |= sharpens(viewer, side);
    if (has_to_keep && !keep_picture(viewer, err))
        return false;
    for (uint32_t side = 0; side < viewer->side_count; side++)
        if (!update_side(viewer, side, err))
            return false;
    for (uint32_t side = viewer->side_count; side < VIEWER_SIDES; side++)
        viewer_close_side(viewer, side);
    viewer->is_moving = false;
    for (uint32_t side = 0; side < viewer->side_count; side++)
        viewer->is_moving |= is_changing(viewer, &viewer->sides[side]);
    for (uint32_t side = 0; side < VIEWER_SIDES; side++)
        viewer->changes[side] = CHANGE_NONE;
    return true;
}

// What cannot be had is undone; the rest of the scene is as it was, but has to be built again.
static bool apply_reverted(struct viewer *viewer, struct err *err)
{
    struct err reason = *err;
    bool has_bad_kernels = viewer->kernels != viewer->good_kernels;
    if (viewer->gpu.lost || err->code == ERR_STOPPED || !(has_bad_kernels || edit_revert(viewer)))
        return false;
    viewer->kernels = viewer->good_kernels;
    viewer_message(viewer, MESSAGE_ERROR, "%s: %s",
                   has_bad_kernels ? "the kernels stay as they were" : "undone", reason.msg);
    viewer_changed(viewer, CHANGE_GEOMETRY);
    *err = (struct err){0};
    return apply(viewer, err);
}

// What the middle of the picture shows is what the camera turns about, and tells how fast to fly.
static bool aim_rig(struct viewer *viewer, struct err *err)
{
    struct rig *rig = &viewer->rig;
    struct picked picked;
    viewer->wants_target = false;
    if (!viewer_pick(viewer, 0.5 * viewer->window.width, 0.5 * viewer->window.height, &picked, err))
        return false;
    if (picked.object == VIEWER_NO_OBJECT || !(picked.distance > 0.0))
        return true;
    memcpy(rig->target, picked.position, sizeof rig->target);
    rig->speed = SPEED_PART * picked.distance;
    return true;
}

bool viewer_apply_changes(struct viewer *viewer, struct err *err)
{
    if (viewer->wanted_path[0]) {
        char path[sizeof viewer->wanted_path];
        memcpy(path, viewer->wanted_path, sizeof path);
        viewer->wanted_path[0] = '\0';
        viewer_open_scene(viewer, path, viewer->wanted_keeps_view);
    }
    if (viewer->shaders_changed)
        viewer_changed(viewer, CHANGE_METHOD);
    viewer->shaders_changed = false;
    if (!viewer->has_scene)
        return true;
    if (!apply(viewer, err) && !apply_reverted(viewer, err))
        return false;
    if (viewer->wants_target && !aim_rig(viewer, err))
        return false;
    edit_settle(viewer);
    viewer->good_kernels = viewer->kernels;
    return true;
}
