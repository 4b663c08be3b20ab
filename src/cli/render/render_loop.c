// How many samples a render takes, in which steps, and what ends it.
#include "cli/render/render_job.h"

#include "cli/render/render_trace.h"
#include "job/timed_step.h"
#include "render/sampling_plan.h"
#include <math.h>
#include <string.h>

// Of a render with --error or --time and no --spp. Where only --time is given, a clock ends it.
#define ERROR_SAMPLES 65536u
#define TIMED_SAMPLES UINT32_MAX
#define TIMED_SAMPLES_BY_TILE (1u << 20)
// Samples a pixel of the pilot that --adaptive begins with, and of a round of the plan that it
// makes, on average.
#define PILOT_SAMPLES 16u
#define ROUND_SAMPLES 16u

// The pilot's samples are to have nothing in common with the picture's: another seed, which no
// small difference between seeds leads to (Knuth 1998, section 6.4: 2^32 / golden ratio).
static uint32_t pilot_seed(uint32_t seed)
{
    return (seed ^ 0x85ebca6bu) * 2654435769u + 0x7f4a7c15u;
}

// --- progress ------------------------------------------------------------------------------------

static void report(void *context, const char *phase, double fraction)
{
    const struct render_job *job = context;
    double limit = job->options->time_seconds;
    if (limit > 0.0 && strcmp(phase, "Rendering") == 0)
        fraction = fmax(fraction, job->renderer.stats.render_seconds / limit);
    progress_report(job->options->progress, phase, fraction);
}

const struct progress *job_progress(struct render_job *job)
{
    job->progress =
        (struct progress){.report = report, .should_stop = job_should_stop, .context = job};
    return &job->progress;
}

// --- steps ---------------------------------------------------------------------------------------

static bool after_wave(void *context, struct err *err)
{
    return job_checkpoint_when_due(context, err) && job_rescue_copy_when_due(context, err) &&
           job_tev_when_due(context, err);
}

static bool render_steps(struct render_job *job, uint64_t steps, double from, double to,
                         struct err *err)
{
    struct render_call call = {
        .samples = steps,
        .progress_from = from,
        .progress_to = to,
        .stopped = &job->stopped,
        .after_wave = after_wave,
        .context = job,
    };
    return job_is_stopped(job) || renderer_render(&job->renderer, &call, err);
}

// A list that grows by doubling: how many entries there will be may be for a clock or a signal to
// say.
static bool grow(struct arena *arena, void **list, uint32_t count, uint32_t *capacity, size_t size,
                 struct err *err)
{
    if (count < *capacity)
        return true;
    uint32_t larger = *capacity ? 2 * *capacity : 64;
    void *moved = arena_alloc(arena, larger, size);
    if (!moved)
        return err_memory(err, "a list", larger * size);
    if (count)
        memcpy(moved, *list, count * size);
    *list = moved;
    *capacity = larger;
    return true;
}

static bool add_frame_time(struct render_job *job, double ms, struct err *err)
{
    void *list = job->frames_ms;
    if (!grow(&job->arena, &list, job->frame_count, &job->frame_capacity, sizeof ms, err))
        return false;
    job->frames_ms = list;
    job->frames_ms[job->frame_count++] = ms;
    return true;
}

// --- one picture
// ----------------------------------------------------------------------------------

// A step is one sample of every pixel, or a round of the tiles' plan.
static uint64_t step_samples(const struct render_job *job)
{
    return job->options->adaptive ? job->round_samples : 1;
}

static uint64_t steps_done(const struct render_job *job)
{
    return job->renderer.next_sample;
}

// The time of the runs before, of which a checkpoint tells, counts.
static bool render_until(struct render_job *job, uint64_t steps, double expected, struct err *err)
{
    double limit = job->options->time_seconds;
    uint64_t most = renderer_samples_at_once(&job->renderer);
    while (steps_done(job) < steps && !job->stopped) {
        double elapsed = job->renderer.stats.render_seconds;
        uint64_t done = steps_done(job), step = timed_step(limit, elapsed, done, most);
        if (step == 0) {
            job->ended_by = ENDED_BY_TIME;
            break;
        }
        if (step > steps - done)
            step = steps - done;
        if (!render_steps(job, step, (double)done / expected, (double)(done + step) / expected,
                          err))
            return false;
    }
    return true;
}

