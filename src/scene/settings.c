#include "settings.h"

struct settings settings_default(void)
{
    return (struct settings){
        .width = 512,
        .height = 512,
        .spp = 64,
        .seed = 0,
        .max_bounces = 9,
        .roulette_min_bounces = 3,
        .estimator = ESTIMATOR_MIS,
        .filter = FILTER_BOX,
        .pixel_jitter = true,
        .exposure = 0.0f,
        .tone_curve = TONE_NONE,
    };
}
