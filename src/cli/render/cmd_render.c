#include "cli/commands.h"

#include "base/clock.h"
#include "base/log.h"
#include "cli/render/render_trace.h"

static bool set_up(struct render_job *job, struct err *err)
{
    const struct options *options = job->options;
    bool follows_path = options_given(options, OPTION_PIXEL);
    if (!follows_path && !(job_check_outputs(job, err) && job_tev_open(job, err)))
        return false;
    uint64_t start = clock_ns();
    if (!job_load_scene(options, &job->scene, &job->camera, err))
        return false;
    job->seconds.load = clock_seconds_since(start);
    if (job->scene.is_hidden)
        return err_set(err, ERR_INPUT,
                       "%s: everything in the scene is hidden, and it has no environment; expected "
                       "something to see",
                       job->scene.path);
    if (!job_check_space(job, err) || !job_settle_samples(job, err) ||
        !job_open_reference(job, err) || (!follows_path && !job_check_inputs(job, err)))
        return false;
    for (uint32_t i = 0; i < job->scene.note_count; i++)
        log_info("%s", job->scene.notes[i]);

    if (!gpu_open(&options->gpu, &job->gpu, err) ||
        (!follows_path && !(job_checkpoint_open(job, err) && job_trace_open(job, err))))
        return false;
    struct renderer_params params =
        job_renderer_params(options, &job->gpu, &job->scene, job->camera);
    params.progress = job_progress(job);
    params.aovs = options->aovs;
    params.tiles = options->adaptive && !follows_path;
    params.open_ended = job_is_open_ended(options);
    if (!renderer_create(&params, &job->renderer, err))
        return false;
    if (job->renderer.flat.triangle_count == 0 && job->renderer.flat.shape_count == 0)
        log_warn("%s has no surface: there is only the environment to see", job->scene.path);
    const struct render_stats *stats = &job->renderer.stats;
    job->seconds.load += stats->flatten_seconds;
    job->seconds.bvh = stats->bvh_seconds;
    job->seconds.bvh_uncached = job->renderer.bvh.stats.cached_seconds;
    job->seconds.upload = stats->upload_seconds;
    job->seconds.compile = stats->compile_seconds;
    return true;
}

// What is there is kept, in all ways, whatever becomes of the others. The caller reports the last
// failure.
static bool finish_outputs(struct render_job *job, struct err *err)
{
    struct err failures[3] = {0};
    job_checkpoint_save(job, &failures[0]);
    progress_report(job->options->progress, "Estimating the error", 0);
    if (job_judge_end(job, &failures[1])) {
        progress_report(job->options->progress, "Writing", 0);
        job_write_outputs(job, 0, &failures[1]);
        job_trace_end(job, &failures[2]);
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

// The failure that ended rendering is what the caller reports. A picture whose error cannot be told
// is one, too.
static void write_rescued(struct render_job *job)
{
    struct err failures[3] = {0};
    job_judge_end(job, &failures[0]);
    job_write_outputs(job, 0, &failures[1]);
    job_trace_end(job, &failures[2]);
    for (int i = 0; i < 3; i++)
        if (failures[i].code != ERR_NONE)
            log_message(LOG_ERROR, "%s", failures[i].msg);
}

static bool run(struct render_job *job, struct err *err)
{
    if (!set_up(job, err))
        return false;
    if (options_given(job->options, OPTION_PIXEL))
        return job_replay(job, err);

    bool ok = job_checkpoint_restore(job, err) && job_tev_begin(job, err) && job_render(job, err) &&
              finish_outputs(job, err);
    if (!ok) {
        job_checkpoint_mention(job, err);
        if (job->is_written || !job_rescue(job, err->code))
            return false;
        write_rescued(job);
    }
    job_tev_end(job);
    job->seconds.total = clock_seconds_since(job->start_ns);
    progress_end(job->options->progress);
    if (job->options->json && !job_print_json(job, err))
        return false;
    if (!job->options->json && !job->options->quiet)
        job_print_summary(job);
    job_warn_of_unsampled(job);
    const char *reproduce = job_reproducing_command(job);
    if (reproduce)
        log_warn("some contributions were not finite and were left out; this follows one: %s",
                 reproduce);
    return ok;
}

int cmd_render(const struct options *options)
{
    struct render_job job = {.options = options, .start_ns = clock_ns()};
    struct err err = {0};
    bool ok = run(&job, &err);
    if (ok && job.gpu.validation_messages > 0)
        ok = err_set(&err, ERR_BUG, "the validation layers reported %u messages",
                     job.gpu.validation_messages);
    job_tev_end(&job);
    checkpoint_close(&job.resumed);
    renderer_finish(&job.renderer);
    gpu_close(&job.gpu);
    scene_finish(&job.scene);
    job_release_outputs(&job);
    arena_finish(&job.rescue.arena);
    arena_finish(&job.film_arena);
    arena_finish(&job.arena);
    if (!ok)
        return command_fail(&err);
    return EXIT_CODE_OK; // or main's, when a signal stopped it
}
