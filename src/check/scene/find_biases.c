// Settings that leave light out.
#include "check/scene/survey.h"

#include "job/bias.h"
#include <string.h>

// Raising these costs time alone. What was asked for to have less noise stays.
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

bool find_biases(struct survey *survey, struct err *err)
{
    struct job_bias list[JOB_MAX_BIASES];
    uint32_t count = job_list_biases(&survey->job, list);
    for (uint32_t i = 0; i < count; i++) {
        const char *kind = arena_strdup(survey->arena, list[i].kind);
        bool can_fix = is_harmless(list[i].kind);
        if (!kind)
            return err_memory(err, "names", 0);
        if (can_fix && survey->params->fixes)
            mend(&survey->settings, kind);
        if (!survey_add(survey,
                        &(struct scene_finding){
                            .name = "biased-setting",
                            .level = FINDING_WRONG,
                            .place = arena_printf(survey->arena, "setting %s", kind),
                            .figure = arena_strdup(survey->arena, list[i].text),
                            .consequence = "The picture stays wrong by that, however many samples "
                                           "it has.",
                            .remedy = "Leave the setting at its default.",
                            .share = 1.0,
                            .change = can_fix ? "the setting is at its default" : NULL,
                        },
                        err))
            return false;
    }
    return true;
}
