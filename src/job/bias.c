#include "job/bias.h"

#include "base/maths.h"
#include "render/focus.h"
#include "render/light_paths.h"
#include "scene/core/light.h"
#include <inttypes.h>
#include <stdio.h>

struct biases {
    struct job_bias *list;
    uint32_t count;
};

static bool follows_paths(const struct settings *settings)
{
    uint32_t integrator = settings_integrator(settings);
    return integrator == INTEGRATOR_PATH || integrator == INTEGRATOR_DIRECT ||
           integrator == INTEGRATOR_BIDIR;
}

static uint32_t depth_asked_for(const struct settings *settings)
{
    return settings->integrator == INTEGRATOR_DIRECT ? 1 : settings->max_bounces;
}

static struct job_bias *next_bias(struct biases *biases, const char *kind)
{
    struct job_bias *bias = &biases->list[biases->count++];
    *bias = (struct job_bias){.kind = kind};
    return bias;
}

// Counts the delta lights that only shadow rays can find.
static uint32_t lights_without_extent(const struct scene *scene)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->light_count; i++)
        count += !scene->lights[i].hidden && !light_is_sun(&scene->lights[i]);
    return count;
}

static void find_unconnected(const struct job *job, struct biases *biases)
{
    const struct settings *settings = &job->scene->settings;
    uint32_t count = lights_without_extent(job->scene);
    uint32_t depth = settings->nee ? settings->nee_depth : 0;
    if (count == 0 || depth >= depth_asked_for(settings))
        return;
    struct job_bias *bias = next_bias(biases, settings->nee ? "nee-depth" : "nee");
    if (depth == 0)
        snprintf(bias->text, sizeof bias->text,
                 "without shadow rays, delta lights have no effect: %u", count);
    else
        snprintf(bias->text, sizeof bias->text,
                 "delta lights (%u) illuminate only the first surfaces of a path: %u", count,
                 depth);
}

static bool can_have_light_paths(const struct job *job)
{
    const struct renderer *r = &job->renderer;
    return light_paths_support(
        &(struct light_paths_params){.scene = job->scene,
                                     .flat = &r->flat,
                                     .camera = &r->camera,
                                     .aovs = r->aovs,
                                     .tiles = r->specialization.features & FEATURE_TILES,
                                     .has_window = r->window.width > 0},
        NULL);
}

// Only shadow rays and light paths find delta lights. Perfectly specular surfaces block shadow
// rays, so the caustics of delta lights are missing without light paths.
static void find_lost_caustics(const struct job *job, struct biases *biases)
{
    if (settings_integrator(&job->scene->settings) != INTEGRATOR_PATH)
        return;
    const struct focus_found found = focus_find(job->scene, &job->renderer.flat);
    if (found.focus != FOCUS_LOST)
        return;
    struct job_bias *bias = next_bias(biases, "integrator");
    snprintf(bias->text, sizeof bias->text,
             "caustics of delta lights (%u) at perfectly specular surfaces are missing: %s",
             found.delta_lights,
             can_have_light_paths(job)
                 ? "--integrator bidir finds them"
                 : "--integrator bidir, which finds them, does not support this render");
}

static double mean_luminance(const struct film_image *film)
{
    double sum = 0.0;
    uint64_t pixels = (uint64_t)film->width * film->height;
    for (uint64_t i = 0; i < pixels; i++)
        sum += luminance(film->mean[i]);
    return sum / (double)pixels;
}

static void find_clamped(const struct job *job, struct biases *biases)
{
    const struct render_stats *stats = &job->renderer.stats;
    if (!(job->scene->settings.clamp_limit > 0.0f) || stats->paths == 0)
        return;
    double lost = stats->clamped_light / (double)stats->paths;
    double all = lost + mean_luminance(&job->film);
    struct job_bias *bias = next_bias(biases, "clamp");
    bias->is_idle = stats->clamped == 0;
    snprintf(bias->text, sizeof bias->text,
             "%" PRIu64
             " contributions were scaled down to %g, which reduces the mean luminance by "
             "%.3g (%.3g %%)",
             stats->clamped, (double)job->scene->settings.clamp_limit, lost,
             all > 0.0 ? 100.0 * lost / all : 0.0);
}