// From what is done to `steps`; the progress shows the part of `expected` ones, INFINITY where
// that is not known.
static bool advance(struct render_job *job, uint64_t steps, double expected, struct err *err)
{
    if (job->options->time_seconds > 0.0)
        return render_until(job, steps, expected, err);
    uint64_t done = steps_done(job);
    return steps <= done || render_steps(job, steps - done, fmin((double)done / expected, 1.0),
                                         fmin((double)steps / expected, 1.0), err);
}

// The same with the rows of the trace that lie between, but not the one of the end.
static bool render_to(struct render_job *job, uint64_t steps, double expected, struct err *err)
{
    uint64_t next;
    while ((next = job_trace_next(job, steps_done(job))) < steps) {
        if (!advance(job, next, expected, err))
            return false;
        if (job->stopped || job->ended_by == ENDED_BY_TIME)
            return true;
        if (!job_trace_look(job, err))
            return false;
    }
    return advance(job, steps, expected, err);
}

static bool add_look(struct render_job *job, uint64_t samples, struct err *err)
{
    void *list = job->looks;
    struct half_error error;
    if (!job_estimate_error(job, LOOKS_CONFIDENCE, &error, err) ||
        !grow(&job->arena, &list, job->look_count, &job->look_capacity, sizeof *job->looks, err))
        return false;
    job->looks = list;
    job->looks[job->look_count++] = (struct error_look){
        .samples = samples,
        .confidence = LOOKS_CONFIDENCE,
        .error = error,
    };
    return true;
}

// By how much the newest look's bound is above the error that is asked for.
static double excess(const struct render_job *job)
{
    return job->looks[job->look_count - 1].error.at_most / job->options->error;
}

// The error falls with the number of samples, so that the samples that it takes are known as soon
// as the error is. A bound that nobody asked for says nothing about it.
static double expected_samples(const struct render_job *job, uint64_t most)
{
    if (job->look_count > 0 && isfinite(excess(job)))
        return fmin((double)job->looks[job->look_count - 1].samples * excess(job), (double)most);
    return options_given(job->options, OPTION_SPP) ? (double)most : INFINITY;
}

// A checkpoint tells where the next look is, if it was made on the way to the same error.
static void plan_looks(struct render_job *job, uint64_t unit)
{
    uint64_t done = steps_done(job) * step_samples(job);
    bool goes_on =
        done > 0 && job->goal.error == job->options->error && job->goal.next_look >= done;
    if (!goes_on)
        job->goal = (struct job_goal){job->options->error, looks_first(done, unit)};
}

// The look at the bound is one of those that are planned only where it happens to be: a run that
// goes on with a higher bound has the looks that it would have had at once.
static bool render_to_error(struct render_job *job, struct err *err)
{
    uint64_t most = job->samples_most, each = step_samples(job);
    uint64_t unit = each % LOOKS_FIRST == 0 ? each : LOOKS_FIRST * each;
    plan_looks(job, unit);
    while (true) {
        double expected = expected_samples(job, most);
        uint64_t next = job->goal.next_look < most ? job->goal.next_look : most;
        if (!render_to(job, next / each, fmax(expected, (double)next) / (double)each, err))
            return false;
        if (job->stopped || job->ended_by == ENDED_BY_TIME)
            return true;
        // With a trace the look is a row of it, too.
        bool ok = job->options->trace ? job_trace_look(job, err) : job_fetch_film(job, err);
        if (!ok || !add_look(job, next, err))
            return false;
        if (excess(job) < 1.0)
            job->ended_by = ENDED_BY_ERROR;
        if (job->ended_by == ENDED_BY_ERROR || next == most)
            return true;
        job->goal.next_look = looks_next(next, excess(job), unit);
    }
}

static bool render_picture(struct render_job *job, struct err *err)
{
    uint64_t steps = job->samples_most / step_samples(job);
    double before = job->renderer.stats.render_seconds;
    bool ok = job->options->error > 0.0 ? render_to_error(job, err)
                                        : render_to(job, steps, (double)steps, err);
    return ok && add_frame_time(job, (job->renderer.stats.render_seconds - before) * 1e3, err);
}

