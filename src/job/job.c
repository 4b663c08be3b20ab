#include "job/job_internal.h"

#include "base/log.h"
#include "render/sampling_plan.h"
#include <math.h>
#include <string.h>

// The limit of samples per pixel of a render with an error or time limit but without a number of
// samples. With only a time limit, there is no limit of samples.
#define ERROR_SAMPLES 65536u
#define TIMED_SAMPLES UINT32_MAX
#define TIMED_SAMPLES_BY_TILE (1u << 20)
// Mean number of samples per pixel in a round of the tiles' plan.
#define ROUND_SAMPLES 16u

// --- the goal ------------------------------------------------------------------------------------

static uint64_t most_samples(const struct job *job)
{
    const struct job_goal *goal = &job->params.goal;
    if (goal->samples > 0)
        return goal->samples;
    if (goal->error > 0.0)
        return ERROR_SAMPLES;
    if (goal->seconds > 0.0)
        return goal->adaptive ? TIMED_SAMPLES_BY_TILE : TIMED_SAMPLES;
    return job->scene->settings.spp;
}

// Chooses the samples per round. If their number is not a multiple of ROUND_SAMPLES, all are one
// round.
static void choose_rounds(struct job *job)
{
    const struct job_goal *goal = &job->params.goal;
    bool may_end_early = goal->error > 0.0 || goal->seconds > 0.0;
    if (may_end_early && job->samples_most > ROUND_SAMPLES)
        job->samples_most -= job->samples_most % ROUND_SAMPLES;
    job->round_samples =
        job->samples_most % ROUND_SAMPLES == 0 ? ROUND_SAMPLES : (uint32_t)job->samples_most;
}

// Rejects methods that need to know the number of samples in advance, if the goal determines it
// only during the render.
static bool check_method(const struct job *job, struct err *err)
{
    const struct job_goal *goal = &job->params.goal;
    const struct settings *settings = &job->scene->settings;
    const char *method;
    enum sample_planning planning = sample_planning(settings, &method);
    // A render to a time limit cannot be combined, either: if it were repeated with the number of
    // samples that it reached, the points would be distributed differently.
    bool is_fixed =
        planning == PLANNING_NEEDED || (planning == PLANNING_OPTIONAL && !job_is_open_ended(job));
    if (is_fixed && (goal->adaptive || goal->error > 0.0))
        return err_set(err, ERR_USAGE,
                       "%s cannot be combined with %s: its points depend on the number of "
                       "samples, which must be known in advance",
                       method, goal->adaptive ? "--adaptive on" : "--error");
    if (settings->roulette == ROULETTE_FRAME && goal->error > 0.0)
        return err_set(
            err, ERR_USAGE,
            "--roulette frame and --error exclude each other: with one depth for all paths "
            "of a sample, the errors of pixels depend on each other and give no interval");
    if (goal->frames && !goal->accumulate && settings->halves == HALVES_CONTIGUOUS)
        return err_set(
            err, ERR_USAGE,
            "--halves contiguous needs one sequence of samples for the whole image, but frames "
            "that do not accumulate are separate images; expected --accumulate on or --halves "
            "independent");
    return true;
}

static bool settle_goal(struct job *job, struct err *err)
{
    const struct job_goal *goal = &job->params.goal;
    job->samples_most = most_samples(job);
    if (!check_method(job, err))
        return false;
    if (goal->adaptive && job->samples_most < TILE_SAMPLES_MIN)
        return err_set(err, ERR_USAGE,
                       "--adaptive on: too few samples per pixel to distribute over tiles: %u; "
                       "expected --spp of at least %u",
                       (unsigned)job->samples_most, TILE_SAMPLES_MIN);
    if (goal->adaptive)
        choose_rounds(job);
    uint32_t frames_in_one = goal->accumulate ? goal->frames : 1;
    if (goal->frames)
        job->scene->settings.spp = (uint64_t)goal->samples_per_frame * frames_in_one;
    else if (goal->samples > 0)
        job->scene->settings.spp = goal->samples;
    return job_settle_shard(job, err) && job_check_crew(job, err);
}

static bool goals_same(const struct job_goal *a, const struct job_goal *b)
{
    return a->samples == b->samples && a->seconds == b->seconds && a->error == b->error &&
           a->adaptive == b->adaptive && a->frames == b->frames &&
           a->samples_per_frame == b->samples_per_frame && a->accumulate == b->accumulate;
}

