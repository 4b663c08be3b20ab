#include "commands.h"

#include "clock.h"
#include "hash.h"
#include "log.h"
#include "render_job.h"
#include <string.h>

// --- how many samples, in which frames
// ------------------------------------------------------------

static bool render_samples(struct render_job *job, uint64_t samples, double from, double to,
                           struct err *err)
{
    struct render_call call = {
        .samples = samples,
        .progress_from = from,
        .progress_to = to,
        .stopped = &job->stopped,
    };
    return renderer_render(&job->renderer, &call, err);
}

// Samples are added in steps that grow while they are short against the time left, so that a run
// ends within a step of its limit, at whole samples.
static bool render_until(struct render_job *job, uint64_t samples, struct err *err)
{
    double limit = job->options->time_seconds;
    uint64_t start = clock_ns();
    uint64_t done = 0;
    while (done < samples && !job->stopped) {
        double elapsed = clock_seconds_since(start);
        uint64_t step = 1;
        if (done > 0) {
            double fits = (limit - elapsed) * (double)done / elapsed;
            if (fits < 1.0) {
                job->timed_out = true;
                break;
            }
            // Half of what is left: the estimate is a noisy one.
            step = fits < 32.0 ? (uint64_t)(0.5 * fits) + 1 : 16;
        }
        if (step > samples - done)
            step = samples - done;
        if (!render_samples(job, step, elapsed / limit, (elapsed + 1e-9) / limit, err))
            return false;
        done += step;
    }
    return true;
}

// A list that grows by doubling: how many frames there will be may be for a clock or a signal to
// say.
static bool add_frame_time(struct render_job *job, double ms, struct err *err)
{
    if (job->frame_count == job->frame_capacity) {
        uint32_t capacity = job->frame_count ? 2 * job->frame_count : 64;
        double *larger = ARENA_NEW(&job->arena, double, capacity);
        if (!larger)
            return err_memory(err, "frame times", capacity * sizeof *larger);
        if (job->frame_count)
            memcpy(larger, job->frames_ms, job->frame_count * sizeof *larger);
        job->frames_ms = larger;
        job->frame_capacity = capacity;
    }
    job->frames_ms[job->frame_count++] = ms;
    return true;
}

static bool read_film(struct render_job *job, struct err *err)
{
    arena_finish(&job->film_arena);
    if (!renderer_read(&job->renderer, &job->film_arena, &job->film, err))
        return false;
    const struct film_image *film = &job->film;
    uint64_t pixels = (uint64_t)film->width * film->height;
    job->image_hash = hash_bytes(HASH_INIT, film->mean, pixels * sizeof *film->mean);
    struct half_error_params params = {
        .half_a = (const float(*)[3])film->half_a,
        .half_b = (const float(*)[3])film->half_b,
        .width = film->width,
        .height = film->height,
        .samples = film->least_samples,
        .seed = job->scene.settings.seed,
    };
    if (!metrics_half_error(&params, &job->error))
        return err_memory(err, "error estimate", pixels * sizeof *film->mean);
    return true;
}

static bool is_numbered(const struct render_job *job, uint32_t frame)
{
    return job->options->every && (frame + 1) % job->options->every == 0;
}

static bool render_frames(struct render_job *job, struct err *err)
{
    const struct options *options = job->options;
    uint32_t frames = options->frames;
    double limit = options->time_seconds;
    for (uint32_t frame = 0; frame < frames && !job->stopped; frame++) {
        if (frame > 0 && !options->accumulate && !renderer_clear(&job->renderer, err))
            return false;
        uint64_t start = clock_ns();
        if (!render_samples(job, options->spp_per_frame, (double)frame / frames,
                            (frame + 1.0) / frames, err) ||
            !add_frame_time(job, clock_seconds_since(start) * 1e3, err))
            return false;
        job->seconds.render = job->renderer.stats.render_seconds;
        if (is_numbered(job, frame) && !job->stopped) {
            if (!read_film(job, err) || !job_write_outputs(job, frame + 1, err))
                return false;
        }
        job->timed_out = limit > 0.0 && job->seconds.render >= limit && frame + 1 < frames;
        if (job->timed_out)
            break;
    }
    return true;
}

