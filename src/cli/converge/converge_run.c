#include "cli/converge/converge.h"

#include "base/clock.h"
#include "base/file.h"
#include "cli/render/render_scene.h"
#include "job/timed_step.h"
#include "render/sampling_plan.h"
#include <math.h>
#include <string.h>

// --- curves --------------------------------------------------------------------------------------

static bool make_curves(struct converge *c, struct err *err)
{
    struct variant *variants;
    if (!variants_make(c->options, &c->arena, &variants, &c->curve_count, err))
        return false;
    c->curves = ARENA_NEW(&c->arena, struct converge_curve, c->curve_count);
    if (!c->curves)
        return err_memory(err, "curves", c->curve_count * sizeof *c->curves);
    for (uint32_t i = 0; i < c->curve_count; i++)
        c->curves[i].variant = variants[i];
    return true;
}

// The times given, or doubling from --spp-from to --spp.
static bool make_points(struct converge *c, struct err *err)
{
    if (c->options->times) {
        c->seconds = c->options->times;
        c->point_count = c->options->time_count;
        return true;
    }
    uint64_t most = options_given(c->options, OPTION_SPP) ? c->options->settings.spp : 256;
    uint64_t from = c->options->spp_from;
    if (from > most)
        return err_set(err, ERR_USAGE, "--spp-from %llu is above --spp %llu",
                       (unsigned long long)from, (unsigned long long)most);
    c->spp = ARENA_NEW(&c->arena, uint64_t, 64);
    if (!c->spp)
        return err_memory(err, "points", 64 * sizeof *c->spp);
    for (uint64_t spp = from; spp <= most; spp *= 2)
        c->spp[c->point_count++] = spp;
    return true;
}

bool converge_open(struct converge *c, struct converge_curve *curve, struct err *err)
{
    uint64_t start = clock_ns();
    uint32_t camera;
    size_t count = (size_t)c->replicate_count * c->point_count;
    curve->samples = ARENA_NEW(&c->arena, struct converge_sample, count);
    curve->pictures = arena_alloc(&c->arena, c->replicate_count, sizeof(void *));
    curve->points = ARENA_NEW(&c->arena, struct converge_point, c->point_count);
    curve->ratios = ARENA_NEW(&c->arena, struct interval, c->curve_count);
    if (!curve->samples || !curve->pictures || !curve->points || !curve->ratios)
        return err_memory(err, "samples", count * sizeof *curve->samples);
    curve->variant.options.progress = &c->progress;
    if (!options_load_scene(&curve->variant.options, &curve->scene_data, &camera, err))
        return false;
    curve->scene_data.settings.spp = c->spp ? c->spp[c->point_count - 1] : 1;
    struct renderer_params params =
        options_renderer_params(&curve->variant.options, &c->gpu, &curve->scene_data, camera);
    if (!renderer_create(&params, &curve->renderer, err))
        return false;
    curve->start_seconds = clock_seconds_since(start);
    return true;
}

// Drivers compile at the first dispatch, which is no part of any replicate. With --times it is also
// measured how long samples take. Its own seed: samples that were seen are no replicate's.
#define PILOT_SECONDS 0.1
#define PILOT_SAMPLES (1u << 16)

static bool run_pilot(struct converge *c, struct converge_curve *curve, struct err *err)
{
    struct renderer *r = &curve->renderer;
    renderer_plan_samples(r, PILOT_SAMPLES);
    if (!renderer_restart(r, ~curve->scene_data.settings.seed ^ 0x9e3779b9u, err) ||
        !converge_advance(c, r, 1, 0.0, 1e-9, err))
        return false;
    double start = r->stats.render_seconds;
    for (uint64_t step = 1; c->seconds && !c->stopped && curve->speed_seconds < PILOT_SECONDS &&
                            curve->speed_samples + step < PILOT_SAMPLES;
         step *= 2) {
        if (!converge_advance(c, r, step, 0.0, 1e-9, err))
            return false;
        curve->speed_samples += step;
        curve->speed_seconds = r->stats.render_seconds - start;
    }
    return !c->stopped || err_set(err, ERR_STOPPED, "stopped before the first replicate");
}

// --- progress ------------------------------------------------------------------------------------

static void report(void *context, const char *phase, double fraction)
{
    struct converge *c = context;
    bool is_rendering = c->phase && strcmp(phase, "Rendering") == 0;
    progress_report(c->options->progress, is_rendering ? c->phase : phase, fraction);
}

static bool should_stop(void *context)
{
    struct converge *c = context;
    return progress_should_stop(c->options->progress);
}

bool converge_prepare(struct converge *c, struct err *err)
{
    c->replicate_count = c->options->replicates;
    c->progress = (struct progress){report, should_stop, c};
    c->phase = "Warming up";
    if (!make_points(c, err) || !make_curves(c, err))
        return false;
    if (c->options->report && !file_make_folder(c->options->report, err))
        return false;
    if (!gpu_open(&c->options->gpu, &c->gpu, err))
        return false;
    for (uint32_t i = 0; i < c->curve_count; i++)
        if (!converge_open(c, &c->curves[i], err) || !run_pilot(c, &c->curves[i], err))
            return false;
    return true;
}

