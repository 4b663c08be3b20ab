#include "scene/core/settings.h"

#include <math.h>
#include <stdio.h>

const char *const integrator_names[] = {
    [INTEGRATOR_PATH] = "path",
    [INTEGRATOR_DIRECT] = "direct",
    [INTEGRATOR_AO] = "ao",
    [INTEGRATOR_WHITTED] = "whitted",
    [INTEGRATOR_BIDIR] = "bidir",
    [INTEGRATOR_AUTO] = "auto",
    NULL,
};

const char *const sampler_names[] = {
    [SAMPLER_SOBOL] = "sobol", [SAMPLER_PCG] = "pcg",
    [SAMPLER_LCG] = "lcg",     [SAMPLER_STRATIFIED] = "stratified",
    [SAMPLER_GRID] = "grid",   [SAMPLER_BLUE_NOISE] = "blue-noise",
    [SAMPLER_SINE] = "sine",   NULL,
};

const char *const accumulation_names[] = {
    [ACCUMULATION_BINNED] = "binned",
    [ACCUMULATION_SUM] = "sum",
    [ACCUMULATION_RUNNING] = "running",
    NULL,
};

const char *const halves_names[] = {
    [HALVES_INDEPENDENT] = "independent",
    [HALVES_CONTIGUOUS] = "contiguous",
    NULL,
};

const char *const filter_names[] = {
    [FILTER_BOX] = "box",
    [FILTER_TENT] = "tent",
    [FILTER_GAUSSIAN] = "gaussian",
    [FILTER_BLACKMAN_HARRIS] = "blackman-harris",
    NULL,
};

const char *const pixel_sampling_names[] = {
    [PIXEL_SAMPLING_SAMPLER] = "sampler",
    [PIXEL_SAMPLING_CENTRE] = "centre",
    [PIXEL_SAMPLING_GRID] = "grid",
    [PIXEL_SAMPLING_RANDOM] = "random",
    [PIXEL_SAMPLING_STRATIFIED] = "stratified",
    NULL,
};

const char *const environment_filter_names[] = {
    [ENVIRONMENT_FILTER_BILINEAR] = "bilinear",
    [ENVIRONMENT_FILTER_NEAREST] = "nearest",
    NULL,
};

const char *const environment_sampling_names[] = {
    [ENVIRONMENT_SAMPLING_LUMINANCE] = "luminance",
    [ENVIRONMENT_SAMPLING_COMPENSATED] = "compensated",
    NULL,
};

const char *const light_choice_names[] = {
    [LIGHT_CHOICE_AUTO] = "auto",   [LIGHT_CHOICE_UNIFORM] = "uniform",
    [LIGHT_CHOICE_POWER] = "power", [LIGHT_CHOICE_ALL] = "all",
    [LIGHT_CHOICE_TREE] = "tree",   NULL,
};

const char *const mis_names[] = {
    [MIS_POWER] = "power",
    [MIS_BALANCE] = "balance",
    [MIS_NONE] = "none",
    NULL,
};

const char *const directions_names[] = {
    [DIRECTIONS_BSDF] = "bsdf",
    [DIRECTIONS_SPHERE] = "sphere",
    [DIRECTIONS_HEMISPHERE] = "hemisphere",
    [DIRECTIONS_COSINE] = "cosine",
    [DIRECTIONS_POWER_COSINE] = "power-cosine",
    NULL,
};

const char *const normals_names[] = {
    [NORMALS_VISIBLE] = "visible",
    [NORMALS_NDF] = "ndf",
    NULL,
};

const char *const camera_names[] = {
    [CAMERA_PERSPECTIVE] = "perspective",
    [CAMERA_ORTHOGRAPHIC] = "orthographic",
    [CAMERA_PANORAMIC] = "panoramic",
    NULL,
};

const char *const roulette_names[] = {
    [ROULETTE_THROUGHPUT] = "throughput",
    [ROULETTE_CONSTANT] = "constant",
    [ROULETTE_FRAME] = "frame",
    [ROULETTE_OFF] = "off",
    NULL,
};