static bool render_picture(struct render_job *job, struct err *err)
{
    const struct options *options = job->options;
    uint64_t samples = job->scene.settings.spp;
    uint64_t start = clock_ns();
    bool ok;
    if (options->time_seconds > 0.0)
        ok = render_until(job, options_given(options, OPTION_SPP) ? samples : UINT32_MAX, err);
    else
        ok = render_samples(job, samples, 0.0, 1.0, err);
    return ok && add_frame_time(job, clock_seconds_since(start) * 1e3, err);
}

// --- the command
// ----------------------------------------------------------------------------------

static bool set_up(struct render_job *job, struct err *err)
{
    const struct options *options = job->options;
    if (!options_given(options, OPTION_PIXEL) && !job_check_outputs(job, err))
        return false;
    uint64_t start = clock_ns();
    if (!job_load_scene(options, &job->scene, &job->camera, err))
        return false;
    job->seconds.load = clock_seconds_since(start);
    if (!job_check_space(job, err))
        return false;
    for (uint32_t i = 0; i < job->scene.note_count; i++)
        log_info("%s", job->scene.notes[i]);

    if (!gpu_open(&options->gpu, &job->gpu, err))
        return false;
    struct renderer_params params = {
        .gpu = &job->gpu,
        .scene = &job->scene,
        .wave = options->wave,
        .camera = job->camera,
        .aovs = options->aovs,
        .everything = options->features == FEATURES_ALL,
        .merge_classes = options->classes == CLASSES_MERGED,
        .progress = options->progress,
    };
    if (!renderer_create(&params, &job->renderer, err))
        return false;
    if (job->renderer.flat.triangle_count == 0 && job->renderer.flat.shape_count == 0)
        log_warn("%s has no surface: there is only the environment to see", job->scene.path);
    const struct render_stats *stats = &job->renderer.stats;
    job->seconds.load += stats->flatten_seconds;
    job->seconds.bvh = stats->bvh_seconds;
    job->seconds.upload = stats->upload_seconds;
    job->seconds.compile = stats->compile_seconds;
    return true;
}

static bool run(struct render_job *job, struct err *err)
{
    if (!set_up(job, err))
        return false;
    if (options_given(job->options, OPTION_PIXEL))
        return job_replay(job, err);

    bool ok = job->options->frames ? render_frames(job, err) : render_picture(job, err);
    job->seconds.render = job->renderer.stats.render_seconds;
    if (!ok || !read_film(job, err) || !job_write_outputs(job, 0, err))
        return false;
    job->seconds.total = clock_seconds_since(job->start_ns);
    if (job->options->json)
        job_print_json(job);
    else if (!job->options->quiet)
        job_print_summary(job);
    const char *reproduce = job_reproducing_command(job);
    if (reproduce)
        log_warn("some contributions were not finite and were left out; this follows one: %s",
                 reproduce);
    return true;
}

int cmd_render(const struct options *options)
{
    struct render_job job = {.options = options, .start_ns = clock_ns()};
    struct err err = {0};
    bool ok = run(&job, &err);
    if (ok && job.gpu.validation_messages > 0)
        ok = err_set(&err, ERR_BUG, "the validation layers reported %u messages",
                     job.gpu.validation_messages);
    renderer_finish(&job.renderer);
    gpu_close(&job.gpu);
    scene_finish(&job.scene);
    job_release_outputs(&job);
    arena_finish(&job.film_arena);
    arena_finish(&job.arena);
    if (!ok)
        return command_fail(&err);
    return EXIT_CODE_OK; // or main's, when a signal stopped it
}
