// Pictures with few pixels fill waves with several samples per pixel, and keep their bits.
#include "base/hash.h"
#include "render_fixture.h"
#include "shared/aov.h"

#define SAMPLES 4999u // not a sum of few powers of two

struct small_case {
    uint32_t width, height, aovs;
    uint32_t sampler;
};

static bool load_small(const struct small_case *c, struct scene *scene, struct err *err)
{
    if (!load_scene("scenes/cornell.json", NULL, scene, err))
        return false;
    scene->settings.width = c->width;
    scene->settings.height = c->height;
    scene->settings.sampler = c->sampler;
    return true;
}

static uint64_t film_hash(const struct film_image *film)
{
    uint64_t pixels = (uint64_t)film->width * film->height;
    uint64_t hash = hash_bytes(HASH_INIT, film->half_a, pixels * sizeof *film->half_a);
    hash = hash_bytes(hash, film->half_b, pixels * sizeof *film->half_b);
    for (uint64_t i = 0; film->aovs.variance && i < pixels; i++)
        hash = hash_bytes(hash, film->aovs.variance[i], sizeof film->aovs.variance[i]);
    return hash;
}

// With waves of 16 paths a pass has at most 16 samples of one pixel, as for large pictures.
static void check_small(struct gpu *gpu, const struct small_case *c)
{
    static const uint32_t waves[] = {16, 1u << 10, 1u << 16, 1u << 20};
    uint64_t first = 0, pixels = (uint64_t)c->width * c->height;
    for (size_t i = 0; i < sizeof waves / sizeof *waves; i++) {
        struct arena arena = {0};
        struct scene scene = {0};
        struct film_image film;
        struct render_stats stats;
        struct err err = {0};
        REQUIRE_OK(load_small(c, &scene, &err));
        const struct renderer_params params = {.gpu = gpu,
                                               .scene = &scene,
                                               .wave = waves[i],
                                               .workgroup = 16,
                                               .aovs = c->aovs,
                                               .open_ended = true};
        REQUIRE_OK(render_film(&params, SAMPLES, &arena, &film, &stats, &err));
        uint64_t hash = film_hash(&film), full = SAMPLES * pixels / waves[i];
        first = i == 0 ? hash : first;
        CHECK(hash == first, "%u x %u, waves of %u: other bits", c->width, c->height, waves[i]);
        CHECK(film.least_samples == SAMPLES && film.most_samples == SAMPLES);
        // Full passes have at most 2^MAX_SAMPLE_SHIFT samples. At the end there is one for each
        // power of two.
        full = full > SAMPLES >> MAX_SAMPLE_SHIFT ? full : SAMPLES >> MAX_SAMPLE_SHIFT;
        CHECK(stats.waves <= 2 * full + MAX_SAMPLE_SHIFT + 1 || pixels * 16 > waves[i],
              "%u x %u, waves of %u: %llu waves", c->width, c->height, waves[i],
              (unsigned long long)stats.waves);
        arena_finish(&arena);
        scene_finish(&scene);
    }
}

TEST(waves_fill_with_samples)
{
    static const struct small_case cases[] = {
        {1, 1, AOV_END - 1u, SAMPLER_PCG},
        {3, 2, 0, SAMPLER_SOBOL},
    };
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_small(&gpu, &cases[i]);
    gpu_close(&gpu);
}

// --- the first pass ------------------------------------------------------------------------------

struct stop {
    uint32_t waves_left;
};

static bool count_wave(void *context, struct err *err)
{
    (void)err;
    struct stop *stop = context;
    stop->waves_left--;
    return true;
}

static bool wants_stop(void *context)
{
    const struct stop *stop = context;
    return stop->waves_left == 0;
}

TEST(the_first_pass_is_the_shortest)
{
    const struct small_case c = {48, 40, 0, SAMPLER_SOBOL};
    struct stop stop = {.waves_left = 4}; // as many as 48 x 40 samples need
    const struct progress progress = {.should_stop = wants_stop, .context = &stop};
    const struct render_call call = {.samples = 64, .after_wave = count_wave, .context = &stop};
    struct arena arena = {0};
    struct scene scene = {0};
    struct film_image film;
    struct renderer r;
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_small(&c, &scene, &err));
    const struct renderer_params params = {
        .gpu = &gpu, .scene = &scene, .wave = 512, .progress = &progress};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    CHECK(!renderer_has_all_pixels(&r));
    REQUIRE_OK(renderer_render(&r, &call, &err) && renderer_read(&r, &arena, &film, &err));
    CHECK(renderer_has_all_pixels(&r));
    CHECK(film.least_samples == 1 && film.most_samples == 1 && film.unsampled == 0,
          "%llu to %llu samples, %llu pixels without", (unsigned long long)film.least_samples,
          (unsigned long long)film.most_samples, (unsigned long long)film.unsampled);

    stop.waves_left = 1;
    REQUIRE_OK(renderer_restart(&r, 1, &err) && renderer_render(&r, &call, &err) &&
               renderer_read(&r, &arena, &film, &err));
    CHECK(!renderer_has_all_pixels(&r));
    CHECK(film.unsampled == 48 * 40 - 512, "%llu", (unsigned long long)film.unsampled);
    renderer_finish(&r);
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(waves_fill_with_samples), TEST_CASE(the_first_pass_is_the_shortest))
