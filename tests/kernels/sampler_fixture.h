// Runs the samplers and filters of check_sampler.comp.
#ifndef LAMPYRIS_TESTS_SAMPLER_FIXTURE_H
#define LAMPYRIS_TESTS_SAMPLER_FIXTURE_H

#include "check/sampler.h"
#include "kernel_fixture.h"

#define SAMPLER_ITEMS (1u << 18) // greatest number of items in a run

struct sampler_setup {
    struct setup setup;
    uint32_t sampler, halves, filter; // methods of the next run
    uint32_t seed, samples;           // planned number of samples
    float filter_radius;
    uint32_t pixel_sampling, pixel_strata;
};

// Opens a sampler for a picture of width x height. Without a device, the test ends as skipped.
#define OPEN_SAMPLER(s, width, height)                                                             \
    do {                                                                                           \
        memset((s), 0, sizeof *(s));                                                               \
        scene_start(&(s)->setup.scene, (width), (height));                                         \
        OPEN_SETUP(&(s)->setup, SAMPLER_ITEMS / 4);                                                \
    } while (0)

// Replaces at most SAMPLER_ITEMS draws by uniforms or positions. Returns false, and records a
// failure, if the device failed.
bool sampler_uniforms(struct sampler_setup *s, union draw *draws, uint32_t count);
bool sampler_positions(struct sampler_setup *s, union draw *draws, uint32_t count);
bool sampler_pixel_places(struct sampler_setup *s, union draw *draws, uint32_t count);
void sampler_close(struct sampler_setup *s);

#endif
