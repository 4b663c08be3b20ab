// Measures the distribution of single samples of the small image, especially its tail, and reports
// errors.
#include "check/scene/survey.h"

#include "base/maths.h"
#include "render/probe/replay.h"
#include "scene/core/emission.h"
#include "scene/core/light.h"
#include <stdlib.h>
#include <string.h>

// Returns the number of contributions in the renders so far that were not finite.
static uint64_t count_dropped(const struct survey *survey)
{
    uint64_t dropped = 0;
    for (int site = 0; site < SITE_COUNT; site++)
        dropped += survey->job.renderer.stats.nonfinite.count[site];
    return dropped;
}

// --- the tail of the samples ---------------------------------------------------------------------

#define TAIL_SAMPLES 64u // per pixel, each rendered separately

// A sample minus the mean of its pixel, relative to the mean of the image.
struct outlier {
    double excess;
    uint32_t pixel, sample;
};

static bool take_samples(struct survey *survey, float *samples, struct err *err)
{
    struct job *job = &survey->job;
    if (!job_begin(job, survey->settings.seed, 0, err))
        return false;
    for (uint32_t k = 0; k < TAIL_SAMPLES && !job_is_stopped(job); k++) {
        struct arena arena = {0};
        struct film_image film;
        const struct job_step step = {.samples = k + 1u,
                                      .from = (double)k / TAIL_SAMPLES,
                                      .to = (double)(k + 1) / TAIL_SAMPLES};
        bool ok = (k == 0 || job_clear(job, err)) && job_advance(job, &step, err) &&
                  job_copy_film(job, &arena, &film, err);
        for (uint32_t i = 0; ok && i < survey->line_count; i++)
            samples[(size_t)i * TAIL_SAMPLES + k] = (float)luminance(film.mean[i]);
        arena_finish(&arena);
        if (!ok)
            return false;
    }
    return true;
}

static int descending(const void *a, const void *b)
{
    double x = ((const struct outlier *)a)->excess, y = ((const struct outlier *)b)->excess;
    return (x < y) - (x > y);
}

// Lists the brightest samples. Samples of the edge of a visible emitter are bright but not rare, so
// pixels that are flagged in `in_view` (unless it is NULL) are left out.
static bool list_outliers(struct survey *survey, const float *samples, const uint8_t *in_view,
                          struct outlier **out, struct err *err)
{
    uint32_t pixels = survey->line_count;
    size_t count = (size_t)pixels * TAIL_SAMPLES;
    double all = 0.0;
    *out = ARENA_NEW(&survey->scratch, struct outlier, count);
    if (!*out)
        return err_memory(err, "samples", count * sizeof **out);
    for (size_t i = 0; i < count; i++)
        all += (double)samples[i];
    all /= (double)count;
    if (!(all > 0.0))
        all = 1.0;
    for (uint32_t i = 0; i < pixels; i++) {
        const float *own = &samples[(size_t)i * TAIL_SAMPLES];
        double mean = 0.0;
        for (uint32_t k = 0; k < TAIL_SAMPLES; k++)
            mean += (double)own[k] / TAIL_SAMPLES;
        for (uint32_t k = 0; k < TAIL_SAMPLES; k++)
            (*out)[(size_t)i * TAIL_SAMPLES + k] =
                (struct outlier){in_view && in_view[i] ? 0.0 : ((double)own[k] - mean) / all, i, k};
    }
    qsort(*out, count, sizeof **out, descending);
    return true;
}

// The number of samples in the tail. The largest samples are described by a power law, P(x) ~
// x^-index; Hill's estimator (1975) gives the exponent, with the standard error index /
// sqrt(TAIL_LENGTH). If the exponent is below 2, the variance is infinite, or appears so within
// these samples, and the error decreases more slowly than 1 / samples. If samples have an upper
// bound, the very brightest ones are more similar than the power law predicts.
#define TAIL_LENGTH 100u
#define TAIL_END 20u

struct tail {
    double index;
    double end_index; // exponent of the TAIL_END brightest samples alone
    double part;      // share of the tail in the sum of squares of all samples
};

// Returns whether the variance may be finite. This requires an exponent of at least 2, so the upper
// end of its 95 % interval must be at least 2. `index` is the exponent estimated from `count`
// samples.
static bool may_be_finite(double index, uint32_t count)
{
    return index * (1.0 + 1.96 / sqrt(count)) >= 2.0;
}

static double hill_index(const struct outlier *outliers, uint32_t count)
{
    double logs = 0.0;
    for (uint32_t i = 0; i < count; i++)
        logs += log(outliers[i].excess / outliers[count].excess);
    return count / logs;
}

