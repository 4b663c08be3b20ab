// The error that a render reports from its half-buffers, against the error that it has: the truth
// is a picture of 64 times the samples and another seed.
#include "metrics.h"
#include "render_fixture.h"

#define SAMPLES 64u
#define SEEDS 20u
// 95 % intervals; with a chance of 0.95 each, fewer than 16 of 20 hold in 0.26 % of all cases.
#define HOLD_MIN 16u

static bool half_error(const struct film_image *film, uint32_t seed, struct half_error *out)
{
    const struct half_error_params params = {
        .half_a = (const float(*)[3])film->half_a,
        .half_b = (const float(*)[3])film->half_b,
        .width = film->width,
        .height = film->height,
        .samples = film->least_samples,
        .seed = seed,
    };
    return metrics_half_error(&params, out);
}

TEST(interval_holds_the_true_error)
{
    const struct scene_override size[] = {
        {"film.width", "48"}, {"film.height", "48"}, {"camera.focal_length_mm", "60"}, {0}};
    const struct render_call many = {.samples = 64 * SAMPLES}, few = {.samples = SAMPLES};
    struct scene scene;
    struct gpu gpu;
    struct renderer r;
    struct arena arena = {0};
    struct film_image reference, film;
    struct half_error own, estimated;
    struct metrics metrics;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_scene("scenes/cornell.json", size, &scene, &err));
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
    REQUIRE_OK(renderer_create(&params, &r, &err) && renderer_restart(&r, SEEDS, &err) &&
               renderer_render(&r, &many, &err) && renderer_read(&r, &arena, &reference, &err));
    REQUIRE(half_error(&reference, 0, &own) && own.known, "%s", own.reason);
    uint32_t holds = 0;
    double sum_true = 0.0, sum_estimated = 0.0;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        REQUIRE_OK(renderer_restart(&r, seed, &err) && renderer_render(&r, &few, &err) &&
                   renderer_read(&r, &arena, &film, &err));
        REQUIRE(half_error(&film, seed, &estimated) && estimated.known, "%s", estimated.reason);
        metrics_compare((const float(*)[3])film.mean, (const float(*)[3])reference.mean,
                        (uint64_t)film.width * film.height, &metrics);
        double truth = metrics.relmse - own.relmse; // the reference has an error too
        holds += estimated.ci_low <= truth && truth <= estimated.ci_high;
        sum_true += truth;
        sum_estimated += estimated.relmse;
        printf("seed %2u: relMSE %.5f, estimated %.5f (%.5f to %.5f)\n", seed, truth,
               estimated.relmse, estimated.ci_low, estimated.ci_high);
    }
    printf("%u of %u intervals hold, estimate / truth on average %.3f\n", holds, SEEDS,
           sum_estimated / sum_true);
    CHECK(holds >= HOLD_MIN, "%u of %u intervals hold", holds, SEEDS);
    arena_finish(&arena);
    renderer_finish(&r);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(interval_holds_the_true_error))
