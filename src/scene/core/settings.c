#include "scene/core/settings.h"

#include <math.h>
#include <stddef.h>

const char *const integrator_names[] = {
    [INTEGRATOR_PATH] = "path",
    [INTEGRATOR_DIRECT] = "direct",
    [INTEGRATOR_AO] = "ao",
    [INTEGRATOR_WHITTED] = "whitted",
    NULL,
};

const char *const sampler_names[] = {
    [SAMPLER_SOBOL] = "sobol",
    [SAMPLER_PCG] = "pcg",
    [SAMPLER_LCG] = "lcg",
    [SAMPLER_STRATIFIED] = "stratified",
    [SAMPLER_GRID] = "grid",
    [SAMPLER_BLUE_NOISE] = "blue-noise",
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

const char *const environment_filter_names[] = {
    [ENVIRONMENT_FILTER_BILINEAR] = "bilinear",
    [ENVIRONMENT_FILTER_NEAREST] = "nearest",
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

struct settings settings_default(void)
{
    return (struct settings){
        .width = 512,
        .height = 512,
        .spp = 64,
        .seed = 0,
        .max_bounces = 9,
        .integrator = INTEGRATOR_PATH,
        .ao_distance = INFINITY,
        .sampler = SAMPLER_SOBOL,
        .halves = HALVES_INDEPENDENT,
        .filter = FILTER_BOX,
        .pixel_jitter = true,
        .environment_filter = ENVIRONMENT_FILTER_BILINEAR,
        .light_choice = LIGHT_CHOICE_AUTO,
        .nee = true,
        .nee_depth = UINT32_MAX,
        .mis = MIS_POWER,
        .directions = DIRECTIONS_BSDF,
        .direction_exponent = 15.0f,
        .roulette = ROULETTE_THROUGHPUT,
        .roulette_min_bounces = 3,
        .roulette_max_bounces = UINT32_MAX,
        .roulette_survival = 0.7f,
        .exposure = 0.0f,
        .tone_curve = TONE_NONE,
    };
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
