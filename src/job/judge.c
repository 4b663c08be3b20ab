// Reads the film, estimates its error, and forecasts the error after twice the rendering time.
#include "base/clock.h"
#include "base/hash.h"
#include "job/bias.h"
#include "job/film_error.h"
#include "job/job_internal.h"
#include "render/sampling_plan.h"
#include <math.h>

uint64_t job_film_samples(const struct job *job)
{
    const struct film_image *film = &job->film;
    if (!job->params.goal.adaptive || film->least_samples < 2)
        return film->least_samples;
    uint64_t sum = 0, pixels = (uint64_t)film->width * film->height;
    for (uint64_t i = 0; i < pixels; i++)
        sum += film->samples[i];
    return pixels ? sum / pixels : 0;
}

uint64_t job_samples(const struct job *job)
{
    bool is_whole = !job->stopped && !job_is_rescued(job);
    if (job->params.goal.adaptive && is_whole)
        return job->renderer.next_sample * job_step_samples(job);
    return job->film.most_samples;
}

double job_total_samples(const struct job *job)
{
    const struct renderer *r = &job->renderer;
    uint64_t pixels = (uint64_t)job->film.width * job->film.height;
    double sum = 0.0;
    if (job->params.goal.frames && !job->params.goal.accumulate) // the film has only the last frame
        return (double)r->next_sample * (double)pixels +
               (double)(r->pass.position << r->pass.shift);
    for (uint64_t i = 0; i < pixels; i++)
        sum += job->film.samples[i];
    return sum;
}

// --- error ---------------------------------------------------------------------------------------

bool job_estimate_error(struct job *job, double confidence, struct half_error *out, struct err *err)
{
    uint64_t start = clock_ns();
    struct arena scratch = {0};
    struct film_error_params params;
    struct err failure = {0};
    bool ok =
        film_error_prepare(&job->renderer, job_film_samples(job), &scratch, &params, &failure);
    params.confidence = confidence;
    if (ok)
        ok = film_error(&job->film, &params, out, err);
    else if (job_is_rescued(job)) { // the device failed before it had found the unseen light
        *out = film_error_none("rendering failed before it could be estimated");
        ok = true;
    } else if (err)
        *err = failure;
    arena_finish(&scratch);
    job->seconds.judge += clock_seconds_since(start);
    return ok;
}

bool job_prepare_estimates(struct job *job, struct err *err)
{
    uint64_t start = clock_ns();
    struct arena scratch = {0};
    struct film_error_params params; // the renderer owns the data in it
    bool ok = film_error_prepare(&job->renderer, 0, &scratch, &params, err);
    arena_finish(&scratch);
    job->seconds.judge += clock_seconds_since(start);
    return ok;
}

bool job_estimate_begin(struct job *job, struct job_estimate *out, struct err *err)
{
    *out = (struct job_estimate){.aovs = job->renderer.aovs};
    return renderer_read(&job->renderer, &out->arena, &out->film, err) &&
           film_error_prepare(&job->renderer, out->film.least_samples, &out->arena, &out->params,
                              err);
}

bool job_estimate_end(struct job_estimate *estimate, struct err *err)
{
    return film_error(&estimate->film, &estimate->params, &estimate->error, err) &&
           error_sources_find(&estimate->film, estimate->aovs, &estimate->params,
                              &estimate->sources, err);
}

// Computes the true error, and its bias if the halves are independent.
static bool compare(struct job *job, struct err *err)
{
    const struct film_image *film = &job->film;
    const struct reference *reference = job->params.reference;
    reference_compare(reference, (const float(*)[3])film->mean, NULL, &job->against);
    bool has_halves = film->least_samples >= 2 && !job_shares_depths(job) &&
                      !halves_are_contiguous(&job->renderer);
    const struct forecast_bias_params params = {
        .half_a = (const float(*)[3])film->half_a,
        .half_b = (const float(*)[3])film->half_b,
        .reference = (const float(*)[3])reference->image.pixels,
        .means = reference->means,
        .width = film->width,
        .height = film->height,
        .reference_halves = {reference->halves[0], reference->halves[1]},
        .reference_error = reference->local_relmse,
    };
    return !has_halves || forecast_find_bias(&params, &job->bias) ||
           err_memory(err, "bias", (uint64_t)film->width * film->height * 16);
}

bool job_judge_end(struct job *job, struct err *err)
{
    return job_is_rescued(job) ? job_judge_film(job, err) : job_read_film(job, err);
}

bool job_read_film(struct job *job, struct err *err)
{
    return job_fetch_film(job, err) && job_judge_film(job, err);
}

