#include "job/film_error.h"

#include "base/maths.h"
#include "render/probe/in_view.h"
#include "render/sampling_plan.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static bool rows_are_all(const struct renderer *r)
{
    return r->rows.first == 0 && r->rows.end == r->frame.height;
}

struct film_error_params film_error_of(const struct renderer *renderer, uint64_t samples)
{
    const struct specialization *s = &renderer->specialization;
    return (struct film_error_params){
        .samples = samples,
        .shares_depths = s->roulette == ROULETTE_FRAME && (s->features & FEATURE_ROULETTE) != 0,
        .is_contiguous = halves_are_contiguous(renderer),
        .planned = renderer->frame.samples,
        .lacks_light = s->integrator == INTEGRATOR_BIDIR && !rows_are_all(renderer),
    };
}

bool film_error_prepare(struct renderer *renderer, uint64_t samples, struct arena *arena,
                        struct film_error_params *out, struct err *err)
{
    *out = film_error_of(renderer, samples);
    return renderer_find_unseen(renderer, arena, &out->unseen, err);
}

struct film_image film_rows_alone(const struct film_image *film)
{
    const uint64_t first = (uint64_t)film->rows.first * film->width;
    struct film_image rows = *film;
    rows.height = film->rows.end - film->rows.first;
    rows.mean += first;
    rows.half_a += first;
    rows.half_b += first;
    rows.samples += first;
    if (rows.aovs.class_count) {
        rows.aovs.class_a += first * rows.aovs.class_count;
        rows.aovs.class_b += first * rows.aovs.class_count;
        rows.aovs.brightest += first;
    }
    return rows;
}

// Sets *out to the unseen light of the film's rows, and *moved to a list that *out uses, which the
// caller must free. Returns false when out of memory.
static bool unseen_of_rows(const struct film_image *film, const struct unseen_light *unseen,
                           struct small_light **moved, struct unseen_light *out)
{
    *out = *unseen;
    *moved = NULL;
    if (out->emitter_in_view)
        out->emitter_in_view += (size_t)film->rows.first * film->width;
    if (film->rows.first == 0 && film->rows.end == film->height)
        return true;
    *moved = malloc((unseen->small_count + 1) * sizeof **moved);
    out->small = *moved;
    out->small_count = 0;
    for (size_t i = 0; *moved && i < unseen->small_count; i++) {
        struct small_light light = unseen->small[i];
        if (light.y < film->rows.first || light.y >= film->rows.end)
            continue;
        light.y -= film->rows.first;
        (*moved)[out->small_count++] = light;
    }
    return *moved != NULL;
}

bool film_error_is_blind(const struct film_image *film)
{
    double all = 0.0, dark = 0.0;
    for (size_t i = 0; i < (size_t)film->width * film->height; i++) {
        double light = luminance(film->mean[i]);
        all += light;
        dark += 29.0 * light * light < METRICS_RELMSE_EPSILON ? light : 0.0;
    }
    return dark > 0.5 * all;
}

struct half_error film_error_none(const char *reason)
{
    return (struct half_error){
        .reason = reason,
        .local_relmse = NAN,
        .ci_low = NAN,
        .ci_high = NAN,
        .at_most = INFINITY,
        .relmse_at_most = INFINITY,
        .mse = NAN,
    };
}

static void take_back(const struct film_error_params *params, struct half_error *error)
{
    const struct half_error told = *error;
    const char *reason = told.reason;
    if (told.bounded && params->is_contiguous && !reason)
        reason = "contiguous halves give only a bound";
    if (told.bounded && params->shares_depths)
        reason = "pixels share their paths' depths";
    if (!reason)
        return;
    *error = film_error_none(reason);
    if (told.bounded && params->shares_depths && !params->is_contiguous) {
        error->local_relmse = told.local_relmse;
        error->mse = told.mse;
    } else if (told.bounded && !params->shares_depths) {
        error->bounded = true;
        error->at_most = told.at_most;
        error->relmse_at_most = told.relmse_at_most;
        error->spread = told.spread;
        error->spread_terms = told.spread_terms;
    }
}

bool film_error(const struct film_image *film, const struct film_error_params *params,
                struct half_error *out, struct err *err)
{
    const struct film_image rows = film_rows_alone(film);
    struct half_error_params halves = {
        .half_a = (const float(*)[3])rows.half_a,
        .half_b = (const float(*)[3])rows.half_b,
        .width = rows.width,
        .height = rows.height,
        .samples = params->samples,
        .counts = film->least_samples < film->most_samples ? rows.samples : NULL,
        .confidence = params->confidence,
    };
    struct small_light *moved;
    if (params->lacks_light) {
        *out = film_error_none("light paths of the other parts bring light to these rows, too");
        return true;
    }
    if (params->is_contiguous && film->least_samples != params->planned) {
        *out = film_error_none(
            "with contiguous halves the error is only known after all planned samples");
        return true;
    }
    bool ok = unseen_of_rows(film, &params->unseen, &moved, &halves.unseen) &&
              metrics_half_error(&halves, out);
    free(moved);
    if (!ok)
        return err_memory(err, "error estimate", (uint64_t)film->width * film->height * 12);
    take_back(params, out);
    return true;
}

bool film_error_is_plain(const struct half_error *error)
{
    return !error->known && isfinite(error->local_relmse);
}

void film_error_words(const struct half_error *error, char out[FILM_ERROR_WORDS])
{
    if (error->known)
        snprintf(out, FILM_ERROR_WORDS, "local relMSE %.3g, 95 %% interval %.3g to %.3g",
                 error->local_relmse, error->ci_low, error->ci_high);
    else if (error->bounded)
        snprintf(out, FILM_ERROR_WORDS, "local relMSE at most %.3g (95 %%)", error->at_most);
    else if (film_error_is_plain(error))
        snprintf(out, FILM_ERROR_WORDS, "local relMSE about %.3g, without interval or bound",
                 error->local_relmse);
    else
        snprintf(out, FILM_ERROR_WORDS, "local relMSE not known");
}
