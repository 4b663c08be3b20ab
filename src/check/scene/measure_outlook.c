// Estimates the cost of a render to a given error from a short render of the small image.
#include "check/scene/survey.h"

#include "base/maths.h"
#include <math.h>
#include <string.h>

static const uint8_t *touched_by_small_lights(struct survey *survey,
                                              const struct unseen_light *unseen)
{
    const struct gpu_frame *frame = &survey->job.renderer.frame;
    uint8_t *flags = survey_flags(survey);
    for (size_t i = 0; flags && i < unseen->small_count; i++)
        if (unseen->small[i].x < frame->width && unseen->small[i].y < frame->height)
            flags[unseen->small[i].y * frame->width + unseen->small[i].x] = 1;
    return flags;
}

// The lamps that the camera sees. Adjacent pixels with the same radiance show the same lamp, so a
// pixel at a lamp's edge is not another lamp.
struct small_lamps {
    const struct unseen_light *unseen;
    uint32_t width, height;
    uint32_t *at;   // for each pixel, its index in `unseen` plus 1; 0: none
    uint32_t *open; // a stack of pixels whose neighbours are still to be visited
    bool *known;
    uint32_t count;   // number of lamps
    double least;     // smallest fraction of a pixel that a lamp covers
    double brightest; // luminance of the brightest lamp
};

// Lists the pixels around a pixel, including itself, that see the same lamp.
static uint32_t list_neighbours(const struct small_lamps *lamps, uint32_t index, uint32_t out[9])
{
    const struct small_light *own = &lamps->unseen->small[index];
    uint32_t count = 0;
    for (uint32_t y = own->y > 0 ? own->y - 1 : 0; y <= own->y + 1 && y < lamps->height; y++)
        for (uint32_t x = own->x > 0 ? own->x - 1 : 0; x <= own->x + 1 && x < lamps->width; x++) {
            uint32_t other = lamps->at[(size_t)y * lamps->width + x];
            if (other > 0 && memcmp(lamps->unseen->small[other - 1].radiance, own->radiance,
                                    sizeof own->radiance) == 0)
                out[count++] = other - 1;
        }
    return count;
}

// Visits all pixels that show the same lamp as the first one.
static void look_at_lamp(struct small_lamps *lamps, uint32_t first)
{
    double most = 0.0;
    uint32_t left = 0;
    lamps->open[left++] = first;
    lamps->known[first] = true;
    while (left > 0) {
        uint32_t near[9], count = list_neighbours(lamps, lamps->open[--left], near);
        double part = 0.0;
        for (uint32_t i = 0; i < count; i++) {
            part += (double)lamps->unseen->small[near[i]].part;
            if (!lamps->known[near[i]])
                lamps->open[left++] = near[i];
            lamps->known[near[i]] = true;
        }
        most = fmax(most, part);
    }
    lamps->count++;
    lamps->least = fmin(lamps->least, most);
    lamps->brightest = fmax(lamps->brightest, luminance(lamps->unseen->small[first].radiance));
}

static bool list_small_lamps(struct survey *survey, const struct unseen_light *unseen,
                             struct small_lamps *lamps, struct err *err)
{
    const struct gpu_frame *frame = &survey->job.renderer.frame;
    size_t pixels = (size_t)frame->width * frame->height;
    *lamps = (struct small_lamps){
        .unseen = unseen,
        .width = frame->width,
        .height = frame->height,
        .at = ARENA_NEW(&survey->scratch, uint32_t, pixels),
        .open = ARENA_NEW(&survey->scratch, uint32_t, unseen->small_count),
        .known = ARENA_NEW(&survey->scratch, bool, unseen->small_count),
        .least = INFINITY,
    };
    if (!lamps->at || !lamps->open || !lamps->known)
        return err_memory(err, "lamps in view", pixels * sizeof *lamps->at);
    for (uint32_t i = 0; i < unseen->small_count; i++)
        lamps->at[(size_t)unseen->small[i].y * lamps->width + unseen->small[i].x] = i + 1;
    for (uint32_t i = 0; i < unseen->small_count; i++)
        if (!lamps->known[i])
            look_at_lamp(lamps, i);
    return true;
}

static bool find_small_lights(struct survey *survey, const struct unseen_light *unseen,
                              struct err *err)
{
    struct small_lamps lamps;
    if (unseen->small_count == 0)
        return true;
    if (!list_small_lamps(survey, unseen, &lamps, err))
        return false;
    // The fraction refers to pixels of the small image; those of the full image are smaller.
    double pixels = (double)survey->settings.width * survey->settings.height / survey->line_count;
    double part = lamps.least * pixels;
    if (part >= 1.0 / 16.0)
        return true;
    const uint8_t *touched = touched_by_small_lights(survey, unseen);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "tiny-lights",
            .level = FINDING_SLOW,
            .place = "lamps that the camera sees",
            .figure = arena_printf(survey->arena,
                                   "%u lamps, the smallest of which covers %.2g of a pixel; the "
                                   "greatest radiance is %.3g",
                                   lamps.count, part, lamps.brightest),
            .consequence = "Samples hit them by chance: isolated bright pixels appear late.",
            .remedy = "Make the lamps larger, or hide them from the camera and add a point light.",
            .share = (double)unseen->small_count / survey->line_count,
            .pixels = touched,
        },
        err);
}