// --- frames
// ---------------------------------------------------------------------------------------

static bool is_numbered(const struct render_job *job, uint32_t frame)
{
    return job->options->every && (frame + 1) % job->options->every == 0;
}

// Those that a run before this one has finished are not rendered again.
static bool render_frames(struct render_job *job, struct err *err)
{
    const struct options *options = job->options;
    struct renderer *r = &job->renderer;
    uint64_t each = options->spp_per_frame;
    uint32_t frames = options->frames;
    for (uint32_t frame = (uint32_t)(r->next_sample / each); frame < frames && !job_is_stopped(job);
         frame++) {
        bool is_begun = r->next_sample % each != 0 || r->pass.length > 0;
        if (frame > 0 && !options->accumulate && !is_begun && !renderer_clear(r, err))
            return false;
        double before = r->stats.render_seconds;
        if (!render_steps(job, (frame + UINT64_C(1)) * each - r->next_sample,
                          (double)frame / frames, (frame + 1.0) / frames, err) ||
            !add_frame_time(job, (r->stats.render_seconds - before) * 1e3, err))
            return false;
        job->seconds.render = r->stats.render_seconds;
        if (is_numbered(job, frame) && !job->stopped) {
            if (!job_read_film(job, err) || !job_write_outputs(job, frame + 1, err))
                return false;
        }
        bool is_due = job_trace_next(job, frame) == frame + UINT64_C(1);
        if (is_due && frame + 1 < frames && !job->stopped && !job_trace_look(job, err))
            return false;
        if (options->time_seconds > 0.0 && job->seconds.render >= options->time_seconds &&
            frame + 1 < frames) {
            job->ended_by = ENDED_BY_TIME;
            break;
        }
    }
    return true;
}

// --- sample counts by tile
// ------------------------------------------------------------------------

static bool set_even_plan(struct render_job *job, struct arena *arena, struct err *err)
{
    const struct tile_plan_params params = {
        .width = job->renderer.frame.width,
        .height = job->renderer.frame.height,
        .average = PILOT_SAMPLES,
    };
    struct tile_plan plan;
    return tile_plan_make(&params, arena, &plan, err) &&
           renderer_set_plan(&job->renderer, &plan, err);
}

static bool make_plan(struct render_job *job, struct arena *arena, struct err *err)
{
    const struct film_image *film = &job->film;
    struct tile_plan_params params = {
        .width = film->width,
        .height = film->height,
        .average = job->round_samples,
        .most = (uint32_t)(UINT32_MAX / (job->samples_most / job->round_samples)),
    };
    uint32_t tiles = tiles_along(film->width) * tiles_along(film->height);
    double *variances = ARENA_NEW(arena, double, tiles);
    const struct half_error_params halves = {
        .half_a = (const float(*)[3])film->half_a,
        .half_b = (const float(*)[3])film->half_b,
        .width = film->width,
        .height = film->height,
    };
    if (!variances || !metrics_tile_errors(&halves, TILE_SIDE, variances))
        return err_memory(err, "tiles", tiles * sizeof *variances);
    params.variances = variances;
    return tile_plan_make(&params, arena, &job->plan, err);
}

bool job_run_pilot(struct render_job *job, struct err *err)
{
    struct renderer *r = &job->renderer;
    uint32_t seed = r->frame.seed;
    const struct render_call call = {.samples = 1, .progress_to = 1e-9, .stopped = &job->stopped};
    struct arena scratch = {0};
    bool ok = set_even_plan(job, &scratch, err) && renderer_restart(r, pilot_seed(seed), err) &&
              renderer_render(r, &call, err);
    // Without a plan the pilot is all there is.
    if (ok && !job->stopped)
        ok = job_fetch_film(job, err) && make_plan(job, &job->arena, err) &&
             renderer_restart(r, seed, err) && renderer_set_plan(r, &job->plan, err);
    arena_finish(&scratch);
    return ok;
}

uint64_t job_samples(const struct render_job *job)
{
    if (job->options->adaptive && !job->stopped && !job_is_rescued(job))
        return steps_done(job) * step_samples(job);
    return job->film.most_samples;
}

