// Renders the numbered pictures of an animation or a turntable. Kernels are compiled once. Parts of
// the scene that do not change are kept for the next picture.
#include "cli/render/sequence.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/file_inputs.h"
#include "base/file_system.h"
#include "base/log.h"
#include "base/maths.h"
#include "cli/commands.h"
#include "cli/scene_options.h"
#include <inttypes.h>
#include <math.h>
#include <string.h>

// --- progress ------------------------------------------------------------------------------------

// Reports the finished fraction of all pictures, so that the estimate of the remaining time is that
// of all pictures. Within a picture, only the phase of rendering counts. The fraction never
// decreases.
static void report(void *context, const char *phase, double fraction)
{
    struct sequence_progress *shown = context;
    if (shown->count == 0) {
        progress_report(shown->whole, phase, fraction);
        return;
    }
    double own = strcmp(phase, "Rendering") == 0 ? fmin(fraction, 1.0) : 0.0;
    shown->shown = fmax(shown->shown, (shown->done + own) / shown->count);
    progress_report(shown->whole, "Pictures", shown->shown);
}

static bool should_stop(void *context)
{
    const struct sequence_progress *shown = context;
    return progress_should_stop(shown->whole);
}

static void end_progress(void *context)
{
    const struct sequence_progress *shown = context;
    progress_end(shown->whole);
}

static void pause_progress(void *context)
{
    const struct sequence_progress *shown = context;
    progress_pause(shown->whole);
}

static bool check_space(const struct sequence *s, struct err *err)
{
    uint64_t left = s->count - s->skipped;
    for (uint32_t i = 0; i < s->name_count; i++) {
        uint64_t bytes = render_picture_bytes(&s->run, s->run.outputs[i]);
        if (!file_check_space(s->run.outputs[i], left * bytes, err))
            return false;
    }
    return true;
}

// --- scene ---------------------------------------------------------------------------------------

static struct geometry_params geometry_params(const struct sequence *s, const struct scene *scene)
{
    const struct device_options *device = &s->options.device;
    return (struct geometry_params){
        .scene = scene,
        .bvh = device->bvh,
        .instancing = device->instances,
        .bvh_cache = device->bvh_cache,
        .progress = &s->progress,
        .camera = &s->camera,
    };
}

// Keeps the BVH if nothing has moved.
static bool refresh_geometry(struct sequence *s, const struct scene *scene, struct err *err)
{
    const struct geometry_params params = geometry_params(s, scene);
    const void *former = s->geometry.bvh.nodes;
    if (!geometry_refresh(&params, &s->geometry, err))
        return false;
    if (s->geometry.bvh.nodes != former)
        s->bvh_ns = (uint64_t)(s->geometry.bvh.stats.build_seconds * 1e9);
    return true;
}

// If the program has chosen the camera or added the ground, loading has placed them anew for the
// pose. Moves them back to their places in the first picture.
static void keep_additions(const struct sequence *s, struct scene *scene)
{
    if (scene->camera_is_framed)
        scene->cameras[s->run.camera] = s->camera;
    if (!scene->has_ground)
        return;
    struct shape *ground = &scene->shapes[scene->shape_count - 1];
    memcpy(ground->center, s->ground[0], sizeof ground->center);
    memcpy(ground->normal, s->ground[1], sizeof ground->normal);
}

static bool load_first(struct sequence *s, struct err *err)
{
    struct render_run *run = &s->run;
    struct scene *scene = &run->scene;
    const uint64_t start = clock_ns();
    if (!sequence_turn_to(s, 0, err) || !render_load_scene(&s->options, scene, &run->camera, err) ||
        !render_find_window(&s->options, scene, &run->window, err))
        return false;
    for (uint32_t i = 0; i < scene->note_count; i++)
        log_info("%s", scene->notes[i]);
    s->camera = scene->cameras[run->camera];
    if (scene->has_ground) {
        const struct shape *ground = &scene->shapes[scene->shape_count - 1];
        memcpy(s->ground[0], ground->center, sizeof ground->center);
        memcpy(s->ground[1], ground->normal, sizeof ground->normal);
    }
    if (s->options.render.sequence.views > 0) {
        bool has_up = options_given(&s->options, OPTION_UP);
        turntable_init(scene, &s->camera, has_up, &s->turntable);
        s->camera = s->turntable.camera;
    }
    scene->cameras[run->camera] = s->camera;
    bool ok = refresh_geometry(s, scene, err);
    s->load_ns = clock_ns() - start;
    return ok;
}

