// Applies changes at the least cost.
#include "viewer/core/changes.h"

#include "viewer/core/frame.h"
#include "viewer/core/load.h"
#include "viewer/core/messages.h"
#include "viewer/core/pick.h"
#include "viewer/core/rebuild.h"
#include "viewer/core/save.h"
#include "viewer/core/viewer.h"
#include <math.h>
#include <string.h>

// The time in seconds after which the image counts as resting if nothing has changed. The steps of
// a mouse movement follow each other faster.
#define REST_SECONDS 0.15
#define SPEED_PART 0.5 // flying speed, in distances to the target per second

uint32_t viewer_aovs(const struct shown *shown)
{
    bool denoises = shown->denoise && shown->what == SHOWN_RADIANCE;
    uint32_t split = shown->error_by ? error_kind_aov((enum error_kind)(shown->error_by - 1)) : 0;
    return display_aovs(shown->what) | (denoises ? DENOISE_AOVS : 0) | split;
}

void viewer_changed(struct viewer *viewer, enum change change)
{
    for (uint32_t side = 0; side < VIEWER_SIDES; side++)
        viewer_side_changed(viewer, side, change);
}

void viewer_side_changed(struct viewer *viewer, uint32_t side, enum change change)
{
    if (change > viewer->stage.changes[side])
        viewer->stage.changes[side] = change;
    if (change >= CHANGE_CAMERA)
        viewer->stage.sides[side].changed_seconds = viewer_seconds(viewer);
    viewer->stage.is_resting = false;
}

// --- denoising -----------------------------------------------------------------------------------

static void finish_denoiser(struct view *view)
{
    denoiser_finish(&view->denoiser);
    view->denoiser = (struct denoiser){0};
    view->denoised_samples = 0;
}

bool viewer_stop_denoising(struct viewer *viewer, struct err *err)
{
    struct stage *stage = &viewer->stage;
    if (stage->gpu.lost || err->code != ERR_GPU)
        return false;
    viewer_message(viewer, MESSAGE_WARNING, "denoising is switched off: %s", err->msg);
    *err = (struct err){0};
    stage->gpu.out_of_memory = false;
    stage->shown.denoise = 0;
    for (uint32_t side = 0; side < VIEWER_SIDES; side++)
        finish_denoiser(&stage->sides[side]);
    stage->last_call.side_count = 0;
    viewer_changed(viewer, CHANGE_SHOWN);
    return true;
}

// --- sides ---------------------------------------------------------------------------------------

void viewer_close_side(struct viewer *viewer, uint32_t side)
{
    struct view *view = &viewer->stage.sides[side];
    finish_denoiser(view);
    motion_finish(&view->motion);
    job_finish(&view->job);
    view->is_ready = view->is_preview = false;
    viewer->stage.last_call.side_count = 0;
    view_begin(view);
}

// Keeps the current image as the denoiser's history.
static bool keep_history(struct viewer *viewer, struct view *view, struct err *err)
{
    const struct denoise_call call = view_denoise_call(viewer, view);
    // While another layer is displayed, the renderer does not compute the AOVs that denoising
    // needs.
    bool has_layers = (DENOISE_AOVS & ~view->job.renderer.specialization.aovs) == 0;
    if (!view->denoiser.gpu || !has_layers || view_samples(view) == 0)
        return true;
    // If the scene moves, a small image has less information than the history of the full-size one.
    if (view->is_preview && view->motion.has_changed && view->denoiser.has_history)
        return true;
    if (!denoiser_keep(&view->denoiser, &call, err))
        return viewer_stop_denoising(viewer, err);
    motion_keep(&view->motion);
    return true;
}

// Ends all jobs, because they use the objects that are about to be replaced.
static bool end_jobs(struct viewer *viewer, struct err *err)
{
    for (uint32_t side = 0; side < VIEWER_SIDES; side++) {
        struct view *view = &viewer->stage.sides[side];
        if (view->is_ready && !keep_history(viewer, view, err))
            return false;
        job_finish(&view->job);
        view->is_ready = false;
    }
    return true;
}

