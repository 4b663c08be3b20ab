// Running the samplers and filters of check_sampler.comp.
#ifndef LAMPYRIS_TESTS_SAMPLER_FIXTURE_H
#define LAMPYRIS_TESTS_SAMPLER_FIXTURE_H

#include "check/sampler.h"
#include "kernel_fixture.h"

#define SAMPLER_ITEMS (1u << 18) // at a time

struct sampler_setup {
    struct setup setup;
    uint32_t sampler, halves, filter; // methods of the next run
    uint32_t seed, samples;           // samples: planned
    float filter_radius;
    uint32_t pixel_sampling, pixel_strata;
};

// Opens a sampler for a picture of width x height; leaves the test where there is no device.
#define OPEN_SAMPLER(s, width, height)                                                             \
    do {                                                                                           \
        memset((s), 0, sizeof *(s));                                                               \
        scene_start(&(s)->setup.scene, (width), (height));                                         \
        OPEN_SETUP(&(s)->setup, SAMPLER_ITEMS / 4);                                                \
    } while (0)

// Replaces the draws by uniforms or positions; records a failure and returns false if that cannot
// be. At most SAMPLER_ITEMS.
bool sampler_uniforms(struct sampler_setup *s, union draw *draws, uint32_t count);
bool sampler_positions(struct sampler_setup *s, union draw *draws, uint32_t count);
bool sampler_pixel_places(struct sampler_setup *s, union draw *draws, uint32_t count);
void sampler_close(struct sampler_setup *s);

#endif