// Loads the scene at the time of the current picture. The former scene is kept until the geometry
// has been compared with it.
static bool load_pose(struct sequence *s, struct err *err)
{
    struct render_run *run = &s->run;
    struct scene next;
    uint32_t camera;
    const uint64_t start = clock_ns();
    if (!render_load_scene(&s->options, &next, &camera, err))
        return false;
    keep_additions(s, &next);
    job_finish(&run->job);
    bool ok = refresh_geometry(s, &next, err);
    scene_finish(&run->scene);
    run->scene = next;
    s->load_ns = clock_ns() - start;
    return ok;
}

// --- the job -------------------------------------------------------------------------------------

static bool init_job(struct sequence *s, struct err *err)
{
    struct render_run *run = &s->run;
    struct job_params params = {
        .renderer =
            options_renderer_params(&s->options.device, &run->gpu, &run->scene, run->camera),
        .scene = &run->scene,
        .goal = render_goal(&s->options),
        .progress = &s->progress,
        .reopens = s->options.render.reopens,
    };
    params.renderer.geometry = &s->geometry;
    params.renderer.window = run->window;
    params.renderer.aovs = s->options.render.aovs | s->options.error_by;
    return job_init(&params, &run->job, err) && job_open(&run->job, err);
}

static bool find_identity(struct sequence *s, struct err *err)
{
    const struct render_options *asked = &s->options.render;
    const struct settings *settings = &s->run.scene.settings;
    struct arena *arena = &s->run.arena;
    if (!init_job(s, err))
        return false;
    const char *job = job_identity(&s->run.job);
    const struct job_goal *goal = &s->run.job.params.goal;
    const char *exposure = settings->exposure_is_auto
                               ? "auto"
                               : arena_printf(arena, "%.9g", (double)settings->exposure);
    if (job && exposure)
        s->identity = arena_printf(
            arena,
            "%s--spp=%" PRIu64 "\n--time=%.9g\n--error=%.9g\n--exposure=%s\n--tone=%s\n"
            "channels=%s\n",
            job, goal->samples ? goal->samples : settings->spp, goal->seconds, goal->error,
            exposure, tone_names[settings->tone_curve],
            asked->half_float ? asked->png16 ? "half and 16 bits" : "half"
            : asked->png16    ? "16 bits"
                              : "usual");
    job_finish(&s->run.job);
    return s->identity || err_memory(err, "the identity of a sequence", 4096);
}

// The time for loading the scene and building its BVH is added to the picture for which the scene
// was loaded.
static bool create_job(struct sequence *s, struct err *err)
{
    if (!init_job(s, err) || !job_create(&s->run.job, err))
        return false;
    job_add_time(&s->run.job, JOB_LOADING, clock_ns() - (s->load_ns - s->bvh_ns));
    job_add_time(&s->run.job, JOB_BUILDING, clock_ns() - s->bvh_ns);
    s->load_ns = s->bvh_ns = 0;
    return true;
}

// Prepares the job for the current picture.
static bool show(struct sequence *s, struct err *err)
{
    struct render_run *run = &s->run;
    const bool has_job = run->job.renderer.gpu != NULL;
    if (s->options.render.sequence.views == 0)
        return (s->index == 0 || load_pose(s, err)) && create_job(s, err);
    struct camera *camera = &run->scene.cameras[run->camera];
    bool fits = false;
    turntable_camera(&s->turntable, sequence_angle(&s->options.render.sequence, s->index), camera);
    if (has_job && !job_begin_view(&run->job, camera, &fits, err))
        return false;
    if (fits)
        return true;
    job_finish(&run->job);
    return create_job(s, err);
}

