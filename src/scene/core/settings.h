// Everything about a render that is not the scene. Defaults come from settings_default(), the scene
// file overrides them, the command line overrides both.
#ifndef LAMPYRIS_SCENE_CORE_SETTINGS_H
#define LAMPYRIS_SCENE_CORE_SETTINGS_H

#include "shared/methods.h"
#include <stdbool.h>
#include <stdint.h>

enum tone_curve { TONE_NONE, TONE_REINHARD, TONE_ACES, TONE_AGX };

#define SETTINGS_SIZE_MAX (UINT32_C(1) << 24)
#define SETTINGS_PIXELS_MAX (UINT64_C(1) << 31)
#define SETTINGS_SPP_MAX UINT32_MAX
#define SETTINGS_BOUNCES_MAX (UINT32_C(1) << 20)
#define SETTINGS_EXPOSURE_MAX 100 // stops; 2^100 is within single precision
#define SETTINGS_FILTER_RADIUS_MAX 16
#define SETTINGS_EXPONENT_MAX 1e6

struct settings {
    uint32_t width, height; // pixels, each in [1, 2^24], product at most 2^31
    uint64_t spp;           // samples a pixel, in [1, 2^32 - 1]
    uint32_t seed;          // any
    uint32_t max_bounces;   // scattering events on a path; 0: emission only. At most 2^20.
    uint32_t integrator;    // INTEGRATOR_*
    float ao_distance; // of INTEGRATOR_AO: how far an occluder may be, metres; > 0, or infinite
    float falloff;     // k of 1 - exp(-k t^3) towards the background, 1/m^3; 0: off. Not physical.

    uint32_t sampler;    // SAMPLER_*
    uint32_t halves;     // HALVES_*
    uint32_t filter;     // FILTER_*
    float filter_radius; // pixels, in (0, 16]; 0: the filter's own
    bool pixel_jitter;   // false: every sample through the pixel's centre

    uint32_t environment_filter; // ENVIRONMENT_FILTER_*

    uint32_t light_choice;    // LIGHT_CHOICE_*
    bool nee;                 // next-event estimation: shadow rays to emitters
    uint32_t nee_depth;       // so many vertices of a path send some; UINT32_MAX: all
    uint32_t mis;             // MIS_*: weights of both ways to find an emitter
    uint32_t directions;      // DIRECTIONS_*
    float direction_exponent; // of DIRECTIONS_POWER_COSINE, in [0, 1e6]
    float clamp_limit; // of a contribution's largest component, W/(sr m^2); 0: off. It biases.

    uint32_t roulette;             // ROULETTE_*
    uint32_t roulette_min_bounces; // starts after this many events; UINT32_MAX: never
    uint32_t
        roulette_max_bounces; // of ROULETTE_FRAME: no depth beyond; UINT32_MAX: any. It biases.
    float roulette_survival;  // of ROULETTE_CONSTANT and ROULETTE_FRAME, in (0, 1]

    float exposure;             // stops, applied to PNG only
    uint32_t exposure_is_auto;  // 1: `exposure` is found from the picture, see image.h; else 0
    enum tone_curve tone_curve; // PNG only
};

// 512 x 512, 64 spp, seed 0, Sobol, 9 bounces, roulette after 3, MIS, box, jitter, exposure 0, no
// curve.
struct settings settings_default(void);
// The one that was set, or the filter's own.
float settings_filter_radius(const struct settings *settings);

// The words for the choices, in the order of their values; each list ends with NULL. Scene files,
// options and reports say the same.
extern const char *const environment_filter_names[];
extern const char *const integrator_names[],
    *const sampler_names[], *const halves_names[], *const filter_names[],
                                                       *const light_choice_names[],
                                                           *const mis_names[],
                                                               *const directions_names[],
                                                                   *const roulette_names[],
                                                                       *const tone_names[];
extern const char *const camera_names[]; // of struct camera.kind

#endif
