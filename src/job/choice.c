// Chooses the integrator for INTEGRATOR_AUTO, from the scene's features alone if they suffice, else
// by a pilot of both integrators. The choice depends neither on a clock nor on the division of the
// work, so all processes that share a render choose the same integrator.
#include "job/job_internal.h"

#include "base/clock.h"
#include "base/file_system.h"
#include "base/log.h"
#include "metrics/metrics.h"
#include "render/focus.h"
#include "render/light_paths.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

// The pilot's picture has about PILOT_PIXELS pixels, or fewer if the render's picture has fewer.
// Each integrator takes about PILOT_SAMPLES samples in all, and at least PILOT_LEAST samples per
// pixel.
#define PILOT_PIXELS 4096u
#define PILOT_SAMPLES (1u << 17)
#define PILOT_LEAST 32u
// A render with fewer samples has no pilot. On a processor whose driver has the kernels of both
// integrators in its cache, the pilot takes the time of about 1 million samples, which is less than
// 3 % of this number (docs/measurements/2026-11-27-auto.md).
#define WORTH_A_PILOT 33554432.0 // 2^25
// A ray of bidir takes up to this many times as long as one of path, because there are more kernels
// in which few paths are under way (docs/measurements/2026-11-26-light-paths.md).
#define BIDIR_RAY_COST 1.3
// A render with a shorter time limit and no number of samples has no pilot.
#define WORTH_A_PILOT_SECONDS 300.0

static bool choose(struct job *job, uint32_t integrator, const char *reason, struct err *err)
{
    job->choice.is_made = true;
    job->choice.reason = reason;
    job->scene->settings.integrator = integrator;
    if (reason && integrator == INTEGRATOR_PATH)
        job->params.renderer.why_path =
            arena_printf(&job->arena, "--integrator auto has chosen path: %s", reason);
    return reason || err_memory(err, "the choice of an integrator", sizeof job->choice);
}

// --- the choice of an earlier run ----------------------------------------------------------------

// Chooses the integrator in an identity, if that is one of the two between which auto chooses.
static bool adopt(struct job *job, const char *identity, struct err *err)
{
    static const uint32_t integrators[] = {INTEGRATOR_PATH, INTEGRATOR_BIDIR};
    for (int i = 0; i < 2; i++) {
        const char *line = arena_printf(&job->arena, "\n" JOB_INTEGRATOR_LINE "%s\n",
                                        integrator_names[integrators[i]]);
        if (!line)
            return choose(job, integrators[i], NULL, err);
        if (!strstr(identity, line))
            continue;
        return choose(job, integrators[i], "an earlier run has chosen it", err);
    }
    return true;
}

static bool adopt_from_file(struct job *job, struct err *err)
{
    const char *path = job->params.checkpoint.path;
    struct checkpoint checkpoint;
    if (job->params.merged)
        return adopt(job, job->params.merged->identity, err);
    if (!path || !job->params.checkpoint.resume || !file_exists(path))
        return true;
    if (!checkpoint_open(path, &job->arena, &checkpoint, err))
        return false;
    bool ok = adopt(job, checkpoint.identity, err);
    checkpoint_close(&checkpoint);
    return ok;
}

// --- the pilot -----------------------------------------------------------------------------------

// Returns the number of samples of all pixels that the whole render takes, also if this process
// renders only a part of it. Returns INFINITY if the number is not known but may be large.
static double samples_planned(const struct job *job)
{
    const struct job_goal *goal = &job->params.goal;
    const struct settings *settings = &job->scene->settings;
    double pixels = (double)settings->width * settings->height;
    if (goal->frames)
        return pixels * goal->frames * goal->samples_per_frame;
    if (goal->samples == 0 && goal->seconds > 0.0)
        return goal->seconds >= WORTH_A_PILOT_SECONDS ? INFINITY : 0.0;
    return goal->samples == 0 && goal->error > 0.0 ? INFINITY : pixels * (double)settings->spp;
}

