#include "converge.h"

#include "clock.h"
#include "log.h"
#include "perceptual.h"
#include "render_job.h"
#include <math.h>
#include <stdio.h>
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

// Doubling from --spp-from to --spp.
static bool make_points(struct converge *c, struct err *err)
{
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

static bool open_curve(struct converge *c, struct converge_curve *curve, struct err *err)
{
    uint64_t start = clock_ns();
    uint32_t camera;
    size_t count = (size_t)c->replicate_count * c->point_count;
    curve->samples = ARENA_NEW(&c->arena, struct converge_sample, count);
    curve->pictures = arena_alloc(&c->arena, c->replicate_count, sizeof *curve->pictures);
    curve->error = ARENA_NEW(&c->arena, struct interval, c->point_count);
    curve->seconds = ARENA_NEW(&c->arena, struct interval, c->point_count);
    if (!curve->samples || !curve->pictures || !curve->error || !curve->seconds)
        return err_memory(err, "samples", count * sizeof *curve->samples);
    if (!job_load_scene(&curve->variant.options, &curve->scene_data, &camera, err))
        return false;
    curve->scene_data.settings.spp = c->spp[c->point_count - 1];
    struct renderer_params params =
        job_renderer_params(&curve->variant.options, &c->gpu, &curve->scene_data, camera);
    if (!renderer_create(&params, &curve->renderer, err))
        return false;
    curve->start_seconds = clock_seconds_since(start);
    return true;
}

bool converge_prepare(struct converge *c, struct err *err)
{
    c->replicate_count = c->options->replicates;
    if (!make_points(c, err) || !make_curves(c, err) || !gpu_open(&c->options->gpu, &c->gpu, err))
        return false;
    for (uint32_t i = 0; i < c->curve_count; i++)
        if (!open_curve(c, &c->curves[i], err))
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

static bool advance(struct converge *c, struct renderer *renderer, uint64_t samples, double from,
                    double to, struct err *err)
{
    struct render_call call = {
        .samples = samples,
        .progress_from = from,
        .progress_to = to,
        .stopped = &c->stopped,
    };
    return renderer_render(renderer, &call, err);
}

// A hundred times the samples of the longest curve, with a seed of its own, by the settings without
// what is varied.
#define REFERENCE_FACTOR 100

static bool render_reference(struct converge *c, uint32_t scene, struct err *err)
{
    struct converge_reference *out = &c->references[scene];
    struct converge_curve curve = {.variant = {.options = *c->options, .scene = scene}};
    curve.variant.options.arguments[0] = c->options->arguments[scene];
    struct film_image film;
    bool ok = open_curve(c, &curve, err);
    out->spp = REFERENCE_FACTOR * c->spp[c->point_count - 1];
    curve.renderer.frame.samples = (uint32_t)out->spp;
    ok = ok && renderer_restart(&curve.renderer, ~curve.scene_data.settings.seed, err) &&
         advance(c, &curve.renderer, out->spp, 0.0, 1.0, err) &&
         renderer_read(&curve.renderer, &c->arena, &film, err);
    if (ok && c->stopped)
        ok = err_set(err, ERR_STOPPED, "stopped while the reference was rendered");
    if (ok) {
        out->picture.image = (struct image){film.width, film.height, film.mean};
        reference_set_noise(&out->picture, (const float(*)[3])film.half_a,
                            (const float(*)[3])film.half_b);
    }
    renderer_finish(&curve.renderer);
    scene_finish(&curve.scene_data);
    return ok;
}

static bool read_reference(struct converge *c, uint32_t scene, struct err *err)
{
    struct converge_reference *out = &c->references[scene];
    if (!reference_read(out->name, &c->arena, &out->picture, err))
        return false;
    for (uint32_t i = 0; i < c->curve_count; i++) {
        const struct settings *settings = &c->curves[i].scene_data.settings;
        if (c->curves[i].variant.scene == scene &&
            !reference_check_size(&out->picture, out->name, c->options->arguments[scene],
                                  settings->width, settings->height, err))
            return false;
    }
    if (!out->picture.noise_known)
        log_info("%s: its own noise is not subtracted: %s", out->name, out->picture.reason);
    return true;
}

bool converge_reference(struct converge *c, struct err *err)
{
    const char *name = c->options->reference;
    uint32_t scenes = c->options->argument_count;
    c->references = ARENA_NEW(&c->arena, struct converge_reference, scenes);
    if (!c->references)
        return err_memory(err, "references", scenes * sizeof *c->references);
    for (uint32_t scene = 0; scene < scenes; scene++) {
        if (name && strcmp(name, "none") == 0)
            continue;
        c->references[scene].name = name ? name : "auto";
        bool automatic = !name || strcmp(name, "auto") == 0;
        if (!(automatic ? render_reference(c, scene, err) : read_reference(c, scene, err)))
            return false;
    }
    return true;
}

// --- measuring -----------------------------------------------------------------------------------

static void compare(const struct converge_reference *reference, const struct film_image *film,
                    bool with_perception, double metric[CONVERGE_METRICS])
{
    const float(*image)[3] = (const float(*)[3])film->mean;
    const float(*truth)[3] = (const float(*)[3])reference->picture.image.pixels;
    struct metrics m;
    metrics_compare(image, truth, (uint64_t)film->width * film->height, &m);
    metric[CONVERGE_MSE] = m.mse - reference->picture.mse;
    metric[CONVERGE_RELMSE] = m.relmse - reference->picture.relmse;
    metric[CONVERGE_SMAPE] = m.smape;
    metric[CONVERGE_PSNR] = m.psnr;
    const struct picture_pair pair = {image, truth, film->width, film->height};
    if (!with_perception)
        return;
    if (!metrics_ssim(&pair, &metric[CONVERGE_SSIM]))
        metric[CONVERGE_SSIM] = NAN;
    if (!metrics_flip(&pair, FLIP_PIXELS_PER_DEGREE, NULL, &metric[CONVERGE_FLIP]))
        metric[CONVERGE_FLIP] = NAN;
}

// Without a reference: what the half-buffers say, over a smoothed denominator, since a pixel's own
// noise would make the estimate too small; not known where that has too little to go by.
static bool estimate(const struct film_image *film, uint64_t samples,
                     double metric[CONVERGE_METRICS], struct err *err)
{
    struct half_error error;
    const struct half_error_params params = {
        .half_a = (const float(*)[3])film->half_a,
        .half_b = (const float(*)[3])film->half_b,
        .width = film->width,
        .height = film->height,
        .samples = samples,
    };
    if (!metrics_half_error(&params, &error))
        return err_memory(err, "error estimate", (uint64_t)film->width * film->height * 12);
    if (error.known) {
        metric[CONVERGE_MSE] = error.mse;
        metric[CONVERGE_RELMSE] = error.relmse;
    }
    return true;
}

static bool keep_picture(struct converge *c, struct converge_curve *curve, uint32_t replicate,
                         const struct film_image *film, struct err *err)
{
    uint64_t pixels = (uint64_t)film->width * film->height;
    float(*kept)[3] = arena_alloc(&c->arena, pixels, sizeof *kept);
    if (!kept)
        return err_memory(err, "a picture", pixels * sizeof *kept);
    memcpy(kept, film->mean, pixels * sizeof *kept);
    curve->pictures[replicate] = kept;
    return true;
}

static bool measure_point(struct converge *c, struct converge_curve *curve, uint32_t replicate,
                          uint32_t point, struct err *err)
{
    struct arena scratch = {0};
    struct film_image film;
    struct converge_sample *sample = converge_at(c, curve, replicate, point);
    const struct converge_reference *reference = &c->references[curve->variant.scene];
    for (int m = 0; m < CONVERGE_METRICS; m++)
        sample->metric[m] = NAN;
    bool ok = renderer_read(&curve->renderer, &scratch, &film, err);
    if (ok && reference->name)
        compare(reference, &film, replicate == 0, sample->metric);
    else if (ok)
        ok = estimate(&film, c->spp[point], sample->metric, err);
    if (ok && point + 1 == c->point_count)
        ok = keep_picture(c, curve, replicate, &film, err);
    arena_finish(&scratch);
    return ok;
}

// Samplers that spread their points over all samples planned begin anew for each point; the others
// go on from the one before.
static bool plans_samples(const struct settings *settings)
{
    return settings->sampler == SAMPLER_STRATIFIED || settings->sampler == SAMPLER_GRID ||
           settings->sampler == SAMPLER_BLUE_NOISE || settings->halves == HALVES_CONTIGUOUS;
}

static bool measure_replicate(struct converge *c, struct converge_curve *curve, uint32_t replicate,
                              double from, double to, struct err *err)
{
    struct renderer *renderer = &curve->renderer;
    const struct settings *settings = &curve->scene_data.settings;
    double part = (to - from) / (double)c->spp[c->point_count - 1], start = 0.0;
    uint64_t done = 0;
    for (uint32_t point = 0; point < c->point_count && !c->stopped; point++) {
        if (point == 0 || plans_samples(settings)) {
            renderer->frame.samples = (uint32_t)c->spp[point];
            if (!renderer_restart(renderer, settings->seed + replicate, err))
                return false;
            start = renderer->stats.render_seconds;
            done = 0;
        }
        if (!advance(c, renderer, c->spp[point] - done, from + part * (double)done,
                     from + part * (double)c->spp[point], err))
            return false;
        done = c->spp[point];
        converge_at(c, curve, replicate, point)->seconds = renderer->stats.render_seconds - start;
        if (!c->stopped && !measure_point(c, curve, replicate, point, err))
            return false;
    }
    return true;
}

bool converge_measure(struct converge *c, struct err *err)
{
    double all = (double)c->replicate_count * c->curve_count, done = 0;
    for (uint32_t replicate = 0; replicate < c->replicate_count; replicate++) {
        for (uint32_t i = 0; i < c->curve_count; i++, done++)
            if (!measure_replicate(c, &c->curves[i], replicate, done / all, (done + 1) / all, err))
                return false;
        if (c->stopped)
            break;
        c->replicates_done = replicate + 1;
    }
    return true;
}