bool job_set_goal(struct job *job, const struct job_goal *goal, struct err *err)
{
    struct job_goal *now = &job->params.goal;
    const struct job_goal former = *now;
    bool is_fixed =
        goal->frames || former.frames || goal->adaptive || former.adaptive || job_is_shard(job);
    if (is_fixed && !goals_same(goal, &former))
        return err_set(err, ERR_USAGE,
                       "the goal of a render with frames, with adaptive sampling or of a shard "
                       "cannot be changed");
    *now = *goal;
    if (!check_method(job, err)) {
        *now = former;
        return false;
    }
    if (!is_fixed)
        job->samples_most = most_samples(job);
    job->ended_by = ENDED_BY_SAMPLES;
    job->stopped = false;
    return true;
}

// --- progress ------------------------------------------------------------------------------------

static void report(void *context, const char *phase, double fraction)
{
    const struct job *job = context;
    double limit = job->params.goal.seconds;
    if (limit > 0.0 && strcmp(phase, "Rendering") == 0)
        fraction = fmax(fraction, job_elapsed(job) / limit);
    progress_report(job->params.progress, phase, fraction);
}

static bool should_stop(void *context)
{
    const struct job *job = context;
    return !job->deal.is_in_block && progress_should_stop(job->params.progress);
}

struct progress job_progress(struct job *job)
{
    return (struct progress){report, should_stop, job};
}

// --- life ----------------------------------------------------------------------------------------

bool job_init(const struct job_params *params, struct job *job, struct err *err)
{
    *job = (struct job){
        .params = *params,
        .scene = params->scene,
        .gpu = params->renderer.gpu,
        .is_open_ended = params->goal.seconds > 0.0 || params->goal.adaptive,
        .error = film_error_none("it was not estimated"),
    };
    if (!params->command)
        job->params.command = "";
    return settle_goal(job, err);
}

bool job_open(struct job *job, struct err *err)
{
    return job_choose_integrator(job, err) && job_checkpoint_open(job, err) &&
           job_check_merged(job, err) && job_open_trace(job, err);
}

static void note_start(struct job *job)
{
    const struct render_stats *stats = &job->renderer.stats;
    job->seconds.load += stats->flatten_seconds;
    job->seconds.bvh += stats->bvh_seconds;
    job->seconds.bvh_uncached = job->renderer.bvh.stats.cached_seconds;
    job->seconds.upload = stats->upload_seconds;
    job->seconds.compile = stats->compile_seconds;
}

// Creates the renderer. If the device is lost meanwhile, reopens it and begins again, because
// nothing has been rendered yet.
static bool create_renderer(struct job *job, const struct renderer_params *params, struct err *err)
{
    struct err failure = {0};
    while (!renderer_create(params, &job->renderer, err)) {
        if (!job->gpu->lost || err->code != ERR_GPU || job->rescue.reopened == job->params.reopens)
            return false;
        job->rescue.reopened++;
        log_warn("%s: opening the device again and rendering from the beginning", err->msg);
        if (!gpu_reopen(job->gpu, &failure))
            return err_set(err, ERR_GPU, "%s; it could not be opened again: %s", err->msg,
                           failure.msg);
        *err = (struct err){0};
    }
    return true;
}

bool job_create(struct job *job, struct err *err)
{
    struct renderer_params params = job->params.renderer;
    job->progress = job_progress(job);
    params.scene = job->scene;
    params.tiles = job->params.goal.adaptive;
    params.open_ended = job_is_open_ended(job);
    params.progress = &job->progress;
    if (!create_renderer(job, &params, err))
        return false;
    note_start(job);
    return job_begin_shard(job, err) && job_checkpoint_restore(job, err) &&
           job_open_blocks(job, err) && job_begin_crew(job, err);
}

bool job_start(const struct job_params *params, struct job *job, struct err *err)
{
    if (job_init(params, job, err) && job_open(job, err) && job_create(job, err))
        return true;
    job_finish(job);
    return false;
}

void job_finish(struct job *job)
{
    if (!job)
        return;
    checkpoint_close(&job->resumed);
    renderer_finish(&job->renderer);
    geometry_finish(&job->geometry);
    arena_finish(&job->rescue.arena);
    arena_finish(&job->film_arena);
    arena_finish(&job->saved.arena);
    arena_finish(&job->arena);
    *job = (struct job){0};
}

const char *job_ended_by(const struct job *job)
{
    static const char *const names[] = {
        [ENDED_BY_SAMPLES] = "spp",   [ENDED_BY_TIME] = "time",     [ENDED_BY_ERROR] = "error",
        [ENDED_BY_SIGNAL] = "signal", [ENDED_BY_DEVICE] = "device", [ENDED_BY_MEMORY] = "memory",
    };
    return names[job->ended_by];
}
