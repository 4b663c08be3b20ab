// Everything about a render that is not the scene. Defaults come from settings_default(), the scene
// file overrides them, the command line overrides both.
#ifndef LAMPYRIS_SCENE_SETTINGS_H
#define LAMPYRIS_SCENE_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

enum tone_curve { TONE_NONE, TONE_REINHARD, TONE_ACES, TONE_AGX };
enum pixel_filter { FILTER_BOX };
// Which techniques connect paths to emitters.
enum light_estimator {
    ESTIMATOR_MIS,  // next-event estimation and BSDF sampling, power heuristic (default)
    ESTIMATOR_NEE,  // next-event estimation only, where a light can be sampled
    ESTIMATOR_BSDF, // BSDF sampling only
};

#define SETTINGS_SIZE_MAX (UINT32_C(1) << 24)
#define SETTINGS_PIXELS_MAX (UINT64_C(1) << 31)
#define SETTINGS_SPP_MAX UINT32_MAX
#define SETTINGS_BOUNCES_MAX (UINT32_C(1) << 20)
#define SETTINGS_EXPOSURE_MAX 100 // stops; 2^100 is within single precision

struct settings {
    uint32_t width, height; // pixels, each in [1, 2^24], product at most 2^31
    uint64_t spp;           // samples a pixel, in [1, 2^32 - 1]
    uint32_t seed;          // any
    uint32_t max_bounces;   // scattering events on a path; 0: emission only. At most 2^20.
    uint32_t
        roulette_min_bounces; // Russian roulette starts after this many events; UINT32_MAX: off
    enum light_estimator estimator;
    enum pixel_filter filter;
    bool pixel_jitter;          // false: every sample through the pixel's centre
    float exposure;             // stops, applied to PNG only
    enum tone_curve tone_curve; // PNG only
};

// 512 x 512, 64 spp, seed 0, 9 bounces, roulette after 3, MIS, box, jitter, exposure 0, no curve.
struct settings settings_default(void);

#endif
