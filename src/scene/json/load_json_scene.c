// Sections of a scene file without lists: film, settings.
#include "scene/json/load_json.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const char *const none[] = {NULL};

// --- film and settings ---------------------------------------------------------------------------

static bool read_uint32(const struct json_node *object, const char *key, uint32_t min, uint32_t max,
                        uint32_t *out, struct err *err)
{
    uint64_t value = *out;
    if (!node_read_integer(object, key, min, max, &value, err))
        return false;
    *out = (uint32_t)value;
    return true;
}

bool load_json_film(struct scene *scene, const struct json_node *node, struct err *err)
{
    static const char *const optional[] = {"width", "height", "exposure", "tone", NULL};
    const struct range stops = {-SETTINGS_EXPOSURE_MAX, SETTINGS_EXPOSURE_MAX, false};
    struct settings *settings = &scene->settings;
    static const char *const words[] = {"auto", NULL};
    const struct json_node exposure_node = node_member(node, "exposure");
    const bool is_auto = json_is_string(exposure_node.value);
    double exposure = (double)settings->exposure;
    uint32_t word;
    uint32_t tone = settings->tone_curve;
    if (!node_check_object(node, none, optional, err) ||
        !read_uint32(node, "width", 1, SETTINGS_SIZE_MAX, &settings->width, err) ||
        !read_uint32(node, "height", 1, SETTINGS_SIZE_MAX, &settings->height, err) ||
        !(is_auto ? node_choice(&exposure_node, words, &word, err)
                  : node_read_number(node, "exposure", stops, &exposure, err)) ||
        !node_read_choice(node, "tone", tone_names, &tone, err))
        return false;
    settings->exposure = (float)exposure;
    if (exposure_node.value)
        settings->exposure_is_auto = is_auto;
    scene->has_own_exposure |= exposure_node.value != NULL;
    scene->has_own_tone |= node_member(node, "tone").value != NULL;
    settings->tone_curve = (enum tone_curve)tone;
    if ((uint64_t)settings->width * settings->height > SETTINGS_PIXELS_MAX)
        return node_fail(node, err, "%u x %u pixels; expected at most %llu in all", settings->width,
                         settings->height, (unsigned long long)SETTINGS_PIXELS_MAX);
    return true;
}

// Whether the value at `key` is the word "off"; false with *err set for any other word.
static bool read_off(const struct json_node *settings, const char *key, bool *is_off,
                     struct err *err)
{
    static const char *const words[] = {"off", NULL};
    uint32_t choice;
    *is_off = json_is_string(node_member(settings, key).value);
    return !*is_off || node_read_choice(settings, key, words, &choice, err);
}

// A depth, or "off": UINT32_MAX.
static bool read_depth(const struct json_node *settings, const char *key, uint32_t *out,
                       struct err *err)
{
    bool is_off;
    if (!read_off(settings, key, &is_off, err))
        return false;
    if (!is_off)
        return read_uint32(settings, key, 0, SETTINGS_BOUNCES_MAX, out, err);
    *out = UINT32_MAX;
    return true;
}

static const struct range RANGE_AO = {0, FLT_MAX, true};
static const struct range RANGE_FALLOFF = {0, FLT_MAX, false};
static const struct range RANGE_CLAMP = {0, FLT_MAX, true};
static const struct range RANGE_FILTER_RADIUS = {0, SETTINGS_FILTER_RADIUS_MAX, false};
static const struct range RANGE_EXPONENT = {0, SETTINGS_EXPONENT_MAX, false};
static const struct range RANGE_SURVIVAL = {0.01, 1, false};

static bool read_float(const struct json_node *object, const char *key, struct range range,
                       float *out, struct err *err)
{
    double value = (double)*out;
    if (!node_read_number(object, key, range, &value, err))
        return false;
    *out = (float)value;
    return true;
}

// A number, or "off": a value outside the range.
static bool read_limit(const struct json_node *object, const char *key, struct range range,
                       float off, float *out, struct err *err)
{
    bool is_off;
    if (!read_off(object, key, &is_off, err))
        return false;
    if (!is_off)
        return read_float(object, key, range, out, err);
    *out = off;
    return true;
}

static bool read_choices(const struct json_node *node, struct settings *settings, struct err *err)
{
    return node_read_choice(node, "integrator", integrator_names, &settings->integrator, err) &&
           node_read_choice(node, "sampler", sampler_names, &settings->sampler, err) &&
           node_read_choice(node, "halves", halves_names, &settings->halves, err) &&
           node_read_choice(node, "filter", filter_names, &settings->filter, err) &&
           node_read_choice(node, "environment_filter", environment_filter_names,
                            &settings->environment_filter, err) &&
           node_read_choice(node, "light_choice", light_choice_names, &settings->light_choice,
                            err) &&
           node_read_choice(node, "mis", mis_names, &settings->mis, err) &&
           node_read_choice(node, "directions", directions_names, &settings->directions, err) &&
           node_read_choice(node, "roulette", roulette_names, &settings->roulette, err);
}

static bool read_parameters(const struct json_node *node, struct settings *settings,
                            struct err *err)
{
    return read_limit(node, "ao_distance", RANGE_AO, INFINITY, &settings->ao_distance, err) &&
           read_float(node, "falloff", RANGE_FALLOFF, &settings->falloff, err) &&
           read_float(node, "filter_radius", RANGE_FILTER_RADIUS, &settings->filter_radius, err) &&
           read_depth(node, "nee_depth", &settings->nee_depth, err) &&
           read_float(node, "direction_exponent", RANGE_EXPONENT, &settings->direction_exponent,
                      err) &&
           read_limit(node, "clamp", RANGE_CLAMP, 0, &settings->clamp_limit, err) &&
           read_depth(node, "roulette_max_bounces", &settings->roulette_max_bounces, err) &&
           read_float(node, "roulette_survival", RANGE_SURVIVAL, &settings->roulette_survival, err);
}

bool load_json_settings(struct scene *scene, const struct json_node *node, struct err *err)
{
    static const char *const optional[] = {"spp",
                                           "seed",
                                           "max_bounces",
                                           "integrator",
                                           "ao_distance",
                                           "falloff",
                                           "sampler",
                                           "halves",
                                           "filter",
                                           "filter_radius",
                                           "pixel_jitter",
                                           "environment_filter",
                                           "light_choice",
                                           "nee",
                                           "nee_depth",
                                           "mis",
                                           "directions",
                                           "direction_exponent",
                                           "clamp",
                                           "roulette",
                                           "roulette_min_bounces",
                                           "roulette_max_bounces",
                                           "roulette_survival",
                                           NULL};
    struct settings *settings = &scene->settings;
    return node_check_object(node, none, optional, err) &&
           node_read_integer(node, "spp", 1, SETTINGS_SPP_MAX, &settings->spp, err) &&
           read_uint32(node, "seed", 0, UINT32_MAX, &settings->seed, err) &&
           read_uint32(node, "max_bounces", 0, SETTINGS_BOUNCES_MAX, &settings->max_bounces, err) &&
           read_depth(node, "roulette_min_bounces", &settings->roulette_min_bounces, err) &&
           node_read_boolean(node, "pixel_jitter", &settings->pixel_jitter, err) &&
           node_read_boolean(node, "nee", &settings->nee, err) &&
           read_choices(node, settings, err) && read_parameters(node, settings, err);
}