static bool refresh_geometry(struct viewer *viewer, struct err *err)
{
    struct geometry_params params =
        viewer_geometry_params(viewer, &viewer->document.scene, &viewer->view.camera);
    rebuild_cancel(viewer);
    if (!end_jobs(viewer, err) || !geometry_refresh(&params, &viewer->document.geometry, err))
        return false;
    viewer_find_bounds(viewer);
    return true;
}

// Sets view->scene to the viewer's scene with the settings of this side.
static void settle_scene(struct viewer *viewer, struct view *view)
{
    view->scene = *rebuild_scene(viewer);
    view->scene.settings = view->method.settings;
    viewer_picture_size(viewer, &view->scene.settings.width, &view->scene.settings.height);
    view->scene.cameras = &viewer->view.camera;
    view->scene.camera_count = 1;
}

static bool build_side(struct viewer *viewer, struct view *view, struct err *err)
{
    const struct method *method = &view->method;
    // The scene from which the geometry was built no longer exists, and that of the next build is
    // not ready.
    bool waits = rebuild_is_pending(viewer) && !viewer->document.rebuild.scene;
    if (waits && !refresh_geometry(viewer, err))
        return false;
    view->is_ready = false;
    job_finish(&view->job);
    settle_scene(viewer, view);
    uint32_t limit = viewer->stage.shown.spp_limit;
    const struct job_params params = {
        .renderer =
            {
                .gpu = &viewer->stage.gpu,
                .geometry = &viewer->document.geometry,
                .kernels = viewer->stage.kernels,
                .wave = method->wave,
                .workgroup = method->workgroup,
                .aovs = viewer_aovs(&viewer->stage.shown),
                .compile_all = method->compile_all,
                .merge_classes = method->merge_classes,
            },
        .scene = &view->scene,
        .goal = {.samples = limit, .seconds = limit ? 0.0 : INFINITY},
        .progress = &viewer->shell.progress,
    };
    if (!job_start(&params, &view->job, err))
        return false;
    job_set_progress(&view->job, &viewer->stage.frame_progress);
    view->seen = view->job.renderer.stats;
    view->usual_wave = view->job.renderer.plan.wave_slots;
    view->is_ready = true;
    view->is_preview = false;
    if (!motion_begin(&view->motion, &view->scene, &view->job.renderer.flat,
                      viewer->document.pose.deformations) &&
        view->denoiser.gpu)
        denoiser_forget(&view->denoiser);
    return true;
}

// Empties the film, for the current camera and an image of this size.
static bool look_anew(struct viewer *viewer, struct view *view, const uint32_t size[2],
                      struct err *err)
{
    bool fits;
    if (!keep_history(viewer, view, err) ||
        !job_set_camera(&view->job, &viewer->view.camera, size[0], size[1], &fits, err))
        return false;
    if (fits)
        return true;
    return build_side(viewer, view, err) &&
           job_set_camera(&view->job, &viewer->view.camera, size[0], size[1], &fits, err) &&
           (fits || err_set(err, ERR_BUG, "a new renderer rejects its own camera"));
}

static bool is_changing(const struct viewer *viewer, const struct view *view)
{
    return viewer_seconds(viewer) - view->changed_seconds < REST_SECONDS;
}

static bool wants_preview(const struct viewer *viewer, const struct view *view)
{
    return viewer->view.pace.shrink > 1 && is_changing(viewer, view);
}

static bool keep_picture(struct viewer *viewer, struct err *err)
{
    struct display_call call;
    viewer_display_call(viewer, &call);
    viewer->stage.has_kept = call.side_count > 0;
    return !viewer->stage.has_kept || display_keep(&viewer->stage.display, &call, err);
}

static bool update_denoiser(struct viewer *viewer, struct view *view, enum change change,
                            struct err *err)
{
    if (!viewer->stage.shown.denoise) {
        finish_denoiser(view);
        return true;
    }
    if (!view->denoiser.gpu)
        return denoiser_create(&viewer->stage.gpu, &view->denoiser, err) ||
               viewer_stop_denoising(viewer, err);
    // The denoiser can follow objects that moved, but no other change.
    if (change >= CHANGE_METHOD && change != CHANGE_GEOMETRY)
        denoiser_forget(&view->denoiser);
    return true;
}

