// Finds the reference that the curves of `lampyris converge` are compared with.
#include "cli/converge/converge.h"

#include "base/log.h"
#include <math.h>
#include <string.h>

// A hundred times the samples of the longest curve, with a seed of its own, by the settings without
// what is varied.
#define REFERENCE_FACTOR 100

// With --times, as many as the fastest curve is expected to reach.
static double longest_samples(const struct converge *c, uint32_t scene)
{
    double most = 1;
    if (c->spp)
        return (double)c->spp[c->point_count - 1];
    for (uint32_t i = 0; i < c->curve_count; i++) {
        const struct converge_curve *curve = &c->curves[i];
        if (curve->variant.scene == scene && curve->speed.seconds > 0)
            most = fmax(most, c->seconds[c->point_count - 1] * (double)curve->speed.samples /
                                  curve->speed.seconds);
    }
    return ceil(most);
}

static bool render(struct converge *c, uint32_t scene, struct err *err)
{
    struct converge_reference *out = &c->references[scene];
    struct converge_curve curve = {.variant = {.options = *c->options, .scene = scene}};
    struct film_image film;
    curve.variant.options.scene.path = c->options->arguments[scene];
    double samples = REFERENCE_FACTOR * longest_samples(c, scene);
    if (samples > SETTINGS_SPP_MAX)
        return err_set(err, ERR_USAGE,
                       "--reference auto takes %d times the samples of a curve, here %.3g a pixel; "
                       "expected at most %u, or --reference FILE",
                       REFERENCE_FACTOR, samples, (unsigned)SETTINGS_SPP_MAX);
    out->spp = (uint64_t)samples;
    bool ok = converge_open(c, &curve, err);
    c->phase = "Reference";
    const struct job_step all = {.samples = out->spp, .to = 1.0};
    ok = ok &&
         job_begin(&curve.job, job_reference_seed(curve.scene_data.settings.seed), out->spp, err) &&
         converge_advance(c, &curve.job, &all, err) &&
         job_copy_film(&curve.job, &c->arena, &film, err);
    if (ok && c->stopped)
        ok = err_set(err, ERR_STOPPED, "stopped while the reference was rendered");
    if (ok) {
        out->picture.image = (struct image){film.width, film.height, film.mean};
        ok = reference_find_means(&out->picture, &c->progress, &c->arena, err);
    }
    if (ok)
        reference_set_noise(&out->picture, (const float(*)[3])film.half_a,
                            (const float(*)[3])film.half_b);
    job_finish(&curve.job);
    scene_finish(&curve.scene_data);
    return ok;
}

static bool read(struct converge *c, uint32_t scene, struct err *err)
{
    struct converge_reference *out = &c->references[scene];
    if (!reference_read(out->name, &c->progress, &c->arena, &out->picture, err))
        return false;
    for (uint32_t i = 0; i < c->curve_count; i++) {
        const struct settings *settings = &c->curves[i].scene_data.settings;
        if (c->curves[i].variant.scene == scene &&
            !reference_check_size(&out->picture, out->name, c->options->arguments[scene],
                                  settings->width, settings->height, err))
            return false;
    }
    if (!out->picture.noise_known)
        log_info("%s: %s: its own noise is not subtracted", out->name, out->picture.reason);
    return true;
}

bool converge_reference(struct converge *c, struct err *err)
{
    const char *name = c->options->reference ? c->options->reference : "auto";
    uint32_t scenes = c->options->argument_count;
    c->references = ARENA_NEW(&c->arena, struct converge_reference, scenes);
    if (!c->references)
        return err_memory(err, "references", scenes * sizeof *c->references);
    for (uint32_t scene = 0; scene < scenes; scene++) {
        if (strcmp(name, "none") == 0)
            continue;
        c->references[scene].name = name;
        if (!(strcmp(name, "auto") == 0 ? render(c, scene, err) : read(c, scene, err)))
            return false;
    }
    return true;
}