bool job_find_sources(const struct job *job, struct error_sources *out, struct err *err)
{
    const struct film_error_params params = film_error_of(&job->renderer, job->film.least_samples);
    bool ok = error_sources_find(&job->film, job->renderer.aovs, &params, out, err);
    for (uint32_t i = 0; ok && i < out->brightest_count; i++) {
        out->brightest[i].x += job->renderer.window.x;
        out->brightest[i].y += job->renderer.window.y;
    }
    return ok;
}

bool job_judge_film(struct job *job, struct err *err)
{
    uint64_t start = clock_ns();
    const struct film_image *film = &job->film;
    uint64_t pixels = (uint64_t)film->width * film->height;
    job->image_hash = hash_bytes(HASH_INIT, film->mean, pixels * sizeof *film->mean);
    job->against = (struct reference_errors){NAN, NAN, NAN, NAN, NAN};
    job->bias = (struct forecast_bias){.stays = {NAN, NAN, NAN}};
    job->error = film_error_none("it could not be estimated");
    job->seconds.judge += clock_seconds_since(start);
    if (!job_estimate_error(job, 0.0, &job->error, err))
        return false;
    start = clock_ns();
    bool ok =
        job_find_sources(job, &job->sources, err) && (!job->params.reference || compare(job, err));
    job->seconds.judge += clock_seconds_since(start);
    return ok;
}

// --- forecast ------------------------------------------------------------------------------------

// Lists the estimates after 1, 2, 4, 8 ... samples per pixel (or rounds, or frames).
static size_t list_looks(const struct job *job, struct forecast_look *out, size_t most)
{
    size_t count = 0;
    uint64_t step = job->params.goal.adaptive ? job->round_samples : 1;
    for (uint32_t i = 0; i < job->trace.count && count < most; i++) {
        const struct trace_row *row = &job->trace.rows[i];
        uint64_t steps = (uint64_t)row->spp / step;
        if ((steps & (steps - 1)) == 0)
            out[count++] = (struct forecast_look){row->spp, row->local_relmse, row->ci_low,
                                                  row->ci_high, 0.95};
    }
    for (uint32_t i = 0; i < job->look_count && job->trace.count == 0 && count < most; i++) {
        const struct job_look *look = &job->looks[i];
        const struct half_error *e = &look->error;
        uint64_t steps = (uint64_t)look->samples / step;
        if ((steps & (steps - 1)) == 0)
            out[count++] = (struct forecast_look){look->samples, e->local_relmse, e->ci_low,
                                                  e->ci_high, look->confidence};
    }
    return count;
}

// Returns whether the forecast uses the bound in place of the error. The bound of contiguous halves
// decreases as fast as the error.
static bool goes_by_bound(const struct job *job)
{
    return job->error.bounded && halves_are_contiguous(&job->renderer);
}

// Returns the error due to noise. If there is a reference, this is the error measured with it, and
// its interval is, relative to the value, as wide as that from the half-buffers.
static struct interval noise(const struct job *job)
{
    const struct half_error *e = &job->error;
    if (goes_by_bound(job))
        return (struct interval){e->at_most, e->at_most, e->at_most};
    struct interval error = {e->local_relmse, e->ci_low, e->ci_high};
    double stays = job->bias.stays.value;
    if (!job->params.reference || !isfinite(stays))
        return error;
    // The measured error, and the error that the halves predict on average, both relative to the
    // reference's brightness.
    double expected = job->against.local_relmse - stays;
    double reached = job->bias.is_certain ? expected : job->against.local_relmse;
    double factor = 0.5 * (expected + reached) / e->local_relmse;
    if (!(factor > 0.0))
        return error;
    return (struct interval){error.value * factor, error.low * factor, error.high * factor};
}

static const char *why_no_forecast(const struct job *job)
{
    if (job->params.goal.frames && !job->params.goal.accumulate)
        return "frames that do not accumulate do not improve with time";
    return job->error.known || goes_by_bound(job) ? NULL : job->error.reason;
}

const char *job_forecast(const struct job *job, struct forecast *out)
{
    struct forecast_look looks[128];
    const struct settings *settings = &job->scene->settings;
    // Samplers that use the planned number of samples render a different image for each such
    // number, so an earlier estimate does not belong to the same sequence.
    bool grows_evenly = sample_planning(settings, NULL) == PLANNING_NONE;
    const char *reason = why_no_forecast(job);
    struct forecast_params params = {
        .looks = looks,
        .count = !reason && grows_evenly ? list_looks(job, looks, 128) : 0,
        .error = {NAN, NAN, NAN},
        .spread = job->error.spread,
        .spread_terms = job->error.spread_terms,
        .independent = settings->sampler == SAMPLER_PCG || settings->sampler == SAMPLER_LCG,
    };
    if (!reason)
        params.error = noise(job);
    if (job->params.reference && job->bias.is_certain)
        params.stays = job->bias.stays;
    forecast_find_error(&params, out);
    return reason || isfinite(out->error.value) ? reason : "the two halves are equal";
}
