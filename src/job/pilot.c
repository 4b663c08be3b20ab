// A pilot renders a few samples that are not part of the image. It measures the noise of each tile,
// or the speed of rendering.
#include "job/job_internal.h"

#include "metrics/metrics.h"

#define PILOT_SAMPLES 16u
#define SPEED_SAMPLES (1u << 16)

// Similar seeds have distinct results (Knuth 1998, section 6.4: 2^32 / golden ratio).
uint32_t job_pilot_seed(uint32_t seed)
{
    return (seed ^ 0x85ebca6bu) * 2654435769u + 0x7f4a7c15u;
}

uint32_t job_reference_seed(uint32_t seed)
{
    return ~seed;
}

// --- how long samples take -----------------------------------------------------------------------

bool job_warm_up(struct job *job, double seconds, struct job_speed *out, struct err *err)
{
    struct job_step step = {.samples = 1, .to = 1e-9};
    *out = (struct job_speed){0};
    if (!job_begin(job, job_pilot_seed(job->scene->settings.seed), SPEED_SAMPLES, err) ||
        !job_advance(job, &step, err))
        return false;
    double start = job_elapsed(job);
    for (step.samples = 2;
         !job_is_stopped(job) && out->seconds < seconds && step.samples <= SPEED_SAMPLES;
         step.samples *= 2) {
        if (!job_advance(job, &step, err))
            return false;
        *out = (struct job_speed){step.samples - 1, job_elapsed(job) - start};
    }
    return true;
}

// --- sample counts by tile -----------------------------------------------------------------------

static bool set_even_plan(struct job *job, struct arena *arena, struct err *err)
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

// Plans the tiles' numbers of samples from the error of each tile of the film that was read last.
static bool make_plan(struct job *job, struct err *err)
{
    const struct film_image *film = &job->film;
    struct tile_plan_params params = {
        .width = film->width,
        .height = film->height,
        .average = job->round_samples,
        .most = (uint32_t)(UINT32_MAX / (job->samples_most / job->round_samples)),
    };
    uint32_t tiles = tiles_along(film->width) * tiles_along(film->height);
    double *variances = ARENA_NEW(&job->arena, double, tiles);
    const struct half_error_params halves = {
        .half_a = (const float(*)[3])film->half_a,
        .half_b = (const float(*)[3])film->half_b,
        .width = film->width,
        .height = film->height,
    };
    if (!variances || !metrics_tile_errors(&halves, TILE_SIDE, variances))
        return err_memory(err, "tiles", tiles * sizeof *variances);
    params.variances = variances;
    return tile_plan_make(&params, &job->arena, &job->plan, err);
}

bool job_run_pilot(struct job *job, struct err *err)
{
    struct renderer *r = &job->renderer;
    // A shard by tiles takes the pilot's samples of the whole picture, too, because all shards must
    // have the same plan.
    const struct film_rows rows = r->rows, all = {0, r->frame.height};
    uint32_t seed = r->frame.seed;
    const struct render_call call = {.samples = 1, .progress_to = 1e-9, .stopped = &job->stopped};
    struct arena scratch = {0};
    renderer_set_rows(r, &all);
    bool ok = set_even_plan(job, &scratch, err) && renderer_restart(r, job_pilot_seed(seed), err) &&
              renderer_render(r, &call, err);
    // Without a plan, the pilot's samples are the only image.
    if (ok && !job->stopped)
        ok = job_fetch_film(job, err) && make_plan(job, err) && renderer_restart(r, seed, err) &&
             renderer_set_plan(r, &job->plan, err);
    renderer_set_rows(r, &rows);
    if (!ok)
        job->plan = (struct tile_plan){0}; // a pilot on a reopened device must make the plan again
    arena_finish(&scratch);
    return ok;
}
