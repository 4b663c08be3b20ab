// Renders the small image with other settings or without some objects, and compares the results.
#include "check/scene/survey.h"

#include "base/maths.h"

// A pixel is affected if it differs by more than this share of its light.
#define TOUCHED_MIN 0.01

static bool render_with(struct survey *survey, const struct job_params *params, double **out,
                        struct err *err)
{
    struct job job;
    struct arena arena = {0};
    struct film_image film;
    *out = ARENA_NEW(&survey->scratch, double, survey->line_count);
    if (!*out)
        return err_memory(err, "a picture", survey->line_count * sizeof **out);
    if (!job_start(params, &job, err))
        return false;
    bool ok = job_run(&job, err) && job_copy_film(&job, &arena, &film, err);
    for (uint32_t i = 0; ok && i < survey->line_count; i++)
        (*out)[i] = luminance(film.mean[i]);
    arena_finish(&arena);
    job_finish(&job);
    return ok;
}

bool survey_render_again(struct survey *survey, double **luminances, struct err *err)
{
    struct job_params params = survey->small;
    params.goal = (struct job_goal){.samples = AGAIN_SAMPLES};
    return render_with(survey, &params, luminances, err);
}

// Hides the marked objects, or shows them again.
static void hide(const struct survey *survey, const bool *marked, bool hidden)
{
    for (uint32_t i = 0; i < survey_object_count(survey); i++)
        if (marked[i])
            *survey_hidden(survey, i) = hidden;
}

bool survey_render_without(struct survey *survey, const bool *marked, double **luminances,
                           struct err *err)
{
    struct job_params params = survey->small;
    struct geometry geometry;
    const struct geometry_params without = {
        .scene = survey->scene,
        .bvh = params.renderer.bvh,
        .instancing = params.renderer.instancing,
        .progress = params.progress,
        .camera = survey->camera,
    };
    params.goal = (struct job_goal){.samples = AGAIN_SAMPLES};
    params.renderer.geometry = &geometry;
    hide(survey, marked, true);
    bool ok = geometry_create(&without, &geometry, err);
    if (ok) {
        ok = render_with(survey, &params, luminances, err);
        geometry_finish(&geometry);
    }
    hide(survey, marked, false);
    return ok;
}

double survey_difference(struct survey *survey, const double *a, const double *b,
                         const uint8_t **touched)
{
    uint8_t *flags = survey_flags(survey);
    double all = 0.0, different = 0.0;
    for (uint32_t i = 0; flags && i < survey->line_count; i++) {
        double between = fabs(a[i] - b[i]);
        all += fmax(a[i], b[i]);
        different += between;
        flags[i] = between > TOUCHED_MIN * fmax(a[i], b[i]);
    }
    *touched = flags;
    return different > 0.0 ? different / all : 0.0;
}