static bool take_trial(struct job *job, const struct scene *scene, struct arena *arena,
                       struct film_image *film, struct choice_trial *out, struct err *err)
{
    struct renderer_params params = job->params.renderer;
    struct renderer renderer;
    const struct render_call call = {
        .samples = scene->settings.spp, .progress_to = 1e-9, .stopped = &job->stopped};
    params.scene = scene;
    params.progress = &job->progress;
    params.tunes_wave = false;
    if (!renderer_create(&params, &renderer, err))
        return false;
    bool ok = renderer_restart(&renderer, job_pilot_seed(scene->settings.seed), err) &&
              renderer_render(&renderer, &call, err) && renderer_read(&renderer, arena, film, err);
    out->rays = render_stats_rays(&renderer.stats);
    renderer_finish(&renderer);
    return ok;
}

// Returns the mean of weights * (a - b)^2.
static double mean_difference(const double (*weights)[3], const float (*a)[3], const float (*b)[3],
                              uint64_t pixels)
{
    double sum = 0.0;
    for (uint64_t i = 0; i < pixels; i++)
        for (int c = 0; c < 3; c++) {
            double difference = (double)a[i][c] - (double)b[i][c];
            if (weights[i][c] > 0.0) // 0: not finite
                sum += weights[i][c] * difference * difference;
        }
    return sum / (double)pixels;
}

// Estimates the errors of both pictures, relative to the mean of the two. If no camera path has
// found a caustic, the halves of path agree with each other, but not with bidir. The expected
// squared difference of the two pictures is the sum of their errors, so the error of path is at
// least this difference less the error of bidir.
static bool find_errors(const struct film_image *path, const struct film_image *bidir,
                        struct arena *arena, struct integrator_choice *out, struct err *err)
{
    const struct half_error_params both = {
        .half_a = (const float(*)[3])path->mean,
        .half_b = (const float(*)[3])bidir->mean,
        .width = path->width,
        .height = path->height,
    };
    uint64_t pixels = (uint64_t)path->width * path->height;
    double(*found)[3] = arena_alloc(arena, pixels, sizeof *found);
    if (!found || !metrics_half_error_weights(&both, found))
        return err_memory(err, "the error of a pilot", pixels * sizeof *found);
    const double(*weights)[3] = (const double(*)[3])found;
    const float(*path_a)[3] = (const float(*)[3])path->half_a;
    const float(*path_b)[3] = (const float(*)[3])path->half_b;
    const float(*bidir_a)[3] = (const float(*)[3])bidir->half_a;
    const float(*bidir_b)[3] = (const float(*)[3])bidir->half_b;
    double between = mean_difference(weights, both.half_a, both.half_b, pixels);
    out->bidir.error = mean_difference(weights, bidir_a, bidir_b, pixels) / 4.0;
    out->path.error =
        fmax(mean_difference(weights, path_a, path_b, pixels) / 4.0, between - out->bidir.error);
    return true;
}

// Returns the scene with a small picture of the same shape.
static struct scene make_small(const struct job *job)
{
    struct scene small = *job->scene;
    struct settings *settings = &small.settings;
    double scale = sqrt(PILOT_PIXELS / ((double)settings->width * (double)settings->height));
    if (scale < 1.0) {
        settings->width = (uint32_t)fmax(round(settings->width * scale), 1.0);
        settings->height = (uint32_t)fmax(round(settings->height * scale), 1.0);
    }
    uint64_t samples = PILOT_SAMPLES / ((uint64_t)settings->width * settings->height);
    settings->spp = (samples > PILOT_LEAST ? samples : PILOT_LEAST) & ~UINT64_C(1);
    settings->halves = HALVES_INDEPENDENT;
    return small;
}

static bool run_pilot(struct job *job, struct err *err)
{
    struct integrator_choice *choice = &job->choice;
    struct scene small = make_small(job);
    uint64_t start = clock_ns();
    choice->width = small.settings.width;
    choice->height = small.settings.height;
    choice->samples = (uint32_t)small.settings.spp;
    job->progress = job_progress(job);
    // The renderers of the pilot would repeat the warnings of the render.
    enum log_level level = log_set_level(LOG_ERROR);
    struct arena arena = {0};
    struct film_image path, bidir;
    small.settings.integrator = INTEGRATOR_PATH;
    bool ok = take_trial(job, &small, &arena, &path, &choice->path, err);
    small.settings.integrator = INTEGRATOR_BIDIR;
    ok = ok && (job->stopped || (take_trial(job, &small, &arena, &bidir, &choice->bidir, err) &&
                                 find_errors(&path, &bidir, &arena, choice, err)));
    arena_finish(&arena);
    log_set_level(level);
    choice->seconds = clock_seconds_since(start);
    return ok;
}

