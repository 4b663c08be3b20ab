// Tests the size of waves, which is chosen by measured speed, here of a simulated device.
#include "render/wave_size.h"

#include "metrics/random.h"
#include "test.h"
#include <math.h>

#define USUAL (1u << 16)

// Nanoseconds per ray: 100 in waves of `best` samples, and `slope` more for each factor of four in
// either direction.
struct device {
    double best, slope, noise;
    uint64_t random;
};

static double ns_a_ray(struct device *d, uint32_t samples)
{
    double steps = fabs(log2((double)samples / d->best)) / 2.0;
    double noise = 1.0 + d->noise * (2.0 * random_uniform(&d->random) - 1.0);
    return 100.0 * pow(d->slope, steps) * noise;
}

// Renders this many samples. Returns the fraction of them in waves of `size`.
static double run(struct device *d, struct wave_size *w, double samples, uint32_t size)
{
    double done = 0.0, in_size = 0.0;
    while (done < samples) {
        uint32_t wave = wave_size_samples(w);
        CHECK(wave > 0 && wave <= w->most, "a wave of %u", wave);
        wave_size_learn(w, wave, 3.0 * wave, ns_a_ray(d, wave) * 3.0 * wave);
        done += wave;
        in_size += wave == size ? wave : 0.0;
    }
    return in_size / done;
}

TEST(the_fastest_size_is_found_and_kept)
{
    for (uint32_t best = WAVE_SIZE_LEAST; best <= WAVE_SIZE_MOST; best *= 4) {
        struct device device = {.best = best, .slope = 1.1, .noise = 0.02};
        struct wave_size w;
        wave_size_begin(&w, true, WAVE_SIZE_MOST);
        CHECK(wave_size_samples(&w) == USUAL, "begins with %u", wave_size_samples(&w));
        run(&device, &w, 0x1p22, best);
        double part = run(&device, &w, 0x1p26, best);
        CHECK(part > 0.95, "best %u: %.3f of the samples in such waves", best, part);
    }
}

TEST(a_device_that_changes_is_followed)
{
    struct device device = {.best = WAVE_SIZE_MOST, .slope = 1.2, .noise = 0.05};
    struct wave_size w;
    wave_size_begin(&w, true, WAVE_SIZE_MOST);
    run(&device, &w, 0x1p26, WAVE_SIZE_MOST);
    device.best = WAVE_SIZE_LEAST; // another program uses its processors
    run(&device, &w, 0x1p26, WAVE_SIZE_LEAST);
    double part = run(&device, &w, 0x1p24, WAVE_SIZE_LEAST);
    CHECK(part > 0.9, "%.3f of the samples in the smallest waves", part);
    CHECK(w.least_used == WAVE_SIZE_LEAST && w.most_used == WAVE_SIZE_MOST, "%u to %u",
          w.least_used, w.most_used);
}

TEST(a_given_size_is_kept)
{
    struct device device = {.best = WAVE_SIZE_MOST, .slope = 2.0};
    struct wave_size w;
    wave_size_begin(&w, false, 1000);
    double part = run(&device, &w, 0x1p22, 1000);
    CHECK(part == 1.0, "%.3f", part);
}

TEST(buffers_for_small_waves_hold_no_larger_ones)
{
    struct device device = {.best = WAVE_SIZE_MOST, .slope = 1.2};
    struct wave_size w;
    wave_size_begin(&w, true, 40000);
    run(&device, &w, 0x1p24, 40000);
    CHECK(w.most_used == 40000, "%u", w.most_used);
}

TEST_MAIN(TEST_CASE(the_fastest_size_is_found_and_kept),
          TEST_CASE(a_device_that_changes_is_followed), TEST_CASE(a_given_size_is_kept),
          TEST_CASE(buffers_for_small_waves_hold_no_larger_ones))