static struct tail find_tail(const struct outlier *outliers, size_t count)
{
    double squares = 0.0, most = 0.0;
    for (size_t i = 0; i < count; i++) {
        double square = outliers[i].excess * outliers[i].excess;
        squares += square;
        most += i < TAIL_LENGTH ? square : 0.0;
    }
    return (struct tail){hill_index(outliers, TAIL_LENGTH), hill_index(outliers, TAIL_END),
                         most / squares};
}

// Returns whether no contribution can exceed the emitted radiance. This holds for paths that hit
// lamps, and for shadow rays with multiple importance sampling. It does not hold for delta lights,
// which may be arbitrarily close to a surface.
static bool has_bound(const struct survey *survey)
{
    const struct scene *scene = survey->scene;
    const struct settings *settings = &survey->settings;
    for (uint32_t i = 0; i < scene->light_count; i++)
        if (!scene->lights[i].hidden && !light_is_sun(&scene->lights[i]))
            return false;
    return !settings->nee || settings->mis != MIS_NONE;
}

// Returns the greatest luminance that surfaces and a constant environment emit; INFINITY if an
// image or a sun lights the scene.
static double brightest_emitted(const struct scene *scene)
{
    const struct environment *environment = &scene->environment;
    double most = environment->present ? luminance(environment->radiance) : 0.0;
    if (environment->texels || scene->light_count > 0)
        return INFINITY;
    for (uint32_t i = 0; i < scene->material_count; i++) {
        float emitted[3];
        greatest_radiance(scene, &scene->materials[i], emitted);
        most = fmax(most, luminance(emitted));
    }
    return most;
}

// The brightest samples have reached the bound if one is at least this share of the radiance of the
// brightest lamp: two diffuse reflections with albedo 1/2 leave a quarter.
#define BOUND_MET 0.25

// Returns whether the brightest samples have reached an upper bound: either they are similar,
// judged by the lower end of their exponent's interval, or one is close to the radiance of the
// brightest lamp.
static bool has_met_bound(const struct survey *survey, const struct outlier *first,
                          const struct tail *tail)
{
    double mean =
        survey_mean_light(survey, survey->job.film.mean); // uses the mean of the outlook's film
    return tail->end_index * (1.0 - 1.96 / sqrt(TAIL_END)) >= 2.0 ||
           (has_bound(survey) &&
            first->excess * mean >= BOUND_MET * brightest_emitted(survey->scene));
}

// Describes the consequence of a tail that has not reached a bound.
static const char *tail_consequence(const struct survey *survey)
{
    return has_bound(survey)
               ? "The exponent is below 2, and no sample has reached the upper bound, the "
                 "radiance of the lamps. Until many samples have reached it, the error decreases "
                 "more slowly than 1 / samples, and its interval may be too small."
               : "The exponent is below 2, and no upper bound is reached or known: with as many "
                 "samples as these the error decreases more slowly than 1 / samples, and longer "
                 "renders find brighter samples.";
}

// Returns the vertex of a path with the greatest contribution. *by_shadow_ray receives true if this
// is the contribution of shadow rays, and false if it is the vertex's own emission.
static uint32_t brightest_vertex(const struct replay *replay, bool *by_shadow_ray)
{
    uint32_t brightest = 0;
    double most = -1.0;
    for (uint32_t i = 0; i < replay->vertex_count; i++) {
        const struct replay_vertex *v = &replay->vertices[i];
        double own = luminance(v->gained);
        double sent = 0.0;
        for (uint32_t k = 0; k < v->light_count; k++)
            sent += v->lights[k].occluded ? 0.0 : luminance(v->lights[k].radiance);
        if (fmax(own, sent) <= most)
            continue;
        most = fmax(own, sent);
        brightest = i;
        *by_shadow_ray = sent > own;
    }
    return brightest;
}

// Describes the path of the brightest sample, for example "material \"floor\", material \"glass\"
// and a shadow ray".
static const char *describe_path(struct survey *survey, const struct replay *replay)
{
    const struct scene *scene = survey->scene;
    bool by_shadow_ray = false;
    uint32_t last = brightest_vertex(replay, &by_shadow_ray);
    const char *text = "";
    for (uint32_t i = 0; text && i <= last && i < replay->vertex_count; i++) {
        const struct material *material = replay->vertices[i].material;
        const char *name =
            material ? survey_material_name(survey, (uint32_t)(material - scene->materials))
                     : "the environment";
        text = name ? arena_printf(survey->arena, "%s%s%s", text, i > 0 ? ", " : "", name) : NULL;
    }
    return text && by_shadow_ray ? arena_printf(survey->arena, "%s and a shadow ray", text) : text;
}

// Flags the pixels that contain an outlier.
static const uint8_t *touched_by_tail(struct survey *survey, const struct outlier *outliers)
{
    uint8_t *flags = survey_flags(survey);
    for (uint32_t i = 0; flags && i < TAIL_LENGTH; i++)
        flags[outliers[i].pixel] = 1;
    return flags;
}

