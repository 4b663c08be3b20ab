// Finds settings that omit light.
#include "check/scene/survey.h"

#include "job/bias.h"
#include <string.h>

// Returns whether changing the setting to its default costs only time. Settings that reduce noise
// are kept as they are.
static bool is_harmless(const char *kind)
{
    return strcmp(kind, "nee") == 0 || strcmp(kind, "nee-depth") == 0 ||
           strcmp(kind, "roulette-max-bounces") == 0;
}

static void mend(struct settings *settings, const char *kind)
{
    if (strcmp(kind, "roulette-max-bounces") == 0)
        settings->roulette_max_bounces = UINT32_MAX;
    else
        settings->nee_depth = UINT32_MAX;
    settings->nee |= strcmp(kind, "nee") == 0;
}

static bool add(struct survey *survey, const char *kind, const char *text, double share,
                const uint8_t *touched, struct err *err)
{
    bool can_fix = is_harmless(kind);
    if (can_fix && survey->params->fixes)
        mend(&survey->settings, kind);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "biased-setting",
            .level = FINDING_WRONG,
            .place = arena_printf(survey->arena, "setting %s", kind),
            .figure = text,
            .consequence = "The image keeps this bias, whatever its number of samples.",
            .remedy = "Leave the setting at its default.",
            .share = share,
            .pixels = touched,
            .change = can_fix ? "the setting is at its default" : NULL,
        },
        err);
}

bool find_biases(struct survey *survey, struct err *err)
{
    struct job_bias list[JOB_MAX_BIASES];
    uint32_t count = job_list_biases(&survey->job, list);
    for (uint32_t i = 0; i < count; i++) {
        const char *text = arena_strdup(survey->arena, list[i].text);
        if (strcmp(list[i].kind, "radiance-scaling") == 0)
            survey->unscaled = text;
        else if (strcmp(list[i].kind, "integrator") == 0)
            continue; // the finding light-lost measures how much light this is
        else if (!list[i].is_idle && !add(survey, list[i].kind, text, 1.0, NULL, err))
            return false;
    }
    return true;
}

// Reports the setting radiance_scaling if it changes the image. It has no effect if light leaves
// every medium that it enters.
bool find_unscaled(struct survey *survey, struct err *err)
{
    double *scaled, *unscaled;
    const uint8_t *touched;
    if (!survey->unscaled)
        return true;
    survey->scene->settings.radiance_scaling = true;
    bool ok = survey_render_again(survey, &scaled, err);
    survey->scene->settings.radiance_scaling = false;
    if (!ok || !survey_render_again(survey, &unscaled, err))
        return false;
    double different = survey_difference(survey, scaled, unscaled, &touched);
    return different < DIFFERENCE_MIN || add(survey, "radiance-scaling", survey->unscaled,
                                             survey_share(survey, touched), touched, err);
}