void converge_finish(struct converge *c)
{
    for (uint32_t i = 0; c->curves && i < c->curve_count; i++) {
        renderer_finish(&c->curves[i].renderer);
        scene_finish(&c->curves[i].scene_data);
    }
    gpu_close(&c->gpu);
    arena_finish(&c->arena);
}

// --- rendering -----------------------------------------------------------------------------------

bool converge_advance(struct converge *c, struct renderer *renderer, uint64_t samples, double from,
                      double to, struct err *err)
{
    struct render_call call = {
        .samples = samples,
        .progress_from = from,
        .progress_to = to,
        .stopped = &c->stopped,
    };
    // The renderer asks between the waves of a call, and a call may be one wave.
    c->stopped |= progress_should_stop(&c->progress);
    return c->stopped || renderer_render(renderer, &call, err);
}

// How many samples a point has; with --times as many as fit, by what was measured so far.
static uint64_t plan_samples(const struct converge *c, const struct converge_curve *curve,
                             uint32_t point)
{
    if (!c->seconds)
        return c->spp[point];
    double fit = c->seconds[point] * (double)curve->speed_samples / curve->speed_seconds;
    return fit < 1 ? 1 : fit < SETTINGS_SPP_MAX ? (uint64_t)fit : SETTINGS_SPP_MAX;
}

// One replicate of a curve on its way, and the part of all the work that it is.
struct run {
    struct converge *c;
    struct converge_curve *curve;
    uint32_t replicate;
    double from, to;
    double start;  // on the renderer's clock
    uint64_t done; // samples a pixel
};

static double run_elapsed(const struct run *run)
{
    return run->curve->renderer.stats.render_seconds - run->start;
}

static double run_part(const struct run *run, double done, double all)
{
    return run->from + (run->to - run->from) * fmin(done / all, 1.0);
}

static bool advance_to_samples(struct run *run, uint32_t point, struct err *err)
{
    struct converge *c = run->c;
    uint64_t samples = plan_samples(c, run->curve, point);
    double all = (double)plan_samples(c, run->curve, c->point_count - 1);
    double from = run_part(run, (double)run->done, all), to = run_part(run, (double)samples, all);
    if (!converge_advance(c, &run->curve->renderer, samples - run->done, from, to, err))
        return false;
    run->done = samples;
    return true;
}

static bool advance_to_time(struct run *run, uint32_t point, struct err *err)
{
    struct converge *c = run->c;
    double limit = c->seconds[point], all = c->seconds[c->point_count - 1];
    uint64_t step, most = renderer_samples_at_once(&run->curve->renderer);
    while (!c->stopped && (step = timed_step(limit, run_elapsed(run), run->done, most)) > 0) {
        double part = run_part(run, run_elapsed(run), all);
        if (!converge_advance(c, &run->curve->renderer, step, part, part + 1e-9, err))
            return false;
        run->done += step;
    }
    return true;
}

static bool begin(struct run *run, uint32_t point, struct err *err)
{
    struct renderer *renderer = &run->curve->renderer;
    renderer_plan_samples(renderer, plan_samples(run->c, run->curve, point));
    uint32_t seed = run->curve->scene_data.settings.seed + run->replicate;
    if (!renderer_restart(renderer, seed, err))
        return false;
    run->start = renderer->stats.render_seconds;
    run->done = 0;
    return true;
}

static bool measure_replicate(struct run *run, struct err *err)
{
    struct converge *c = run->c;
    struct converge_curve *curve = run->curve;
    // Samples that are planned begin anew for each point; others go on from the one before.
    bool is_planned = sample_planning(&curve->scene_data.settings, NULL) != PLANNING_NONE;
    for (uint32_t point = 0; point < c->point_count && !c->stopped; point++) {
        if ((point == 0 || is_planned) && !begin(run, point, err))
            return false;
        if (!(c->seconds && !is_planned ? advance_to_time(run, point, err)
                                        : advance_to_samples(run, point, err)))
            return false;
        struct converge_sample *sample = converge_at(c, curve, run->replicate, point);
        sample->spp = run->done;
        sample->seconds = run_elapsed(run);
        if (!c->stopped && !converge_measure_point(c, curve, run->replicate, point, err))
            return false;
        c->stopped |= progress_should_stop(&c->progress); // what is measured may be incomplete
    }
    bool is_first = run->replicate == 0; // a pilot is short, and slower
    curve->speed_samples = (is_first ? 0 : curve->speed_samples) + run->done;
    curve->speed_seconds = (is_first ? 0 : curve->speed_seconds) + run_elapsed(run);
    return true;
}

bool converge_measure(struct converge *c, struct err *err)
{
    double all = (double)c->replicate_count * c->curve_count, done = 0;
    c->phase = "Replicates";
    for (uint32_t replicate = 0; replicate < c->replicate_count; replicate++) {
        for (uint32_t i = 0; i < c->curve_count; i++, done++) {
            struct run run = {
                .c = c,
                .curve = &c->curves[i],
                .replicate = replicate,
                .from = done / all,
                .to = (done + 1) / all,
            };
            if (!measure_replicate(&run, err))
                return false;
            if (c->stopped)
                return true;
        }
        c->replicates_done = replicate + 1;
    }
    return true;
}
