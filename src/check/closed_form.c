#include "check/closed_form.h"

#include "base/hash.h"
#include "check/embedded_scene.h"
#include "check/replicates.h"
#include "check/scaled_scene.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// The greatest permitted bias, in units of the half-width of the confidence interval.
#define BIAS_PER_HALF_WIDTH 3.0
// Returns the relative error of single precision for a path of many bounces, which is also the
// permitted error of forms without variance. It is doubled if the device is not known to round to
// nearest: then error bounds are twice as wide (docs/verification.md, H16), and rays leave and hit
// a distance field farther from its surface, so that they are shorter by that distance.
static double rounding_max(const struct renderer *renderer)
{
    return renderer->gpu->rounds_to_nearest ? 1e-5 : 2e-5;
}

const double closed_form_albedo[3] = {0.8, 0.5, 0.2}, closed_form_emission[3] = {1, 2, 4};

// Returns value / expected - 1. If the expected value is 0, any other value has an infinite error.
static double relative_error(double value, double expected)
{
    return expected > 0.0 ? value / expected - 1.0 : value == 0.0 ? 0.0 : INFINITY;
}

// Returns the half-width in units of the expected value. If the expected value is 0, any half-width
// above 0 counts as infinite.
static double relative_width(double half_width, double expected)
{
    return expected > 0.0 ? half_width / expected : half_width == 0.0 ? 0.0 : INFINITY;
}

static void keep_worst(struct closed_form_seen *seen, int c, double value)
{
    double bias = relative_error(value, seen->expected[c]);
    if (fabs(bias) >= fabs(seen->bias[c])) {
        seen->bias[c] = bias;
        seen->mean[c] = value;
    }
}

static bool try_pixels(const struct closed_form_trial *trial, struct renderer *renderer,
                       struct closed_form_seen *seen, struct err *err)
{
    struct arena arena = {0};
    struct film_image film;
    // With a power of two, the mean of equal values is exact.
    seen->samples = trial->form->kind == EXACT ? 64 : 1;
    const struct render_call call = {.samples = seen->samples};
    bool ok = renderer_render(renderer, &call, err) && renderer_read(renderer, &arena, &film, err);
    double worst = 0.0;
    for (int c = 0; ok && c < 3; c++) {
        for (size_t i = 0; i < (size_t)film.width * film.height; i++)
            keep_worst(seen, c, (double)film.mean[i][c]);
        worst = fmax(worst, fabs(seen->bias[c]));
    }
    seen->passed = worst <= (trial->form->kind == EXACT ? 0.0 : rounding_max(renderer));
    if (!seen->passed)
        snprintf(seen->why, sizeof seen->why, "the worst pixel is off by %.3e", worst);
    arena_finish(&arena);
    return ok;
}

static void judge_channel(const struct closed_form_trial *trial, double rounding,
                          struct closed_form_seen *seen, int c)
{
    double bias = fabs(seen->bias[c]);
    if (fabs(seen->t[c]) > REPLICATES_T_MAX && bias > rounding)
        snprintf(seen->why, sizeof seen->why,
                 "channel %d: mean %.9g, expected %.9g: t = %.2f, expected at most %.1f", c,
                 seen->mean[c], seen->expected[c], seen->t[c], REPLICATES_T_MAX);
    else if (!(seen->half_width[c] <= trial->half_width_max))
        snprintf(seen->why, sizeof seen->why,
                 "channel %d: half-width %.3g of the value; expected at most %g", c,
                 seen->half_width[c], trial->half_width_max);
    else if (!(bias <= BIAS_PER_HALF_WIDTH * trial->half_width_max))
        snprintf(seen->why, sizeof seen->why, "channel %d: mean %.9g, expected %.9g", c,
                 seen->mean[c], seen->expected[c]);
    else
        return;
    seen->passed = false;
}

static bool try_statistics(const struct closed_form_trial *trial, struct renderer *renderer,
                           struct closed_form_seen *seen, struct err *err)
{
    struct replicates replicates;
    seen->samples = trial->samples;
    if ((seen->samples == 0 && !replicates_pilot(renderer, &MEASURE_MEAN, trial->half_width_max,
                                                 CLOSED_FORM_LONG_SAMPLES, &seen->samples, err)) ||
        !replicates_render(renderer, &MEASURE_MEAN, trial->first_seed, seen->samples, &replicates,
                           err))
        return false;
    seen->passed = true;
    for (int c = 0; c < 3; c++) {
        struct estimate e = replicates_estimate(&replicates, (uint32_t)c);
        seen->mean[c] = e.mean;
        seen->bias[c] = relative_error(e.mean, seen->expected[c]);
        seen->t[c] = (e.mean - seen->expected[c]) / e.standard_error;
        seen->half_width[c] = relative_width(e.half_width, seen->expected[c]);
        judge_channel(trial, rounding_max(renderer), seen, c);
    }
    return true;
}

static bool try_scene(const struct check *check, const struct closed_form_trial *trial,
                      const struct scene *scene, struct closed_form_seen *seen,
                      struct check_result *result, struct err *err)
{
    const struct renderer_params params = {.gpu = check->gpu,
                                           .scene = scene,
                                           .progress = check->progress,
                                           .instancing = trial->form->instancing};
    struct renderer renderer;
    if (!renderer_create(&params, &renderer, err))
        return false;
    bool ok = trial->form->kind == BY_STATISTICS ? try_statistics(trial, &renderer, seen, err)
                                                 : try_pixels(trial, &renderer, seen, err);
    ok = ok && (!result || check_keep_picture(check, &renderer, result, err));
    renderer_finish(&renderer);
    return ok;
}

bool closed_form_try(const struct check *check, const struct closed_form_trial *trial,
                     struct closed_form_seen *seen, struct check_result *result, struct err *err)
{
    const struct closed_form *form = trial->form;
    struct scene scene;
    if (!embedded_scene_load(form->scene, form->overrides, &scene, err))
        return false;
    if (form->prepare && !form->prepare(&scene, form->parameter, err)) {
        scene_finish(&scene);
        return false;
    }
    if (form->scale > 0.0)
        scale_scene(&scene, form->scale);
    set_estimator(&scene.settings, trial->estimator);
    scene.settings.light_choice = trial->light_choice;
    *seen = (struct closed_form_seen){0};
    for (int c = 0; c < 3; c++)
        seen->expected[c] =
            form->radiance(closed_form_albedo[c], closed_form_emission[c], form->parameter);
    bool ok = try_scene(check, trial, &scene, seen, result, err);
    scene_finish(&scene);
    return ok;
}

bool closed_form_run(const struct check *check, const struct check_case *this_case,
                     struct check_result *result, struct err *err)
{
    const struct closed_form_trial trial = {
        .form = this_case->data,
        .first_seed = (uint32_t)hash_bytes(HASH_INIT, this_case->name, strlen(this_case->name)),
        .half_width_max = check->longer ? CLOSED_FORM_HALF_WIDTH : 2.0 * CLOSED_FORM_HALF_WIDTH,
    };
    struct closed_form_seen seen;
    if (!closed_form_try(check, &trial, &seen, result, err))
        return false;
    const double *e = seen.expected, *m = seen.mean;
    snprintf(result->expected, sizeof result->expected, "%.6g %.6g %.6g", e[0], e[1], e[2]);
    snprintf(result->why, sizeof result->why, "%s", seen.why);
    return check_seen(result, seen.passed, "%.6g %.6g %.6g", m[0], m[1], m[2]);
}