// Returns whether a side changes from a small image to a full-size one. Until that has samples, the
// small image is shown.
static bool sharpens(const struct viewer *viewer, uint32_t side)
{
    const struct view *view = &viewer->stage.sides[side];
    return view->is_ready && view->is_preview && viewer->stage.changes[side] < CHANGE_CAMERA &&
           !wants_preview(viewer, view);
}

// Computes the size of the image that a side should have. While the scene changes continuously, the
// size is kept unless the budget requires another one.
static void wanted_size(const struct viewer *viewer, const struct view *view, bool keeps_size,
                        uint32_t size[2])
{
    viewer_picture_size(viewer, &size[0], &size[1]);
    if (!wants_preview(viewer, view))
        return;
    for (int i = 0; i < 2; i++)
        size[i] = frame_budget_shrunk(size[i], viewer->view.pace.shrink);
    if (!keeps_size)
        return;
    size[0] = view->job.renderer.frame.width;
    size[1] = view->job.renderer.frame.height;
}

// Brings a side to the state that the recorded changes and the time require: rebuilt, with a new
// camera, small while the scene changes, or full-size at rest.
static bool update_side(struct viewer *viewer, uint32_t side, struct err *err)
{
    struct view *view = &viewer->stage.sides[side];
    enum change change = viewer->stage.changes[side];
    bool is_small = wants_preview(viewer, view);
    bool is_to_build = !view->is_ready || change >= CHANGE_METHOD;
    uint32_t size[2];
    if (is_to_build && !build_side(viewer, view, err))
        return false;
    bool is_small_already = !is_to_build && change < CHANGE_CAMERA && view->is_preview;
    wanted_size(viewer, view, is_small_already, size);
    const struct gpu_frame *frame = &view->job.renderer.frame;
    bool looks = frame->width != size[0] || frame->height != size[1] || change == CHANGE_CAMERA;
    if (looks && !look_anew(viewer, view, size, err))
        return false;
    if (looks || is_to_build) {
        view_begin(view);
        for (uint32_t i = 0; i < VIEWER_SIDES; i++)
            viewer->stage.sides[i].turn_seconds = 0.0;
    }
    view->is_preview = is_small;
    return update_denoiser(viewer, view, change, err);
}

// --- changes -------------------------------------------------------------------------------------

static enum change greatest_change(const struct stage *stage)
{
    enum change most = CHANGE_NONE;
    for (uint32_t side = 0; side < VIEWER_SIDES; side++)
        most = stage->changes[side] > most ? stage->changes[side] : most;
    return most;
}

// Postpones all changes, and so leaves the image unchanged, until the BVH is ready.
static void put_off(struct stage *stage)
{
    for (uint32_t side = 0; side < VIEWER_SIDES; side++)
        if (stage->changes[side] >= CHANGE_METHOD)
            stage->changes[side] = CHANGE_SHOWN;
}

// Returns whether the BVH must be rebuilt and takes so long that it should be built in the
// background.
static bool builds_meanwhile(struct viewer *viewer)
{
    const struct geometry_params g =
        viewer_geometry_params(viewer, &viewer->document.scene, &viewer->view.camera);
    const struct flatten_params params = {g.scene, g.instancing, NULL, g.camera};
    bool can = rebuild_is_worthwhile(viewer) && viewer->stage.sides[0].is_ready;
    return can && flatten_key(&params) != viewer->document.geometry.key;
}

// Handles a change of geometry. Changes during a background build take effect with the next build.
static bool change_geometry(struct viewer *viewer, struct err *err)
{
    struct rebuild *rebuild = &viewer->document.rebuild;
    bool is_adopted = rebuild_is_done(viewer);
    if (is_adopted) {
        if (!end_jobs(viewer, err))
            return false;
        rebuild_adopt(viewer);
    }
    enum change most = greatest_change(&viewer->stage);
    if (most < CHANGE_METHOD)
        return true;
    if (rebuild_is_pending(viewer)) {
        rebuild->is_stale = true;
        put_off(&viewer->stage);
    } else if (most >= CHANGE_TABLES && !is_adopted && builds_meanwhile(viewer)) {
        if (!rebuild_start(viewer, err))
            return false;
        put_off(&viewer->stage);
    } else if (most >= CHANGE_TABLES) {
        return refresh_geometry(viewer, err);
    }
    return true;
}