const char *const tone_names[] = {
    [TONE_NONE] = "none",
    [TONE_REINHARD] = "reinhard",
    [TONE_ACES] = "aces",
    [TONE_AGX] = "agx",
    NULL,
};

// --- the table -----------------------------------------------------------------------------------

#define COUNT(least, most) .type = FIELD_COUNT, .min = least, .max = most
#define DEPTH COUNT(0, SETTINGS_BOUNCES_MAX), .word = "off", .word_value = UINT32_MAX
#define REAL(least, most) .type = FIELD_REAL, .min = least, .max = most
#define CHOICE(names) .type = FIELD_CHOICE, .words = names
#define SWITCH .type = FIELD_SWITCH
#define NEEDS(ID, values) .needs = SETTING_##ID, .needs_values = values

#define WITHOUT_PARENTHESES(...) __VA_ARGS__
// clang-format off
#define ROW(ID, is_of_samples, member, key_, option_, group_, help_, field_, ...)                     \
    [SETTING_##ID] = {                                                                             \
        .field = {.key = key_, FIELD_OF(settings, member), WITHOUT_PARENTHESES field_},            \
        .option = option_, .group = group_, .help = help_, .changes_samples = is_of_samples,             \
        __VA_ARGS__                                                                                \
    },
// clang-format on

const struct setting settings_table[SETTING_TOTAL] = {
#define SETTING(ID, type, ...) ROW(ID, true, __VA_ARGS__)
#define SETTING_OF_FILE SETTING
#define SETTING_OF_COUNT(ID, type, ...) ROW(ID, false, __VA_ARGS__)
#define SETTING_OF_IMAGE(ID, type, ...) ROW(ID, false, __VA_ARGS__)
#include "scene/core/settings_list.h"
};

struct settings settings_default(void)
{
    struct settings settings = {0};
    for (int i = 0; i < SETTING_TOTAL; i++)
        field_set(&settings_table[i].field, &settings, settings_table[i].fallback);
    return settings;
}

bool settings_same(const struct settings *a, const struct settings *b)
{
    for (int i = 0; i < SETTING_TOTAL; i++)
        if (!field_same(&settings_table[i].field, a, b))
            return false;
    return true;
}

bool setting_is_in_use(const struct setting *setting, const struct settings *settings,
                       bool has_image)
{
    const struct field *needed = &settings_table[setting->needs].field;
    bool has_value = !setting->needs_values ||
                     (setting->needs_values >> (uint32_t)field_get(needed, settings) & 1u);
    return has_value && (has_image || !setting->needs_image);
}

void setting_range(const struct setting *setting, char out[SETTING_RANGE_MAX])
{
    const struct field *field = &setting->field;
    bool is_number = field->type == FIELD_COUNT || field->type == FIELD_REAL;
    out[0] = '\0';
    if (is_number)
        snprintf(out, SETTING_RANGE_MAX, "From %.15g to %.15g.", field->min, field->max);
}

void setting_default_text(const struct setting *setting, char out[SETTING_RANGE_MAX])
{
    const struct settings settings = settings_default();
    char text[FIELD_TEXT_MAX];
    field_text(&setting->field, &settings, text);
    bool is_special =
        setting->special && (field_is_word(&setting->field, &settings) ||
                             field_get(&setting->field, &settings) == setting->field.min);
    snprintf(out, SETTING_RANGE_MAX, is_special ? "%s (%s)" : "%s", text, setting->special);
}

uint32_t settings_integrator(const struct settings *settings)
{
    return settings->integrator == INTEGRATOR_AUTO ? INTEGRATOR_PATH : settings->integrator;
}

float settings_filter_radius(const struct settings *settings)
{
    static const float own[] = {
        [FILTER_BOX] = 0.5f,
        [FILTER_TENT] = 1.0f,
        [FILTER_GAUSSIAN] = 1.5f,
        [FILTER_BLACKMAN_HARRIS] = 1.5f,
    };
    return settings->filter_radius > 0.0f ? settings->filter_radius : own[settings->filter];
}

bool settings_spread_over_pixel(const struct settings *settings)
{
    return settings->pixel_jitter && settings->pixel_sampling != PIXEL_SAMPLING_CENTRE;
}
