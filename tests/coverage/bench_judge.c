// meson test --benchmark judge: measures the cost of estimating the error of a picture, relative to
// rendering it. It is the processor time of all threads; the least of several runs is reported.
#include "base/parallel.h"
#include "metrics/metrics.h"
#include "render/probe/in_view.h"
#include "render_fixture.h"
#include <time.h>

#define ROUNDS 5

static double cpu_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool judge(const struct half_error_params *params, double *least)
{
    *least = INFINITY;
    for (int i = 0; i < ROUNDS; i++) {
        struct half_error told;
        double start = cpu_seconds();
        if (!metrics_half_error(params, &told))
            return false;
        *least = fmin(*least, cpu_seconds() - start);
    }
    return true;
}

// The values do not matter, because none costs more than another.
static float (*make_half(uint64_t pixels, uint32_t seed))[3]
{
    float(*half)[3] = calloc(pixels, sizeof *half);
    for (uint64_t i = 0; half && i < pixels * 3; i++) {
        seed = seed * 1664525u + 1013904223u;
        half[0][i] = (float)seed * 0x1p-32f;
    }
    return half;
}

static void measure_size(uint32_t width, uint32_t height)
{
    uint64_t pixels = (uint64_t)width * height;
    float(*a)[3] = make_half(pixels, 1), (*b)[3] = make_half(pixels, 2);
    const struct half_error_params params = {
        .half_a = (const float(*)[3])a,
        .half_b = (const float(*)[3])b,
        .width = width,
        .height = height,
        .samples = 64,
    };
    double seconds = 0;
    CHECK(a && b && judge(&params, &seconds), "out of memory");
    printf("%u x %u: %.4f s, %.0f ns a pixel\n", width, height, seconds,
           1e9 * seconds / (double)pixels);
    free(a);
    free(b);
}

TEST(sizes)
{
    printf("judging, %u threads:\n", cpu_count());
    measure_size(48, 48);
    measure_size(512, 512);
    measure_size(1920, 1080);
}

// The first samples are not timed, because drivers compile at the first dispatch.
static void measure_share(const char *path, uint32_t side, uint64_t samples)
{
    char length[16];
    snprintf(length, sizeof length, "%u", side);
    const struct scene_override size[] = {{"film.width", length}, {"film.height", length}, {0}};
    struct scene scene;
    struct gpu gpu;
    struct renderer r;
    struct arena arena = {0};
    struct film_image film;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_scene(path, size, &scene, &err));
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
    const struct render_call first = {.samples = 2}, call = {.samples = samples};
    REQUIRE_OK(renderer_create(&params, &r, &err) && renderer_render(&r, &first, &err));
    double start = cpu_seconds();
    REQUIRE_OK(renderer_render(&r, &call, &err));
    double rendering = (cpu_seconds() - start) * 64 / (double)samples, judging = 0;
    struct unseen_light unseen;
    REQUIRE_OK(renderer_read(&r, &arena, &film, &err) &&
               renderer_find_unseen(&r, &arena, &unseen, &err));
    const struct half_error_params halves = {
        .half_a = (const float(*)[3])film.half_a,
        .half_b = (const float(*)[3])film.half_b,
        .width = side,
        .height = side,
        .samples = film.least_samples,
        .unseen = unseen,
    };
    REQUIRE(judge(&halves, &judging), "out of memory");
    printf("%s, %u x %u: 64 samples take %.1f s, judging takes %.4f s: %.2f %%\n", path, side, side,
           rendering, judging, 100 * judging / rendering);
    CHECK(judging <= 0.02 * rendering, "judging takes more than 2 %% of 64 samples");
    arena_finish(&arena);
    renderer_finish(&r);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST(shares)
{
    measure_share("scenes/cornell.json", 512, 4);
    measure_share("tests/coverage/gloss_room.json", 512, 4);
}

TEST_MAIN(TEST_CASE(sizes), TEST_CASE(shares))
