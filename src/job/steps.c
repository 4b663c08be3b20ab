// Renders in steps until a number of samples or a time is reached.
#include "job/job_internal.h"

#include "base/clock.h"
#include "render/sampling_plan.h"
#include <math.h>

bool job_is_stopped(struct job *job)
{
    job->stopped |= progress_should_stop(job->params.progress);
    return job->stopped;
}

void job_go_on(struct job *job)
{
    job->stopped = false;
}

double job_elapsed(const struct job *job)
{
    return job->renderer.stats.render_seconds - job->begun_seconds;
}

bool job_begin(struct job *job, uint32_t seed, uint64_t planned, struct err *err)
{
    struct renderer *r = &job->renderer;
    renderer_plan_samples(r, planned);
    if (!renderer_restart(r, seed, err))
        return false;
    job->begun_seconds = r->stats.render_seconds;
    job->ended_by = ENDED_BY_SAMPLES;
    job->plan = (struct tile_plan){0};
    job->look_count = job->frame_count = job->trace.count = 0;
    return true;
}

static bool after_wave(void *context, struct err *err)
{
    struct job *job = context;
    const struct job_listener *listener = &job->params.listener;
    // With a crew, the job's film may lack samples that other members have, so no checkpoint or
    // copy of the film is made after a wave.
    if (job->params.crew && job->is_rendering)
        return job_attend_crew(job, err);
    return (!job->is_rendering ||
            (job_checkpoint_when_due(job, err) && job_rescue_copy_when_due(job, err))) &&
           (!listener->after_wave || listener->after_wave(listener->context, err));
}

bool job_render_to(struct job *job, const struct job_step *step, uint64_t steps, double from,
                   double to, struct err *err)
{
    struct render_call call = {
        .progress_from = from,
        .progress_to = to,
        .stopped = &job->stopped,
        .after_wave = after_wave,
        .observer = step->observer,
        .context = job,
    };
    struct err failure = {0};
    do {
        call.samples = steps - job->renderer.next_sample;
        if (renderer_render(&job->renderer, &call, &failure))
            return true;
    } while (job_recover(job, &failure));
    if (err)
        *err = failure;
    return false;
}

// Returns how many samples, or rounds, to render next, if `done` of them took `elapsed` seconds.
// Returns 0 if `limit` seconds have passed. Steps grow up to `most` as long as they are short
// relative to the remaining time, so that the render ends within one step of the limit.
static uint64_t timed_step(double limit, double elapsed, uint64_t done, uint64_t most)
{
    if (done == 0)
        return 1;
    double fits = (limit - elapsed) * (double)done / elapsed;
    if (fits < 1.0)
        return 0;
    // Only half of the remaining time is used, because the estimate is noisy.
    return fits < 2.0 * (double)most ? (uint64_t)(0.5 * fits) + 1 : most;
}

// Renders until the time limit; steps become shorter when little time is left.
static bool advance_by_clock(struct job *job, const struct job_step *step, struct err *err)
{
    const struct renderer *r = &job->renderer;
    uint64_t most = renderer_samples_at_once(r), first = r->next_sample;
    double before = job_elapsed(job), span = step->to - step->from;
    while (r->next_sample < step->samples && !job_is_stopped(job)) {
        double elapsed = job_elapsed(job);
        uint64_t done = r->next_sample, samples = timed_step(step->seconds, elapsed, done, most);
        if (samples == 0) {
            job->ended_by = ENDED_BY_TIME;
            break;
        }
        if (samples > step->samples - done)
            samples = step->samples - done;
        double part = fmax((double)(done - first) / (double)(step->samples - first),
                           (elapsed - before) / (step->seconds - before));
        double from = step->from + span * fmin(part, 1.0);
        if (!job_render_to(job, step, done + samples, from, from + 1e-9, err))
            return false;
    }
    return true;
}

bool job_advance(struct job *job, const struct job_step *step, struct err *err)
{
    if (job->params.crew && job->is_rendering)
        return job_advance_crew(job, step, err);
    if (step->seconds > 0.0)
        return advance_by_clock(job, step, err);
    uint64_t done = job->renderer.next_sample;
    return step->samples <= done ||
           job_render_to(job, step, step->samples, step->from, step->to, err);
}

// --- reading the film ----------------------------------------------------------------------------

// Reads the film. If the device is lost meanwhile, reopens it and restores the film's state.
static bool read_film(struct job *job, struct err *err)
{
    struct renderer *r = &job->renderer;
    const struct job_step step = {.to = 1.0};
    uint64_t steps = r->next_sample;
    bool is_whole = r->pass.length == 0;
    struct err failure = {0};
    while (!job_read_now(job, &failure)) {
        bool is_back =
            is_whole && job_recover(job, &failure) &&
            (r->next_sample >= steps || job_render_to(job, &step, steps, 0.0, 1.0, &failure));
        if (!is_back) {
            if (err)
                *err = failure;
            return false;
        }
    }
    return true;
}

bool job_fetch_film(struct job *job, struct err *err)
{
    uint64_t start = clock_ns();
    bool ok = read_film(job, err);
    job->seconds.judge += clock_seconds_since(start);
    return ok;
}
