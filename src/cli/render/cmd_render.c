#include "cli/commands.h"

#include "base/clock.h"
#include "base/log.h"
#include "cli/render/render_run.h"
#include "cli/scene_options.h"
#include <math.h>
#include <string.h>

// --- what the job reports ------------------------------------------------------------------------

static bool after_wave(void *context, struct err *err)
{
    return render_tev_when_due(context, err);
}

static bool after_frame(void *context, uint32_t frame, struct err *err)
{
    struct render_run *run = context;
    uint32_t every = run->options->render.every;
    return every == 0 || frame % every != 0 ||
           (job_read_film(&run->job, err) && render_write_outputs(run, frame, err));
}

static bool after_row(void *context, struct err *err)
{
    return render_update_trace(context, err);
}

// --- from options to a job -----------------------------------------------------------------------

static bool follows_path(const struct options *options)
{
    return options_given(options, OPTION_PIXEL);
}

static bool has_several_devices(const struct options *options)
{
    return render_devices_count(options->device.gpu.device) > 1 && !follows_path(options);
}

struct job_goal render_goal(const struct options *options)
{
    struct job_goal goal = {
        .samples = options_given(options, OPTION_SPP) ? options->scene.settings.spp : 0,
        .seconds = options->render.time_seconds,
        .error = options->render.error,
        .adaptive = options->render.adaptive,
        .frames = options->render.frames,
        .samples_per_frame = options->render.spp_per_frame,
        .accumulate = options->render.accumulate,
    };
    // --pixel follows a path without the tiles of an adaptive render, but with the same sample
    // sequence. An adaptive render has the sequence of a render without a fixed number of samples.
    if (follows_path(options) && options->render.adaptive) {
        goal.adaptive = false;
        goal.seconds = INFINITY;
    }
    return goal;
}

static bool init_job(struct render_run *run, struct err *err)
{
    const struct options *options = run->options;
    struct job_params params = {
        .renderer = options_renderer_params(&options->device, &run->gpu, &run->scene, run->camera),
        .scene = &run->scene,
        .goal = render_goal(options),
        .reference = options->reference ? &run->reference : NULL,
        .listener = {after_wave, after_frame, after_row, run},
        .progress = render_progress(run),
        .reopens = options->render.reopens,
    };
    params.renderer.aovs = options->render.aovs | options->error_by;
    params.renderer.window = run->window;
    // For an adaptive render, --integrator auto is path. The goal of a followed path is not
    // adaptive, so the job would choose by other rules and must not choose.
    params.chooses_integrator = !(follows_path(options) && options->render.adaptive);
    if (!follows_path(options)) {
        params.checkpoint = (struct job_checkpoint_params){
            .path = options->render.checkpoint,
            .seconds = options->render.checkpoint_seconds,
            .is_paced = !options_given(options, OPTION_CHECKPOINT_EVERY),
            .resume = options->render.resume,
        };
        params.keeps_trace = options->render.trace != NULL;
        params.shard = options->render.shard;
        params.merged = options->render.merged;
        params.command = options->render.shared_line;
    }
    if (run->ranks) {
        params.reopens = 0; // this job cannot restore the parts of the film that other ranks have
        run->ranks->job = &run->job;
        run->ranks->checkpoint = options->render.checkpoint;
        // Each rank saves its blocks, so the films need not be added after each block.
        if (render_ranks_save_each(options)) {
            params.checkpoint.keeps_blocks = params.checkpoint.is_paced = true;
            params.checkpoint.seconds = OPTION_CHECKPOINT_SECONDS;
        }
        params.crew = &run->ranks->crew;
    } else if (has_several_devices(options)) {
        params.reopens = 0;
        if (!render_devices_create(options->device.gpu.device, &params, &run->devices, err))
            return false;
    }
    return job_init(&params, &run->job, err);
}

bool render_load_scene(const struct options *options, struct scene *scene, uint32_t *camera,
                       struct err *err)
{
    if (!options_load_scene(&options->scene, options->progress, scene, camera, err))
        return false;
    return !scene->is_hidden ||
           err_set(err, ERR_INPUT,
                   "%s: everything in the scene is hidden, and it has no environment; expected "
                   "a visible object or an environment",
                   scene->path);
}

bool render_find_window(const struct options *options, const struct scene *scene,
                        struct render_window *out, struct err *err)
{
    const uint32_t *crop = options->render.crop;
    const struct settings *settings = &scene->settings;
    *out = (struct render_window){crop[0], crop[1], crop[2] - crop[0], crop[3] - crop[1]};
    return (crop[2] <= settings->width && crop[3] <= settings->height) ||
           err_set(err, ERR_USAGE,
                   "--crop %u,%u,%u,%u: exceeds the picture of %u x %u pixels; expected X1 of at "
                   "most %u and Y1 of at most %u",
                   crop[0], crop[1], crop[2], crop[3], settings->width, settings->height,
                   settings->width, settings->height);
}

static bool load(struct render_run *run, struct err *err)
{
    uint64_t start = clock_ns();
    if (!render_load_scene(run->options, &run->scene, &run->camera, err) ||
        !render_find_window(run->options, &run->scene, &run->window, err))
        return false;
    if (!render_check_space(run, err) || !init_job(run, err))
        return false;
    job_add_time(&run->job, JOB_LOADING, start);
    return true;
}