const char *job_ended_by(const struct render_job *job)
{
    static const char *const names[] = {
        [ENDED_BY_SAMPLES] = "spp",   [ENDED_BY_TIME] = "time",     [ENDED_BY_ERROR] = "error",
        [ENDED_BY_SIGNAL] = "signal", [ENDED_BY_DEVICE] = "device", [ENDED_BY_MEMORY] = "memory",
    };
    return names[job->ended_by];
}

// --- all of it
// ------------------------------------------------------------------------------------

static uint64_t most_samples(const struct render_job *job)
{
    const struct options *options = job->options;
    if (options_given(options, OPTION_SPP))
        return options->settings.spp;
    if (options->error > 0.0)
        return ERROR_SAMPLES;
    if (options->time_seconds > 0.0)
        return options->adaptive ? TIMED_SAMPLES_BY_TILE : TIMED_SAMPLES;
    return job->scene.settings.spp;
}

// Of numbers that are no multiple of a round, all is one round.
static void choose_rounds(struct render_job *job)
{
    const struct options *options = job->options;
    bool may_end_early = options->error > 0.0 || options->time_seconds > 0.0;
    if (may_end_early && job->samples_most > ROUND_SAMPLES)
        job->samples_most -= job->samples_most % ROUND_SAMPLES;
    job->round_samples =
        job->samples_most % ROUND_SAMPLES == 0 ? ROUND_SAMPLES : (uint32_t)job->samples_most;
}

bool job_is_open_ended(const struct options *options)
{
    return options->time_seconds > 0.0 || options->adaptive;
}

bool job_settle_samples(struct render_job *job, struct err *err)
{
    const struct options *options = job->options;
    job->samples_most = most_samples(job);
    const char *method;
    enum sample_planning planning = sample_planning(&job->scene.settings, &method);
    // A repeated run, which knows the number, would share another sequence out between the pixels.
    bool is_fixed = planning == PLANNING_NEEDED ||
                    (planning == PLANNING_OPTIONAL && !job_is_open_ended(options));
    if (is_fixed && (options->adaptive || options->error > 0.0))
        return err_set(err, ERR_USAGE,
                       "%s needs to know the samples of every pixel beforehand, and %s is there to "
                       "decide on them: expected only one of the two",
                       method, options->adaptive ? "--adaptive on" : "--error");
    if (job->scene.settings.roulette == ROULETTE_FRAME && options->error > 0.0)
        return err_set(err, ERR_USAGE,
                       "--roulette frame gives the paths of all pixels one depth, and --error asks "
                       "how unlike parts of the picture are: expected only one of the two");
    if (options->adaptive && job->samples_most < TILE_SAMPLES_MIN)
        return err_set(err, ERR_USAGE,
                       "--adaptive on: %u sample a pixel cannot be shared out; "
                       "expected at least --spp %u",
                       (unsigned)job->samples_most, TILE_SAMPLES_MIN);
    if (options->adaptive)
        choose_rounds(job);
    bool apart = options->frames && !options->accumulate;
    if (apart && job->scene.settings.halves == HALVES_CONTIGUOUS)
        return err_set(
            err, ERR_USAGE,
            "--halves contiguous is one sequence for all samples, and frames that do not "
            "accumulate have none in common: expected --accumulate on or --halves "
            "independent");
    if (options->frames) // what samplers plan on
        job->scene.settings.spp = (uint64_t)options->spp_per_frame * (apart ? 1 : options->frames);
    return true;
}

bool job_render(struct render_job *job, struct err *err)
{
    const struct options *options = job->options;
    bool has_plan = job->renderer.tiles.count > 0;
    job->seconds.render_before = job->renderer.stats.render_seconds;
    job->is_rendering = true;
    if (options->adaptive && !has_plan && !job_run_pilot(job, err))
        return false;
    bool ok =
        job->stopped || (options->frames ? render_frames(job, err) : render_picture(job, err));
    if (job->stopped)
        job->ended_by = ENDED_BY_SIGNAL;
    job->seconds.render = job->renderer.stats.render_seconds;
    return ok;
}