static void find_sparse(const struct job *job, struct biases *biases)
{
    const struct render_stats *stats = &job->renderer.stats;
    float least = job->scene->settings.min_density;
    if (!(least > 0.0f) || stats->paths == 0)
        return;
    struct job_bias *bias = next_bias(biases, "min-density");
    bias->is_idle = stats->sparse == 0;
    snprintf(bias->text, sizeof bias->text,
             "%" PRIu64 " of %" PRIu64 " %s ended where the density of their next direction was "
             "below %g per steradian",
             stats->sparse, stats->paths + stats->branches,
             stats->branches > 0 ? "branches of paths" : "paths", (double)least);
}

static void find_capped(const struct job *job, struct biases *biases)
{
    const struct settings *settings = &job->scene->settings;
    if (settings->roulette != ROULETTE_FRAME ||
        settings->roulette_max_bounces >= depth_asked_for(settings))
        return;
    struct job_bias *bias = next_bias(biases, "roulette-max-bounces");
    snprintf(bias->text, sizeof bias->text,
             "no path has more than %u scattering events, where %u were requested",
             settings->roulette_max_bounces, depth_asked_for(settings));
}

static void find_unphysical(const struct job *job, struct biases *biases)
{
    const struct settings *settings = &job->scene->settings;
    if (settings->integrator == INTEGRATOR_WHITTED) {
        struct job_bias *bias = next_bias(biases, "whitted");
        snprintf(
            bias->text, sizeof bias->text,
            "caustics and light between diffuse surfaces are missing, and emitters are treated as "
            "points");
    }
}

// Refraction is the only event that scales radiance.
static void find_unscaled(const struct job *job, struct biases *biases)
{
    const struct specialization *s = &job->renderer.specialization;
    if (s->radiance_scaling || !(s->features & FEATURE_MEDIA) ||
        !(s->lobes & (LOBE_TRANSMISSION | LOBE_DIELECTRIC)))
        return;
    struct job_bias *bias = next_bias(biases, "radiance-scaling");
    snprintf(
        bias->text, sizeof bias->text,
        "refraction does not scale radiance: inside a medium with the index of refraction n, "
        "radiance is 1 / n^2 of the correct value, and lamps in it appear n^2 times too bright "
        "from outside");
}

// If samples pass through the centre of the pixel or through points of a grid, these are the same
// for all samples and in both half-buffers.
static void find_fixed_places(const struct job *job, struct biases *biases)
{
    const struct settings *settings = &job->scene->settings;
    uint32_t places = !settings_spread_over_pixel(settings) ? 1
                      : settings->pixel_sampling == PIXEL_SAMPLING_GRID
                          ? settings->pixel_strata * settings->pixel_strata
                          : 0;
    if (places == 0)
        return;
    struct job_bias *bias =
        next_bias(biases, settings->pixel_jitter ? "pixel-sampling" : "pixel-jitter");
    snprintf(bias->text, sizeof bias->text,
             places == 1
                 ? "all samples pass through the pixel's centre: edges are not antialiased, and "
                   "the error estimate is for the radiance at this point"
                 : "all samples pass through the same %u points of a pixel: edges have only so "
                   "many steps, and the error estimate is for the mean over these points",
             places);
}

static void find_arithmetic(const struct job *job, struct biases *biases)
{
    const struct settings *settings = &job->scene->settings;
    if (settings->sampler == SAMPLER_SINE) {
        struct job_bias *bias = next_bias(biases, "sampler");
        snprintf(bias->text, sizeof bias->text,
                 "fractions of sines are neither uniform nor independent: means are biased, and "
                 "the error estimated from the halves is wrong");
    }
    if (settings->accumulation != ACCUMULATION_BINNED) {
        struct job_bias *bias = next_bias(biases, "accumulation");
        snprintf(bias->text, sizeof bias->text,
                 "the film's %s drifts from the samples' mean as their number grows "
                 "(docs/sampling.md)",
                 settings->accumulation == ACCUMULATION_SUM ? "plain sum" : "running mean");
    }
}

uint32_t job_list_biases(const struct job *job, struct job_bias list[JOB_MAX_BIASES])
{
    struct biases biases = {.list = list};
    if (follows_paths(&job->scene->settings)) {
        find_unconnected(job, &biases);
        find_lost_caustics(job, &biases);
        find_capped(job, &biases);
        find_sparse(job, &biases);
    }
    find_clamped(job, &biases);
    find_unphysical(job, &biases);
    find_unscaled(job, &biases);
    find_fixed_places(job, &biases);
    find_arithmetic(job, &biases);
    return biases.count;
}

bool job_shares_depths(const struct job *job)
{
    return job->scene->settings.roulette == ROULETTE_FRAME &&
           (job->renderer.specialization.features & FEATURE_ROULETTE);
}