static bool add_tail(struct survey *survey, const struct outlier *first, const struct tail *tail,
                     struct err *err)
{
    uint32_t width = survey->job.renderer.frame.width, height = survey->job.renderer.frame.height;
    uint32_t x = first->pixel % width, y = first->pixel / width;
    struct replay replay;
    if (!job_replay(&survey->job, x, y, first->sample, &survey->scratch, &replay, err))
        return false;
    const char *path = describe_path(survey, &replay);
    const uint8_t *touched = touched_by_tail(survey, first);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "heavy-tail",
            .level = FINDING_SLOW,
            .place = path ? arena_printf(survey->arena, "paths via %s", path) : NULL,
            .figure = arena_printf(
                survey->arena,
                "%u of %u samples cause %.0f %% of the noise; the brightest has %.3g times the "
                "picture's mean, near pixel (%u, %u); the tail of their distribution has the "
                "exponent %.2f, that of the brightest %u has %.2g",
                TAIL_LENGTH, survey->line_count * TAIL_SAMPLES, 100.0 * tail->part, first->excess,
                x * survey->settings.width / width, y * survey->settings.height / height,
                tail->index, TAIL_END, tail->end_index),
            .consequence = tail_consequence(survey),
            .remedy = "Look for a small lamp that gloss, glass or metal reflects or refracts; make "
                      "it larger, or the surface rougher. --clamp removes the noise but also "
                      "light, which is a bias.",
            .share = survey_share(survey, touched),
            .pixels = touched,
        },
        err);
}

#define TAIL_PART_MIN 0.25

static bool is_black(const struct survey *survey, const float *samples, size_t count)
{
    const struct film_image *film = &survey->job.film; // the film of the outlook
    for (size_t i = 0; i < survey->line_count; i++)
        if (luminance(film->mean[i]) > 0.0)
            return false;
    for (size_t i = 0; i < count; i++)
        if (samples[i] > 0.0f)
            return false;
    return true;
}

// Adds the finding about a black image. If contributions were not finite, find_accidents() reports
// it instead.
static bool add_black(struct survey *survey, struct err *err)
{
    if (count_dropped(survey) > 0)
        return true;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "black",
            .level = FINDING_WRONG,
            .place = "the whole scene",
            .figure = arena_printf(survey->arena, "each of %u samples of %u pixels is black",
                                   TAIL_SAMPLES + OUTLOOK_SAMPLES, survey->line_count),
            .consequence =
                "No light reaches the camera, or paths find it so rarely that no sample has.",
            .remedy = "Look for strengths and intensities of 0, lights inside of or behind opaque "
                      "objects, materials that reflect no light, a camera inside of an object, and "
                      "`nee` set to off.",
            .share = 1.0,
        },
        err);
}

static bool measure_tail(struct survey *survey, const uint8_t *in_view, struct err *err)
{
    size_t count = (size_t)survey->line_count * TAIL_SAMPLES;
    float *samples = ARENA_NEW(&survey->scratch, float, count);
    struct outlier *outliers;
    if (!samples)
        return err_memory(err, "samples", count * sizeof *samples);
    if (!take_samples(survey, samples, err) ||
        !list_outliers(survey, samples, in_view, &outliers, err))
        return false;
    if (is_black(survey, samples, count))
        return add_black(survey, err);
    if (count <= 10 * TAIL_LENGTH || !(outliers[TAIL_LENGTH].excess > 0.0))
        return true;
    const struct tail tail = find_tail(outliers, count);
    // If samples have reached a bound, the error decreases as 1 / samples, and nothing needs to be
    // done.
    return may_be_finite(tail.index, TAIL_LENGTH) || tail.part < TAIL_PART_MIN ||
           has_met_bound(survey, outliers, &tail) || add_tail(survey, outliers, &tail, err);
}

// --- errors --------------------------------------------------------------------------------------

static bool find_accidents(struct survey *survey, struct err *err)
{
    const struct render_stats *stats = &survey->job.renderer.stats;
    uint64_t dropped = count_dropped(survey);
    if (dropped == 0)
        return true;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "not-finite",
            .level = FINDING_WRONG,
            .place = "the whole scene",
            .figure = arena_printf(survey->arena, "%llu contributions of %llu paths",
                                   (unsigned long long)dropped, (unsigned long long)stats->paths),
            .consequence = "They are omitted, so light is missing.",
            .remedy = "Render with --explain, which says how to follow such a path, and look for "
                      "numbers near the limits of single precision.",
            .share = NAN,
        },
        err);
}

bool measure_noise(struct survey *survey, struct err *err)
{
    const uint8_t *in_view;
    return measure_outlook(survey, &in_view, err) && measure_tail(survey, in_view, err) &&
           find_accidents(survey, err);
}
