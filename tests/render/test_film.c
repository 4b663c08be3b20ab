// Tests the film's precision, in one pixel, at numbers of samples for which sums in single
// precision are wrong: the mean must be within 1e-6 of the samples' own mean.
#include "render_fixture.h"

#define ERROR_MAX 1e-6

static void render_one_pixel(const char *path, const struct scene_override *overrides,
                             uint64_t samples, float mean[3], uint32_t *counted)
{
    struct scene scene;
    struct gpu gpu;
    struct arena arena = {0};
    struct film_image film;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_scene(path, overrides, &scene, &err));
    scene.settings.width = scene.settings.height = 1;
    scene.settings.sampler = SAMPLER_PCG; // count_below_edge() computes its random numbers
    scene.settings.max_bounces = 0;       // nothing here reflects, so this saves dispatches
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
    REQUIRE_OK(render_film(&params, samples, &arena, &film, NULL, &err));
    memcpy(mean, film.mean[0], sizeof film.mean[0]);
    *counted = film.samples[0];
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// Equal samples that are not short binary fractions: a plain sum would have an error of 1e-3 to
// 1e-2.
static void check_constant(uint64_t samples)
{
    static const float sky[3] = {0.3f, 7.7f, 1e-3f};
    const struct scene_override overrides[] = {{"emission", "[0.3, 7.7, 1e-3]"}, {0}};
    float mean[3] = {0};
    uint32_t counted = 0;
    render_one_pixel("src/check/scenes/sky.json", overrides, samples, mean, &counted);
    CHECK(counted == samples, "%u samples", counted);
    for (int c = 0; c < 3; c++) {
        double error = fabs(mean[c] / (double)sky[c] - 1.0);
        printf("constant, channel %d: error %.1e\n", c, error);
        CHECK(error <= ERROR_MAX, "%.9g, expected %.9g", mean[c], sky[c]);
    }
}

// The hash of shaders/lib/random.glsl for the place in the pixel: pcg4d of Jarzynski and Olano
// 2020.
static void pcg4d(uint32_t v[4])
{
    for (int i = 0; i < 4; i++)
        v[i] = v[i] * 1664525u + 1013904223u;
    for (int round = 0; round < 2; round++) {
        v[0] += v[1] * v[3];
        v[1] += v[2] * v[0];
        v[2] += v[0] * v[1];
        v[3] += v[1] * v[2];
        for (int i = 0; round == 0 && i < 4; i++)
            v[i] ^= v[i] >> 16;
    }
}

// Counts the samples below the scene's edge, which is 70 % of the way down the pixel, and those so
// near that the rounding of the ray decides.
static void count_below_edge(uint64_t samples, uint64_t *below, uint64_t *unclear)
{
    *below = *unclear = 0;
    for (uint64_t s = 0; s < samples; s++) {
        uint32_t random[4] = {0, (uint32_t)s, 0, 0}; // pixel, sample, dimension, seed
        pcg4d(random);
        double y = (double)(random[1] >> 8) * 0x1p-24;
        *below += y > 0.7;
        *unclear += fabs(y - 0.7) < 1e-6;
    }
}

// Samples that are 0 or a bright value, as at an edge.
static void check_edge(uint64_t samples)
{
    static const float light[3] = {0.1f, 3.3f, 1e4f};
    const struct scene_override overrides[] = {{"emission", "[0.1, 3.3, 1e4]"}, {0}};
    float mean[3] = {0};
    uint32_t counted = 0;
    uint64_t below, unclear;
    render_one_pixel("src/check/scenes/edge.json", overrides, samples, mean, &counted);
    count_below_edge(samples, &below, &unclear);
    double allowed = ERROR_MAX + (double)unclear / (double)below;
    for (int c = 0; c < 3; c++) {
        double error = fabs(mean[c] / ((double)light[c] * (double)below / (double)samples) - 1.0);
        printf("edge, channel %d: error %.1e of at most %.1e\n", c, error, allowed);
        CHECK(error <= allowed, "%.9g", mean[c]);
    }
}

TEST(constant)
{
    check_constant(UINT64_C(1) << 20);
}

TEST(edge)
{
    check_edge(UINT64_C(1) << 20);
}

TEST(constant_long)
{
    check_constant(UINT64_C(1) << 24);
}

TEST(edge_long)
{
    check_edge(UINT64_C(1) << 24);
}

TEST_MAIN(TEST_CASE(constant), TEST_CASE(edge), TEST_CASE(constant_long), TEST_CASE(edge_long))