static bool apply(struct viewer *viewer, struct err *err)
{
    if (!change_geometry(viewer, err))
        return false;
    enum change most = greatest_change(&viewer->stage);
    uint32_t width, height;
    viewer_picture_size(viewer, &width, &height);
    viewer->stage.side_count = viewer->stage.shown.split ? VIEWER_SIDES : 1;
    frame_budget_choose(&viewer->view.pace, width, height * viewer->stage.side_count);
    if (most >= CHANGE_CAMERA)
        viewer->stage.has_kept = false;
    bool has_to_keep = false;
    for (uint32_t side = 0; side < viewer->stage.side_count; side++)
        has_to_keep |= sharpens(viewer, side);
    if (has_to_keep && !keep_picture(viewer, err))
        return false;
    // If one side must wait for the geometry, the others wait as well.
    for (uint32_t i = 0; i < 2 * viewer->stage.side_count; i++) {
        uint32_t side = i % viewer->stage.side_count;
        bool is_due = i == side || !viewer->stage.sides[side].is_ready;
        if (is_due && !update_side(viewer, side, err))
            return false;
    }
    for (uint32_t side = viewer->stage.side_count; side < VIEWER_SIDES; side++)
        viewer_close_side(viewer, side);
    viewer->view.is_moving = false;
    for (uint32_t side = 0; side < viewer->stage.side_count; side++)
        viewer->view.is_moving |= is_changing(viewer, &viewer->stage.sides[side]);
    for (uint32_t side = 0; side < VIEWER_SIDES; side++)
        viewer->stage.changes[side] = CHANGE_NONE;
    return true;
}

// Undoes a change that failed. The rest of the scene is unchanged, but must be rebuilt.
static bool apply_reverted(struct viewer *viewer, struct err *err)
{
    struct err reason = *err;
    bool has_bad_kernels = viewer->stage.kernels != viewer->stage.good_kernels;
    if (viewer->stage.gpu.lost || err->code == ERR_STOPPED ||
        !(has_bad_kernels || edit_revert(viewer)))
        return false;
    viewer->stage.kernels = viewer->stage.good_kernels;
    viewer_message(viewer, MESSAGE_ERROR, "%s: %s",
                   has_bad_kernels ? "the old kernels remain in use" : "undone", reason.msg);
    viewer_changed(viewer, CHANGE_GEOMETRY);
    *err = (struct err){0};
    return apply(viewer, err);
}

// Makes the camera orbit the point that is visible in the centre of the image. The distance of that
// point also determines the flying speed.
static bool aim_rig(struct viewer *viewer, struct err *err)
{
    struct camera_rig *rig = &viewer->view.rig;
    struct picked picked;
    uint32_t place[4];
    viewer->view.wants_target = false;
    viewer_picture_place(viewer, place);
    if (!viewer_pick(viewer, place[0] + 0.5 * place[2], place[1] + 0.5 * place[3], &picked, err))
        return false;
    if (picked.object == VIEWER_NO_OBJECT || !(picked.distance > 0.0))
        return true;
    memcpy(rig->target, picked.position, sizeof rig->target);
    rig->speed = SPEED_PART * picked.distance;
    return true;
}

bool viewer_apply_changes(struct viewer *viewer, struct err *err)
{
    if (viewer->document.wanted_path[0]) {
        char path[sizeof viewer->document.wanted_path];
        memcpy(path, viewer->document.wanted_path, sizeof path);
        viewer->document.wanted_path[0] = '\0';
        viewer_open_scene(viewer, path, viewer->document.wanted_keeps_view);
    }
    if (viewer->stage.shaders_changed)
        viewer_changed(viewer, CHANGE_METHOD);
    viewer->stage.shaders_changed = false;
    if (!viewer->document.has_scene)
        return true;
    pose_update(viewer);
    save_waiting_scene(viewer, false);
    if (!apply(viewer, err) && !apply_reverted(viewer, err))
        return false;
    if (viewer->view.wants_target && !aim_rig(viewer, err))
        return false;
    edit_settle(viewer);
    viewer->stage.good_kernels = viewer->stage.kernels;
    return true;
}