static bool choose_by_pilot(struct job *job, struct err *err)
{
    const struct integrator_choice *choice = &job->choice;
    struct err failure = {0};
    // A device with too little memory for light paths may have enough for path.
    if (!run_pilot(job, &failure)) {
        if (!job->gpu->lost)
            return choose(job, INTEGRATOR_PATH,
                          arena_printf(&job->arena, "the pilot failed: %s", failure.msg), err);
        *err = failure;
        return false;
    }
    job->choice.is_unfinished = job->stopped;
    if (job->stopped)
        return choose(job, INTEGRATOR_PATH, "the pilot was stopped", err);
    double by_path = choice->path.error * choice->path.rays;
    double by_bidir = choice->bidir.error * choice->bidir.rays * BIDIR_RAY_COST;
    if (!(by_path > 0.0))
        return choose(job, INTEGRATOR_PATH, "the pilot by path has no error", err);
    return choose(job, by_bidir < by_path ? INTEGRATOR_BIDIR : INTEGRATOR_PATH,
                  arena_printf(&job->arena,
                               "in a pilot of %u x %u pixels, bidir needs about %.2g times the "
                               "time of path for the same error",
                               choice->width, choice->height, by_bidir / by_path),
                  err);
}

// --- the choice ----------------------------------------------------------------------------------

static bool check_support(const struct job *job, struct err *err)
{
    const struct renderer_params *params = &job->params.renderer;
    return light_paths_support(
        &(struct light_paths_params){.scene = job->scene,
                                     .flat = &params->geometry->flat,
                                     .camera = &job->scene->cameras[params->camera],
                                     .aovs = params->aovs,
                                     .tiles = job->params.goal.adaptive,
                                     .has_window = params->window.width > 0},
        err);
}

static bool choose_anew(struct job *job, struct err *err)
{
    const struct focus_found found = focus_find(job->scene, &job->params.renderer.geometry->flat);
    struct err refusal = {0};
    if (found.focus == FOCUS_NONE)
        return choose(job, INTEGRATOR_PATH, found.reason, err);
    if (!check_support(job, &refusal))
        return choose(job, INTEGRATOR_PATH, arena_strdup(&job->arena, refusal.msg), err);
    if (found.focus == FOCUS_LOST)
        return choose(job, INTEGRATOR_BIDIR,
                      arena_printf(&job->arena,
                                   "path cannot find the caustics of the delta lights (%u)",
                                   found.delta_lights),
                      err);
    if (samples_planned(job) >= WORTH_A_PILOT)
        return choose_by_pilot(job, err);
    return choose(job, INTEGRATOR_PATH, "the render is too short for a pilot of bidir", err);
}

// The renderers of the pilot and of the render share the geometry.
static bool make_geometry(struct job *job, struct err *err)
{
    struct renderer_params *params = &job->params.renderer;
    const struct geometry_params geometry = {
        .scene = job->scene,
        .bvh = params->bvh,
        .instancing = params->instancing,
        .bvh_cache = params->bvh_cache,
        .progress = job->params.progress,
        .camera = &job->scene->cameras[params->camera],
    };
    if (params->geometry)
        return true;
    if (!geometry_create(&geometry, &job->geometry, err))
        return false;
    params->geometry = &job->geometry;
    job->seconds.load += job->geometry.flatten_seconds;
    job->seconds.bvh += job->geometry.bvh.stats.build_seconds;
    return true;
}

bool job_check_renderer(struct job *job, struct err *err)
{
    struct renderer_params params = job->params.renderer;
    if (job->scene->settings.integrator == INTEGRATOR_BIDIR && !make_geometry(job, err))
        return false;
    params.scene = job->scene;
    params.geometry = job->params.renderer.geometry;
    params.tiles = job->params.goal.adaptive;
    return renderer_check(&params, err);
}

bool job_choose_integrator(struct job *job, struct err *err)
{
    const struct settings *settings = &job->scene->settings;
    if (settings->integrator != INTEGRATOR_AUTO || !job->params.chooses_integrator)
        return true;
    return adopt_from_file(job, err) &&
           (job->choice.is_made || (make_geometry(job, err) && choose_anew(job, err)));
}
