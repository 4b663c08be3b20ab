// What light the last bounce cuts off: the same paths with more bounces. All that they bring
// beyond is what is missing, so that noise tells little against it.
#include "check/scene/survey.h"

#include <math.h>

#define DEPTH_STEPS 4u // each has four times the bounces of the one before
#define DEPTH_MOST 4096u
// Of the picture's light: what may be missing, and what may be missing afterwards.
#define CUT_MAX 0.01
#define CUT_GOAL 0.001

// Mean luminances of the small picture's pixels at a depth.
static bool render_at(struct survey *survey, uint32_t depth, double **out, struct err *err)
{
    survey->scene->settings.max_bounces = depth;
    return survey_render_again(survey, out, err);
}

struct cut {
    double part;  // of all light, that is missing
    double least; // the same less two standard errors
};

// Flags the pixels that lack more than CUT_MAX of their light.
static const uint8_t *touched_by_cut(struct survey *survey, const double *shallow,
                                     const double *deep)
{
    uint8_t *flags = survey_flags(survey);
    for (uint32_t i = 0; flags && i < survey->line_count; i++)
        flags[i] = deep[i] - shallow[i] > CUT_MAX * deep[i];
    return flags;
}

static struct cut compare(const double *shallow, const double *deep, uint32_t count)
{
    double all = 0.0, missing = 0.0, squares = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        double lost = deep[i] - shallow[i];
        all += deep[i];
        missing += lost;
        squares += lost * lost;
    }
    double mean = missing / count, variance = fmax(squares / count - mean * mean, 0.0);
    double error = sqrt(variance / count) * count;
    if (!(all > 0.0))
        return (struct cut){0};
    return (struct cut){missing / all, (missing - 2.0 * error) / all};
}

// The integrator "direct" is paths of one bounce.
static uint32_t first_depth(const struct survey *survey)
{
    const struct settings *settings = &survey->settings;
    return settings->integrator == INTEGRATOR_DIRECT ? 1 : settings->max_bounces;
}

static bool add_cut(struct survey *survey, const struct cut *cut, const uint8_t *touched,
                    uint32_t enough, struct err *err)
{
    struct arena *arena = survey->arena;
    bool is_direct = survey->settings.integrator == INTEGRATOR_DIRECT;
    uint32_t depth = first_depth(survey);
    // Direct light alone is asked for.
    bool is_wanted = depth <= 1, is_known = enough > depth && !is_wanted;
    if (survey->params->fixes && is_known)
        survey->settings.max_bounces = enough;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "depth",
            .level = is_wanted ? FINDING_REMARK : FINDING_WRONG,
            .place = is_direct ? "setting integrator, direct"
                               : arena_printf(arena, "setting max_bounces, %u", depth),
            .figure = arena_printf(arena, "paths with more bounces bring %.2g %% more light",
                                   100.0 * cut->part / (1.0 - fmin(cut->part, 0.999))),
            .consequence = "This light is missing in the picture.",
            .remedy = is_wanted ? "Nothing, if direct light is all that is wanted."
                      : is_known
                          ? arena_printf(arena,
                                         "--max-bounces %u, beyond which less than "
                                         "0.1 %% is missing.",
                                         enough)
                          : "Close fewer surfaces that reflect all light: no depth is enough.",
            .share = survey_share(survey, touched),
            .pixels = touched,
            .change = is_known ? arena_printf(arena, "max_bounces is %u", enough) : NULL,
        },
        err);
}

static bool add_occlusion(struct survey *survey, struct err *err)
{
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "depth",
            .level = FINDING_REMARK,
            .place = "setting integrator, ao",
            .figure = "no path is followed: no lamp, colour or material is looked at",
            .consequence = "The picture is how open each place is, not the scene's light.",
            .remedy = "Nothing, if that is wanted; else --integrator path.",
            .share = 1.0,
        },
        err);
}

bool measure_depth(struct survey *survey, struct err *err)
{
    const struct settings *settings = &survey->settings;
    uint32_t depths[DEPTH_STEPS + 1] = {first_depth(survey)}, count = 1;
    double *films[DEPTH_STEPS + 1];
    if (settings->integrator == INTEGRATOR_AO)
        return add_occlusion(survey, err);
    if ((settings->integrator != INTEGRATOR_PATH && settings->integrator != INTEGRATOR_DIRECT) ||
        settings->roulette == ROULETTE_FRAME || depths[0] >= DEPTH_MOST)
        return true;
    if (!render_at(survey, depths[0], &films[0], err))
        return false;
    survey->scene->settings.integrator = INTEGRATOR_PATH;
    struct cut cut = {0};
    for (uint32_t i = 1; i <= DEPTH_STEPS && depths[i - 1] < DEPTH_MOST; i++, count++) {
        depths[i] = 4 * (depths[i - 1] > 1 ? depths[i - 1] : 1);
        if (!render_at(survey, depths[i], &films[i], err))
            return false;
        cut = compare(films[0], films[i], survey->line_count);
        // The next step finds less than this one.
        if (compare(films[i - 1], films[i], survey->line_count).part < CUT_GOAL) {
            count++;
            break;
        }
    }
    if (!(cut.least > CUT_MAX))
        return true;
    uint32_t enough = 0;
    for (uint32_t i = count; i-- > 1;)
        if (compare(films[i], films[count - 1], survey->line_count).part < CUT_GOAL &&
            i < count - 1)
            enough = depths[i];
    const uint8_t *touched = touched_by_cut(survey, films[0], films[count - 1]);
    return add_cut(survey, &cut, touched, enough, err);
}