// Opens the job's device. If several devices are given, also opens the others, and starts a thread
// for each of them, which creates its renderer.
static bool open_devices(struct render_run *run, struct err *err)
{
    const char *text = run->options->device.gpu.device;
    struct gpu_params params = run->options->device.gpu;
    if (run->ranks)
        return render_ranks_open_device(run->options, run->ranks, &run->job, err);
    if (render_devices_count(text) > 1)
        params.device = render_devices_name(text, 0, &run->arena);
    if (text && !params.device)
        return err_memory(err, "the name of a device", strlen(text));
    if (!gpu_open(&params, &run->gpu, err))
        return false;
    return !run->job.params.crew || // the integrator is set in the scene before workers read it
           (job_choose_integrator(&run->job, err) &&
            render_devices_start(&run->devices, &params, text, &run->job.params, err));
}

static void warn_of_different_devices(const struct crew *crew)
{
    if (crew && !crew_is_uniform(crew))
        log_warn("the devices or their drivers differ: the picture does not have the bits that one "
                 "of them would make alone");
}

static bool set_up(struct render_run *run, struct err *err)
{
    const struct options *options = run->options;
    bool writes = !follows_path(options);
    if (writes && !(render_check_outputs(run, err) && render_tev_open(run, err)))
        return false;
    if (!load(run, err) || !render_open_reference(run, err) ||
        (writes && !render_check_inputs(run, err)))
        return false;
    for (uint32_t i = 0; i < run->scene.note_count; i++)
        log_info("%s", run->scene.notes[i]);

    if (!open_devices(run, err))
        return false;
    warn_of_different_devices(run->job.params.crew);
    if (!job_open(&run->job, err) || (writes && !render_read_trace(run, err)) ||
        !job_create(&run->job, err))
        return false;
    const struct flat_scene *flat = &run->job.renderer.flat;
    if (flat->triangle_count == 0 && flat->shape_count == 0)
        log_warn("%s has no surface: only the environment is visible", run->scene.path);
    return true;
}

// --- the end of a render -------------------------------------------------------------------------

// Writes all requested outputs, even if some of them fail. The caller reports the last failure.
static bool finish_outputs(struct render_run *run, struct err *err)
{
    struct err failures[3] = {0};
    job_checkpoint_save(&run->job, &failures[0]);
    progress_report(run->options->progress, "Estimating the error", 0);
    if (job_judge_end(&run->job, &failures[1])) {
        progress_report(run->options->progress, "Writing", 0);
        render_write_outputs(run, 0, &failures[1]);
        render_end_trace(run, &failures[2]);
    }
    bool ok = true;
    for (int i = 0; i < 3; i++) {
        if (failures[i].code == ERR_NONE)
            continue;
        if (!ok)
            log_message(LOG_ERROR, "%s", err->msg);
        *err = failures[i];
        ok = false;
    }
    return ok;
}

// Writes the outputs of a rescued render and reports what fails here. The caller reports the
// failure that ended rendering.
static void write_rescued(struct render_run *run)
{
    struct err failures[3] = {0};
    job_judge_end(&run->job, &failures[0]);
    render_write_outputs(run, 0, &failures[1]);
    render_end_trace(run, &failures[2]);
    for (int i = 0; i < 3; i++)
        if (failures[i].code != ERR_NONE)
            log_message(LOG_ERROR, "%s", failures[i].msg);
}

static bool render(struct render_run *run, struct err *err)
{
    if (!set_up(run, err))
        return false;
    if (follows_path(run->options))
        return render_replay(run, err);

    bool ok = render_tev_begin(run, err) && job_run(&run->job, err) && finish_outputs(run, err);
    if (!ok) {
        job_checkpoint_mention(&run->job, err);
        if (run->is_written || !job_rescue(&run->job, err->code))
            return false;
        write_rescued(run);
    }
    render_tev_end(run);
    job_add_time(&run->job, JOB_TOTAL, run->start_ns);
    progress_end(run->options->progress);
    if (run->options->json && !render_print_json(run, err))
        return false;
    if (!run->options->json && !run->options->quiet)
        render_print_summary(run);
    render_warn_of_unsampled(run);
    render_warn_of_blind_error(run);
    const char *reproduce = render_reproducing_command(run);
    if (reproduce)
        log_warn("some contributions were not finite and were left out; this command follows "
                 "one: %s",
                 reproduce);
    return ok;
}

// `ranks` is NULL if this process renders alone.
static int render_once(const struct options *options, struct render_ranks *ranks)
{
    struct render_run run = {.options = options, .start_ns = clock_ns(), .ranks = ranks};
    struct err err = {0};
    bool ok = render(&run, &err);
    if (ok && run.gpu.validation_messages > 0)
        ok = err_set(&err, ERR_BUG, "the validation layers reported %u messages",
                     run.gpu.validation_messages);
    render_tev_end(&run);
    job_finish(&run.job);
    render_devices_finish(&run.devices);
    gpu_close(&run.gpu);
    scene_finish(&run.scene);
    render_release_outputs(&run);
    arena_finish(&run.arena);
    if (!ok)
        return command_fail(&err);
    return EXIT_CODE_OK; // main returns another code if a signal stopped the render
}

int cmd_render(const struct options *options)
{
    if (options_have_sequence(options))
        return render_sequence(options);
    // With --shard and --pixel, each process of mpirun runs alone.
    if (render_ranks_expected() > 1 && !options_given(options, OPTION_SHARD) &&
        !options->render.merged && !follows_path(options))
        return render_ranks_become(options);
    return render_once(options, NULL);
}

int render_with_ranks(const struct options *options, struct render_ranks *ranks)
{
    return ranks->rank == 0 ? render_once(options, ranks) : render_ranks_work(options, ranks);
}
