// Finds light that the limit of bounces cuts off. The same paths, with the same random numbers, are
// rendered with more bounces; the light that this adds is the missing light, so that noise has
// little influence.
#include "check/scene/survey.h"

#include <math.h>

#define DEPTH_STEPS 4u // each step has four times the bounces of the previous one
#define DEPTH_MOST 4096u
// The share of the image's light that may be missing, and the share that the fix aims for.
#define CUT_MAX 0.01
#define CUT_GOAL 0.001

// Renders the small image with a limit of `depth` bounces, and returns the mean luminance of each
// pixel.
static bool render_at(struct survey *survey, uint32_t depth, double **out, struct err *err)
{
    survey->scene->settings.max_bounces = depth;
    return survey_render_again(survey, out, err);
}

struct cut {
    double part;        // fraction of the light that is missing
    double least, most; // this fraction minus and plus two standard errors
};

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
    return (struct cut){missing / all, (missing - 2.0 * error) / all,
                        fmin((missing + 2.0 * error) / all, 1.0)};
}

// --- affected pixels -----------------------------------------------------------------------------

// The data that decide which pixels lack more than CUT_MAX of their light. With few samples most
// pixels may have no light at any depth, so each pixel is decided by the smallest window around it
// that permits a decision.
struct cut_map {
    const struct survey *survey;
    uint32_t width, height;
    const double *shallow, *deep;
    double event; // mean missing light of the pixels that lack some
};

static double mean_event(const double *shallow, const double *deep, uint32_t count)
{
    double lost = 0.0, events = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        lost += deep[i] - shallow[i];
        events += deep[i] > shallow[i];
    }
    return lost / fmax(events, 1.0);
}

// Sums over the pixels of a window that show a surface. Other pixels lack nothing.
struct cut_sums {
    double count;
    double excess;  // sum of the missing light minus CUT_MAX times all light
    double squares; // sum of the squares of the pixels' terms of `excess`
};

static struct cut_sums sum_window(const struct cut_map *map, uint32_t x, uint32_t y, uint32_t reach)
{
    uint32_t left = x - (x < reach ? x : reach), top = y - (y < reach ? y : reach);
    struct cut_sums sums = {0};
    for (uint32_t v = top; v <= y + reach && v < map->height; v++)
        for (uint32_t u = left; u <= x + reach && u < map->width; u++) {
            size_t i = (size_t)v * map->width + u;
            double excess = map->deep[i] - map->shallow[i] - CUT_MAX * map->deep[i];
            if (map->survey->lines[i].count == 0)
                continue;
            sums.count++;
            sums.excess += excess;
            sums.squares += excess * excess;
        }
    return sums;
}

// The number of paths that a window's samples may have been expected to find although they found
// none: with three expected, the probability of none is 5 %.
#define UNSEEN_EVENTS 3.0

// Returns whether the pixels around (x, y) lack more than CUT_MAX of their light, by two standard
// errors. If no window permits a decision, the whole image decides.
static bool lacks_light(const struct cut_map *map, uint32_t x, uint32_t y)
{
    for (uint32_t reach = 1; reach < map->width || reach < map->height; reach *= 2) {
        const struct cut_sums sums = sum_window(map, x, y, reach);
        double spread = sums.squares - sums.excess * sums.excess / sums.count;
        double error = sqrt(fmax(spread, 0.0) * sums.count / fmax(sums.count - 1.0, 1.0));
        if (sums.excess > 2.0 * error)
            return true;
        if (sums.excess + 2.0 * error + UNSEEN_EVENTS * map->event < 0.0)
            return false;
    }
    return true;
}

// Flags the pixels that lack more than CUT_MAX of their light.
static const uint8_t *touched_by_cut(struct survey *survey, const double *shallow,
                                     const double *deep)
{
    uint8_t *flags = survey_flags(survey);
    const struct cut_map map = {
        .survey = survey,
        .width = survey->out->picture.width,
        .height = survey->out->picture.height,
        .shallow = shallow,
        .deep = deep,
        .event = mean_event(shallow, deep, survey->line_count),
    };
    for (uint32_t i = 0; flags && i < survey->line_count; i++)
        flags[i] = survey->lines[i].count > 0 && lacks_light(&map, i % map.width, i / map.width);
    return flags;
}

// --- the finding ---------------------------------------------------------------------------------

// If a greater share is missing, there is hardly any light left for comparison.
#define PART_MAX 0.999

// Returns how much light, in percent of the present light, would be added to an image that lacks
// this share of all light.
static double more_light(double part)
{
    return 100.0 * part / (1.0 - fmin(part, PART_MAX));
}

// Returns the present limit of bounces; the integrator "direct" renders paths of one bounce.
static uint32_t first_depth(const struct survey *survey)
{
    const struct settings *settings = &survey->settings;
    return settings->integrator == INTEGRATOR_DIRECT ? 1 : settings->max_bounces;
}

// Describes how much light is missing.
static const char *missing_light(const struct cut *cut, struct arena *arena)
{
    if (!(cut->most < PART_MAX))
        return "paths with more bounces contribute nearly all of the light";
    return arena_printf(arena, "paths with more bounces add %.3g %% more light (%.3g to %.3g %%)",
                        more_light(cut->part), more_light(cut->least), more_light(cut->most));
}

static bool add_cut(struct survey *survey, const struct cut *cut, const uint8_t *touched,
                    uint32_t enough, struct err *err)
{
    struct arena *arena = survey->arena;
    bool is_direct = survey->settings.integrator == INTEGRATOR_DIRECT;
    uint32_t depth = first_depth(survey);
    // With a limit of 0 or 1 bounce, the settings ask for direct light only.
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
            .figure = missing_light(cut, arena),
            .consequence = "This light is missing in the image.",
            .remedy = depth == 0  ? "None is needed if only the light of visible lamps is wanted."
                      : is_wanted ? "None is needed if only direct light is wanted."
                      : is_known  ? arena_printf(arena,
                                                 "Use --max-bounces %u, beyond which less than "
                                                  "0.1 %% is missing.",
                                                 enough)
                                  : "Enclose less of the scene in surfaces that reflect all light: "
                                    "no number of bounces is enough.",
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
            .figure = "no path is traced: no lamp, colour or material is used",
            .consequence = "The image shows ambient occlusion, not the scene's light.",
            .remedy = "None is needed if ambient occlusion is wanted; else use --integrator path.",
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
    if ((settings_integrator(settings) != INTEGRATOR_PATH &&
         settings_integrator(settings) != INTEGRATOR_DIRECT) ||
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
        // A further step would add less light than this one.
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
