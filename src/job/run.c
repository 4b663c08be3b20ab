// Renders until the goal is reached: in steps that end when a caller or an interim test needs the
// film.
#include "job/job_internal.h"

#include "metrics/metrics.h"
#include <math.h>

static bool add_frame_time(struct job *job, double ms, struct err *err)
{
    double *added = arena_append(&job->arena, &job->frames_ms, &job->frame_count,
                                 &job->frame_capacity, sizeof *added, NULL);
    if (!added)
        return err_memory(err, "times of frames", job->frame_count * sizeof *added);
    *added = ms;
    return true;
}

static bool is_over(const struct job *job)
{
    return job->stopped || job->ended_by != ENDED_BY_SAMPLES;
}

// Returns the number of finished steps. A step is one sample of every pixel, or a round of the
// tiles' plan.
static uint64_t steps_done(const struct job *job)
{
    return job->renderer.next_sample;
}

// --- one image -----------------------------------------------------------------------------------

// Renders until `steps` steps are done. The progress is the fraction of `expected` steps, which is
// INFINITY if not known. The time of earlier runs, from a checkpoint, counts.
static bool advance(struct job *job, uint64_t steps, double expected, struct err *err)
{
    const double first = (double)job->samples_first;
    const struct job_step step = {
        .samples = steps,
        .seconds = job->params.goal.seconds,
        .from = fmin(((double)steps_done(job) - first) / (expected - first), 1.0),
        .to = fmin(((double)steps - first) / (expected - first), 1.0),
    };
    return job_is_stopped(job) || job_advance(job, &step, err);
}

// Renders until `steps` steps are done, and adds the rows of the trace that are due before the end.
static bool advance_with_rows(struct job *job, uint64_t steps, double expected, struct err *err)
{
    uint64_t next;
    while ((next = job_next_row(job, steps_done(job))) < steps) {
        if (!advance(job, next, expected, err))
            return false;
        if (is_over(job))
            return true;
        if (!job_look_for_trace(job, err))
            return false;
    }
    return advance(job, steps, expected, err);
}

static bool add_look(struct job *job, uint64_t samples, struct err *err)
{
    struct half_error error;
    if (!job_estimate_error(job, LOOKS_CONFIDENCE, &error, err))
        return false;
    struct job_look *added = arena_append(&job->arena, &job->looks, &job->look_count,
                                          &job->look_capacity, sizeof *added, NULL);
    if (!added)
        return err_memory(err, "looks at the error", job->look_count * sizeof *added);
    *added = (struct job_look){
        .samples = (double)samples,
        .seconds = job_elapsed(job),
        .confidence = LOOKS_CONFIDENCE,
        .error = error,
    };
    return true;
}

// Returns the ratio of the newest bound to the error limit.
static double excess(const struct job *job)
{
    return job->looks[job->look_count - 1].error.at_most / job->params.goal.error;
}

// Returns the number of samples that the error limit is expected to need, from the latest estimate,
// because the error decreases with the number of samples. A bound without an estimate does not give
// that number.
static double expected_samples(const struct job *job, uint64_t most)
{
    if (job->look_count > 0 && isfinite(excess(job)))
        return fmin(job->looks[job->look_count - 1].samples * excess(job), (double)most);
    return job->params.goal.samples > 0 ? (double)most : INFINITY;
}

// Returns the unit of the numbers of samples at which interim tests are made.
static uint64_t looks_unit(const struct job *job)
{
    const uint64_t each = job_step_samples(job);
    return each % LOOKS_FIRST == 0 ? each : LOOKS_FIRST * each;
}

// Plans the next interim test, unless a checkpoint has stored a plan for the same error limit.
static void plan_looks(struct job *job, uint64_t unit)
{
    uint64_t done = steps_done(job) * job_step_samples(job);
    bool goes_on = done > 0 && job->looks_error == job->params.goal.error && job->next_look >= done;
    if (goes_on)
        return;
    job->looks_error = job->params.goal.error;
    job->next_look = looks_first(done, unit);
}

// Renders until the error limit is reached. The limit of samples is not an interim test unless one
// was planned there: so a run that is resumed with a higher limit has the same tests as a single
// run.
static bool render_to_error(struct job *job, struct err *err)
{
    uint64_t most = job->samples_most, each = job_step_samples(job), unit = looks_unit(job);
    plan_looks(job, unit);
    while (true) {
        double expected = expected_samples(job, most);
        uint64_t next = job->next_look < most ? job->next_look : most;
        if (!advance_with_rows(job, next / each, fmax(expected, (double)next) / (double)each, err))
            return false;
        if (is_over(job))
            return true;
        // With a trace, the estimate is also added to it as a row.
        bool ok = job->params.keeps_trace ? job_look_for_trace(job, err) : job_fetch_film(job, err);
        if (!ok || !add_look(job, next, err))
            return false;
        if (excess(job) < 1.0)
            job->ended_by = ENDED_BY_ERROR;
        if (job->ended_by == ENDED_BY_ERROR || next == most)
            return true;
        job->next_look = looks_next(next, excess(job), unit);
    }
}

