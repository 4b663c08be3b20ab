#include "cli/converge/converge.h"

#include "base/clock.h"
#include "base/file.h"
#include "cli/scene_options.h"
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

// Makes the points of all curves: the given times, or numbers of samples that double from
// --spp-from to --spp.
static bool make_points(struct converge *c, struct err *err)
{
    if (c->options->converge.times) {
        c->seconds = c->options->converge.times;
        c->point_count = c->options->converge.time_count;
        return true;
    }
    uint64_t most = options_given(c->options, OPTION_SPP) ? c->options->scene.settings.spp : 256;
    uint64_t from = c->options->converge.spp_from;
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
    const struct options *options = &curve->variant.options;
    uint64_t start = clock_ns();
    uint32_t camera;
    size_t count = (size_t)c->replicate_count * c->point_count;
    curve->samples = ARENA_NEW(&c->arena, struct converge_sample, count);
    curve->pictures = arena_alloc(&c->arena, c->replicate_count, sizeof(void *));
    curve->points = ARENA_NEW(&c->arena, struct converge_point, c->point_count);
    curve->ratios = ARENA_NEW(&c->arena, struct interval, c->curve_count);
    if (!curve->samples || !curve->pictures || !curve->points || !curve->ratios)
        return err_memory(err, "samples", count * sizeof *curve->samples);
    if (!options_load_scene(&options->scene, &c->progress, &curve->scene_data, &camera, err))
        return false;
    struct job_params params = {
        .renderer = options_renderer_params(&options->device, &c->gpu, &curve->scene_data, camera),
        .scene = &curve->scene_data,
        .goal.samples = c->spp ? c->spp[c->point_count - 1] : 1,
        .progress = &c->progress,
    };
    params.renderer.aovs = c->options->error_by;
    if (!job_start(&params, &curve->job, err))
        return false;
    curve->start_seconds = clock_seconds_since(start);
    return true;
}

// The least time, in seconds, of the pilot that measures the time of a sample for --times.
#define PILOT_SECONDS 0.1

static bool warm_up(struct converge *c, struct converge_curve *curve, struct err *err)
{
    if (!job_warm_up(&curve->job, c->seconds ? PILOT_SECONDS : 0.0, &curve->speed, err))
        return false;
    return !curve->job.stopped || err_set(err, ERR_STOPPED, "stopped before the first replicate");
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
    c->replicate_count = c->options->converge.replicates;
    c->progress = (struct progress){report, should_stop, c};
    c->phase = "Warming up";
    if (!make_points(c, err) || !make_curves(c, err))
        return false;
    if (c->options->study.report && !file_make_folder(c->options->study.report, err))
        return false;
    if (!gpu_open(&c->options->device.gpu, &c->gpu, err))
        return false;
    for (uint32_t i = 0; i < c->curve_count; i++)
        if (!converge_open(c, &c->curves[i], err) || !warm_up(c, &c->curves[i], err))
            return false;
    return true;
}

void converge_finish(struct converge *c)
{
    for (uint32_t i = 0; c->curves && i < c->curve_count; i++) {
        job_finish(&c->curves[i].job);
        scene_finish(&c->curves[i].scene_data);
    }
    gpu_close(&c->gpu);
    arena_finish(&c->arena);
}

// --- rendering -----------------------------------------------------------------------------------

bool converge_advance(struct converge *c, struct job *job, const struct job_step *step,
                      struct err *err)
{
    bool ok = job_is_stopped(job) || job_advance(job, step, err);
    c->stopped |= job->stopped;
    return ok;
}

// Returns the number of samples at a point. With --times it is the number that the measurements so
// far predict for the time.
static uint64_t plan_samples(const struct converge *c, const struct converge_curve *curve,
                             uint32_t point)
{
    if (!c->seconds)
        return c->spp[point];
    double fit = c->seconds[point] * (double)curve->speed.samples / curve->speed.seconds;
    return fit < 1 ? 1 : fit < SETTINGS_SPP_MAX ? (uint64_t)fit : SETTINGS_SPP_MAX;
}

// A replicate of a curve, and the range of the total progress that it takes.
struct run {
    struct converge *c;
    struct converge_curve *curve;
    uint32_t replicate;
    double from, to;
};

static uint64_t run_samples(const struct run *run)
{
    return run->curve->job.renderer.next_sample;
}

static double run_part(const struct run *run, double done, double all)
{
    return run->from + (run->to - run->from) * fmin(done / all, 1.0);
}

static bool advance_to_samples(struct run *run, uint32_t point, struct err *err)
{
    struct converge *c = run->c;
    double all = (double)plan_samples(c, run->curve, c->point_count - 1);
    struct job_step step = {.samples = plan_samples(c, run->curve, point)};
    step.from = run_part(run, (double)run_samples(run), all);
    step.to = run_part(run, (double)step.samples, all);
    return converge_advance(c, &run->curve->job, &step, err);
}

static bool advance_to_time(struct run *run, uint32_t point, struct err *err)
{
    struct converge *c = run->c;
    double all = c->seconds[c->point_count - 1];
    const struct job_step step = {
        .samples = UINT64_MAX,
        .seconds = c->seconds[point],
        .from = run_part(run, job_elapsed(&run->curve->job), all),
        .to = run_part(run, c->seconds[point], all),
    };
    return converge_advance(c, &run->curve->job, &step, err);
}

static bool begin(struct run *run, uint32_t point, struct err *err)
{
    uint32_t seed = run->curve->scene_data.settings.seed + run->replicate;
    return job_begin(&run->curve->job, seed, plan_samples(run->c, run->curve, point), err);
}

static bool measure_replicate(struct run *run, struct err *err)
{
    struct converge *c = run->c;
    struct converge_curve *curve = run->curve;
    // Samplers that stratify over a planned number of samples start again for each point; others
    // continue from the previous point.
    bool is_planned = sample_planning(&curve->scene_data.settings, NULL) != PLANNING_NONE;
    for (uint32_t point = 0; point < c->point_count && !c->stopped; point++) {
        if ((point == 0 || is_planned) && !begin(run, point, err))
            return false;
        if (!(c->seconds && !is_planned ? advance_to_time(run, point, err)
                                        : advance_to_samples(run, point, err)))
            return false;
        struct converge_sample *sample = converge_at(c, curve, run->replicate, point);
        sample->spp = run_samples(run);
        sample->seconds = job_elapsed(&curve->job);
        if (!c->stopped && !converge_measure_point(c, curve, run->replicate, point, err))
            return false;
        c->stopped |= progress_should_stop(&c->progress); // the measurement may be incomplete
    }
    bool is_first = run->replicate == 0; // the pilot was short and slower, so its speed is replaced
    curve->speed.samples = (is_first ? 0 : curve->speed.samples) + run_samples(run);
    curve->speed.seconds = (is_first ? 0 : curve->speed.seconds) + job_elapsed(&curve->job);
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