// --- pictures ------------------------------------------------------------------------------------

static bool set_up(struct sequence *s, struct err *err)
{
    struct render_run *run = &s->run;
    if (render_devices_count(s->options.device.gpu.device) > 1)
        return err_set(err, ERR_USAGE,
                       "--device %s: the pictures of a sequence are rendered by one device; "
                       "expected its number or name",
                       s->options.device.gpu.device);
    if (render_ranks_expected() > 1)
        return err_set(err, ERR_USAGE,
                       "mpirun: the pictures of a sequence are rendered by one process; expected "
                       "a command without mpirun");
    // Locks of the first picture's files protect all pictures of the sequence.
    if (!sequence_list_names(s, err) || !sequence_turn_to(s, 0, err) ||
        !render_check_outputs(run, err) || !load_first(s, err) || !sequence_video_check(s, err) ||
        !sequence_check_names(s, err))
        return false;
    s->is_finished = ARENA_NEW(&run->arena, bool, s->count);
    if (!s->is_finished)
        return err_memory(err, "pictures", s->count);
    return gpu_open(&s->options.device.gpu, &run->gpu, err) && find_identity(s, err) &&
           (!s->options.render.resume || sequence_find_finished(s, err)) && check_space(s, err);
}

static bool render_picture(struct sequence *s, struct err *err)
{
    struct render_run *run = &s->run;
    uint64_t start = clock_ns();
    run->start_ns = start;
    run->is_written = false;
    if (!show(s, err) || !job_run(&run->job, err))
        return false;
    if (run->job.stopped)
        return true;
    if (!job_judge_end(&run->job, err) || !render_write_outputs(run, 0, err))
        return false;
    run->exposure_is_kept = true;
    job_add_time(&run->job, JOB_TOTAL, start);
    s->rendered++;
    s->shown.done++;
    return sequence_report_frame(s, start, err);
}

static bool render_all(struct sequence *s, struct err *err)
{
    s->shown.count = s->count - s->skipped;
    for (uint32_t i = 0; i < s->count; i++) {
        if (progress_should_stop(&s->progress))
            break;
        if (!sequence_turn_to(s, i, err))
            return false;
        bool ok = s->is_finished[i] ? sequence_report_skipped(s, err) : render_picture(s, err);
        if (!ok)
            return err_prepend(err, "picture %u of %u", i + 1, s->count);
    }
    s->shown.count = 0;
    return true;
}

static bool render(struct sequence *s, struct err *err)
{
    if (!set_up(s, err))
        return false;
    bool ok = render_all(s, err), is_whole = s->rendered + s->skipped == s->count;
    if (ok && is_whole)
        ok = sequence_video_make(s, err);
    progress_end(&s->progress);
    if (!is_whole)
        log_warn("%u of %u pictures are finished; the same command with --resume continues",
                 s->rendered + s->skipped, s->count);
    return ok && sequence_report_end(s, err);
}

int render_sequence(const struct options *options)
{
    struct sequence s = {
        .options = *options,
        .count = sequence_count(&options->render.sequence),
        .shown = {.whole = options->progress},
    };
    struct err err = {0};
    s.progress = (struct progress){report, should_stop, &s.shown, end_progress, pause_progress};
    s.options.progress = &s.progress;
    s.options.render.following_line = NULL;
    s.run.options = &s.options;
    bool ok = render(&s, &err);
    if (ok && s.run.gpu.validation_messages > 0)
        ok = err_set(&err, ERR_BUG, "the validation layers reported %u messages",
                     s.run.gpu.validation_messages);
    job_finish(&s.run.job);
    geometry_finish(&s.geometry);
    gpu_close(&s.run.gpu);
    scene_finish(&s.run.scene);
    render_release_outputs(&s.run);
    if (ok && s.video.folder && s.rendered + s.skipped == s.count)
        folder_remove(s.video.folder); // fails if the folder has other files
    arena_finish(&s.frame_arena);
    arena_finish(&s.run.arena);
    return ok ? EXIT_CODE_OK : command_fail(&err);
}