uint64_t job_next_stop(struct job *job)
{
    const uint64_t row = job_next_row(job, steps_done(job));
    uint64_t next = job->samples_most;
    if (job->params.goal.error > 0.0) {
        plan_looks(job, looks_unit(job));
        next = job->next_look < next ? job->next_look : next;
    }
    return row < next ? row : next;
}

static bool render_image(struct job *job, struct err *err)
{
    uint64_t steps = job->samples_most / job_step_samples(job);
    double before = job->renderer.stats.render_seconds;
    bool ok = job->params.goal.error > 0.0 ? render_to_error(job, err)
                                           : advance_with_rows(job, steps, (double)steps, err);
    return ok && add_frame_time(job, (job->renderer.stats.render_seconds - before) * 1e3, err);
}

// --- frames --------------------------------------------------------------------------------------

static bool begin_anew(struct job *job, struct err *err)
{
    struct err failure = {0};
    while (!renderer_clear(&job->renderer, &failure))
        if (!job_recover(job, &failure)) {
            if (err)
                *err = failure;
            return false;
        }
    return job_rescue_begin(job, err);
}

// Renders one frame. First empties the film, unless the frame adds to the frames before it, or an
// earlier run has begun it.
static bool render_frame(struct job *job, uint32_t frame, struct err *err)
{
    const struct job_goal *goal = &job->params.goal;
    struct renderer *r = &job->renderer;
    bool is_begun = r->next_sample % goal->samples_per_frame != 0 || r->pass.length > 0;
    if (frame > 0 && !goal->accumulate && !is_begun && !begin_anew(job, err))
        return false;
    double before = r->stats.render_seconds;
    const struct job_step step = {
        .samples = (frame + UINT64_C(1)) * goal->samples_per_frame,
        .from = (double)frame / goal->frames,
        .to = (frame + 1.0) / goal->frames,
    };
    return (job_is_stopped(job) || job_advance(job, &step, err)) &&
           add_frame_time(job, (r->stats.render_seconds - before) * 1e3, err);
}

static bool tell_frame(struct job *job, uint32_t done, struct err *err)
{
    const struct job_listener *listener = &job->params.listener;
    job->seconds.render = job->renderer.stats.render_seconds;
    return job->stopped || !listener->after_frame ||
           listener->after_frame(listener->context, done, err);
}

// Renders all frames, except those that an earlier run has finished.
static bool render_frames(struct job *job, struct err *err)
{
    const struct job_goal *goal = &job->params.goal;
    uint32_t frame = (uint32_t)(job->renderer.next_sample / goal->samples_per_frame);
    for (; frame < goal->frames && !job_is_stopped(job); frame++) {
        bool is_last = frame + 1 == goal->frames;
        if (!render_frame(job, frame, err) || !tell_frame(job, frame + 1, err))
            return false;
        bool has_row = job_next_row(job, frame) == frame + UINT64_C(1) && !is_last;
        if (has_row && !job->stopped && !job_look_for_trace(job, err))
            return false;
        if (goal->seconds > 0.0 && job->seconds.render >= goal->seconds && !is_last) {
            job->ended_by = ENDED_BY_TIME;
            break;
        }
    }
    return true;
}

// --- all of it -----------------------------------------------------------------------------------

// Computes the data for error estimates before rendering, while the device works, so that the error
// of a rescued film can be estimated, too.
static bool prepare(struct job *job, struct err *err)
{
    struct err failure = {0};
    bool was_pilot = job_is_pilot(job);
    if (!job_rescue_begin(job, err))
        return false;
    while (!job_prepare_estimates(job, &failure) ||
           (job_is_pilot(job) && !job_run_pilot(job, &failure)))
        if (!job_recover(job, &failure)) {
            if (err)
                *err = failure;
            return false;
        }
    return !was_pilot || job_rescue_begin(job, err); // the film is empty again, and the tiles' plan
                                                     // exists
}

bool job_run(struct job *job, struct err *err)
{
    const struct job_goal *goal = &job->params.goal;
    job->seconds.render_before = job->renderer.stats.render_seconds;
    job->is_rendering = true;
    if (!prepare(job, err))
        return false;
    bool ok = job->stopped ||
              (job_fill_blocks(job, err) &&
               (job->stopped || (goal->frames ? render_frames(job, err) : render_image(job, err))));
    if (job->stopped)
        job->ended_by = ENDED_BY_SIGNAL;
    job->seconds.render = job->renderer.stats.render_seconds;
    return ok;
}
