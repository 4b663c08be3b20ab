// Renders or reads the references with which the curves are compared.
#include "cli/converge/converge.h"

#include "base/log.h"
#include <math.h>
#include <string.h>

// The number of samples of a reference, relative to that of the longest curve. A reference has a
// seed of its own and the settings without variations.
#define REFERENCE_FACTOR 100

// Returns the number of samples of the longest curve. With --times it is the number that the
// fastest curve is expected to reach.
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

// The least time of the pilot. Shorter ones measure the speed to some tenths only, which is enough
// to distinguish seconds from hours.
#define PILOT_SECONDS 0.1

static const char *duration(struct arena *arena, double seconds)
{
    if (seconds < 120)
        return arena_printf(arena, "about %.2g s", seconds);
    return seconds < 7200 ? arena_printf(arena, "about %.0f minutes", seconds / 60)
                          : arena_printf(arena, "about %.1f hours", seconds / 3600);
}

// Prints the cost of the reference as soon as a pilot has measured the speed. This note is printed
// by default, because rendering the reference is the longest part of the run.
static bool announce(struct converge *c, uint32_t scene, struct job *job, struct err *err)
{
    const struct converge_reference *reference = &c->references[scene];
    struct job_speed speed;
    if (!job_warm_up(job, PILOT_SECONDS, &speed, err))
        return false;
    if (job->stopped)
        return err_set(err, ERR_STOPPED, "stopped before the reference was rendered");
    const char *time = "not known";
    if (speed.seconds > 0 && speed.samples > 0)
        time = duration(&c->arena, speed.seconds * (double)reference->spp / (double)speed.samples);
    enum log_level level = c->options->log_level;
    if (!c->options->quiet && level == LOG_WARN)
        log_set_level(LOG_INFO);
    log_info("%s: the reference takes %llu samples per pixel, %d times those of the longest curve; "
             "expected time %s. --reference-from FILE uses an existing reference",
             c->options->arguments[scene], (unsigned long long)reference->spp, REFERENCE_FACTOR,
             time ? time : "not known");
    log_set_level(level);
    return true;
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
                       "--reference auto takes %d times the samples of the longest curve, here "
                       "%.3g per pixel; expected at most %u, or --reference-from FILE",
                       REFERENCE_FACTOR, samples, (unsigned)SETTINGS_SPP_MAX);
    out->spp = (uint64_t)samples;
    bool ok = converge_open(c, &curve, err) && announce(c, scene, &curve.job, err);
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
        log_warn("%s: the reference's own noise is not known and is part of the errors: %s",
                 out->name, out->picture.reason);
    return true;
}

bool converge_reference(struct converge *c, struct err *err)
{
    const char *name = c->options->reference ? c->options->reference : "auto";
    // --reference-from names a file even if its name is "auto".
    bool is_file = options_given(c->options, OPTION_REFERENCE_FROM);
    uint32_t scenes = c->options->argument_count;
    c->references = ARENA_NEW(&c->arena, struct converge_reference, scenes);
    if (!c->references)
        return err_memory(err, "references", scenes * sizeof *c->references);
    for (uint32_t scene = 0; scene < scenes; scene++) {
        if (!is_file && strcmp(name, "none") == 0)
            continue;
        c->references[scene].name = name;
        if (!(!is_file && strcmp(name, "auto") == 0 ? render(c, scene, err) : read(c, scene, err)))
            return false;
    }
    return true;
}