double outlook_samples(const struct survey *survey, const struct half_error *error)
{
    double value = error->known ? error->local_relmse : error->at_most;
    return error->known || error->bounded
               ? fmax(OUTLOOK_SAMPLES * value / survey->out->outlook.error, 1.0)
               : NAN;
}

bool outlook_render(struct survey *survey, struct job *job, struct job_estimate *out,
                    double *seconds, struct err *err)
{
    const struct job_step step = {.samples = OUTLOOK_SAMPLES, .to = 1};
    *out = (struct job_estimate){0};
    if (!job_begin(job, survey->settings.seed, OUTLOOK_SAMPLES, err) ||
        !job_advance(job, &step, err))
        return false;
    *seconds = job_elapsed(job);
    return job_estimate_begin(job, out, err) && job_estimate_end(out, err);
}

static void look_ahead(struct survey *survey, const struct half_error *error, double seconds)
{
    struct scene_outlook *outlook = &survey->out->outlook;
    double pixels = (double)survey->settings.width * survey->settings.height;
    outlook->samples = outlook_samples(survey, error);
    outlook->seconds =
        seconds * pixels / ((double)survey->line_count * OUTLOOK_SAMPLES) * outlook->samples;
    outlook->reason = error->known ? NULL : error->reason;
}

// --- images too dark for the error measure -------------------------------------------------------

// Local relMSE is relative to L^2 + METRICS_RELMSE_EPSILON. If an image is far darker than the
// square root of that constant, the constant dominates, and noise that is visible is hardly
// counted. The image is reported if with a mean of 1 it would need at least this many times as many
// samples.
#define DIM_MIN 30.0

static float (*scale_pixels(struct arena *arena, float (*pixels)[3], size_t count, double scale))[3]
{
    float(*scaled)[3] = arena_copy(arena, pixels, count, sizeof *pixels);
    for (size_t i = 0; scaled && i < count; i++)
        for (int c = 0; c < 3; c++)
            scaled[i][c] = (float)((double)scaled[i][c] * scale);
    return scaled;
}

// Estimates the samples to the desired error if the image were brighter by the factor `scale`.
static bool look_ahead_scaled(struct survey *survey, const struct job_estimate *estimate,
                              double scale, double *samples, struct err *err)
{
    struct film_image film = estimate->film;
    struct film_error_params params = estimate->params;
    struct half_error error;
    size_t small_count = params.unseen.small_count;
    struct small_light *small =
        arena_copy(&survey->scratch, params.unseen.small, small_count, sizeof *small);
    film.half_a = scale_pixels(&survey->scratch, film.half_a, survey->line_count, scale);
    film.half_b = scale_pixels(&survey->scratch, film.half_b, survey->line_count, scale);
    if (!film.half_a || !film.half_b || !small)
        return err_memory(err, "a picture", survey->line_count * sizeof *film.half_a);
    for (size_t i = 0; i < small_count; i++)
        for (int c = 0; c < 3; c++)
            small[i].radiance[c] = (float)((double)small[i].radiance[c] * scale);
    params.unseen.small = small;
    params.unseen.by_chance *= scale;
    if (!film_error(&film, &params, &error, err))
        return false;
    *samples = outlook_samples(survey, &error);
    return true;
}

static bool find_dim(struct survey *survey, const struct job_estimate *estimate, struct err *err)
{
    const struct scene_outlook *outlook = &survey->out->outlook;
    double light = survey_mean_light(survey, estimate->film.mean), samples;
    if (!(light > 0.0) || !film_error_is_blind(&estimate->film))
        return true;
    if (!look_ahead_scaled(survey, estimate, 1.0 / light, &samples, err))
        return false;
    if (!(samples >= DIM_MIN * outlook->samples))
        return true;
    // At a mean of 1 the error is about the square of the relative noise.
    double noise = sqrt(outlook->error * samples / ceil(outlook->samples));
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "dim",
            .level = FINDING_REMARK,
            .place = "the whole picture",
            .figure = arena_printf(survey->arena,
                                   "its mean is %.2g; below %.2g local relMSE relates the noise to "
                                   "a constant, %.2g, and not to the picture",
                                   light, sqrt(METRICS_RELMSE_EPSILON), METRICS_RELMSE_EPSILON),
            .consequence = arena_printf(survey->arena,
                                        "Local relMSE %g permits noise of %.2g %% of the mean. If "
                                        "the mean were 1, it would take about %.0f spp.",
                                        outlook->error, 100.0 * noise, ceil(samples)),
            .remedy =
                arena_printf(survey->arena,
                             "Make all lights %.2g times as bright and compensate by --exposure "
                             "%+.0f, or set a number of samples instead of an error.",
                             1.0 / light, log2(light)),
            .share = 1.0,
        },
        err);
}

bool measure_outlook(struct survey *survey, const uint8_t **in_view, struct err *err)
{
    struct job_estimate estimate;
    double seconds;
    bool ok = outlook_render(survey, &survey->job, &estimate, &seconds, err) &&
              find_small_lights(survey, &estimate.params.unseen, err);
    const uint8_t *mask = estimate.params.unseen.emitter_in_view;
    if (ok) {
        look_ahead(survey, &estimate.error, seconds);
        ok = find_dim(survey, &estimate, err);
    }
    *in_view = ok && mask ? arena_copy(&survey->scratch, mask, survey->line_count, 1) : NULL;
    arena_finish(&estimate.arena);
    return ok && job_fetch_film(&survey->job, err);
}
