// Tests the denoiser's spatial filter on invented films.
#include "denoise_fixture.h"
#include "shared/aov.h"
#include <float.h>

static const struct camera across = {
    .direction = {0, 0, -1}, .up = {0, 1, 0}, .kind = CAMERA_ORTHOGRAPHIC, .height = 2};

// Returns a random number from -1 to 1 for a half, which depends only on the arguments.
static float random_at(uint32_t x, uint32_t y, uint32_t which)
{
    uint32_t h = x * 0x9e3779b1u ^ y * 0x85ebca6bu ^ which * 0xc2b2ae35u;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return (float)((h ^ h >> 15) >> 8) * 0x1p-23f - 1.0f;
}

static struct made_pixel plain(float light)
{
    return (struct made_pixel){
        .samples = 4,
        .light = {light, light, light},
        .albedo = {0.5f, 0.5f, 0.5f},
        .normal = {0, 0, 1},
        .depth = 4,
        .alpha = 1,
    };
}

struct bench {
    struct gpu gpu;
    struct made_film film;
    struct denoiser denoiser;
    struct denoise_call call;
    struct err err;
};

static bool bench_open(struct bench *b, uint32_t width, uint32_t height)
{
    if (!film_open(&b->gpu, width, height, &b->film, &b->err))
        return false;
    b->call = (struct denoise_call){.renderer = &b->film.renderer, .camera = &across};
    return denoiser_create(&b->gpu, &b->denoiser, &b->err);
}

static bool bench_run(struct bench *b, make_pixel *make, const void *context)
{
    return film_make(&b->film, make, context, &b->err) &&
           film_denoise(&b->film, &b->denoiser, &b->call, &b->err);
}

static void bench_close(struct bench *b)
{
    denoiser_finish(&b->denoiser);
    film_close(&b->film);
    gpu_close(&b->gpu);
    CHECK(b->gpu.validation_messages == 0, "%u validation messages", b->gpu.validation_messages);
}

#define OPEN_BENCH(b, width, height)                                                               \
    struct bench b = {0};                                                                          \
    OPEN_GPU(&b.gpu, .validation = true);                                                          \
    REQUIRE(bench_open(&b, width, height), "%s", b.err.msg)
#define RUN_BENCH(b, make, context) REQUIRE(bench_run(&b, make, context), "%s", b.err.msg)

// --- what must not change ------------------------------------------------------------------------

static struct made_pixel constant_pixel(const void *context, uint32_t x, uint32_t y)
{
    (void)context;
    struct made_pixel p = plain(0.37f);
    p.apart[1] = 0.2f; // a variance, so that neighbours are mixed
    p.normal[0] = x < 20 ? 0.0f : 0.6f;
    p.normal[2] = x < 20 ? 1.0f : 0.8f;
    p.depth = y < 20 ? 4.0f : 7.0f;
    return p;
}

TEST(constant_stays)
{
    OPEN_BENCH(b, 41, 37);
    RUN_BENCH(b, constant_pixel, NULL);
    // The sums of four samples and a quarter of them are exact except for the products.
    struct made_pixel p = constant_pixel(NULL, 0, 0);
    for (uint32_t i = 0; i < 41 * 37; i++)
        for (int c = 0; c < 3; c++) {
            float a = 2 * (p.albedo[c] * (p.light[c] + p.apart[c]));
            float mean = (a + 2 * (p.albedo[c] * (p.light[c] - p.apart[c]))) / 4;
            CHECK(b.film.picture[i][c] == mean, "pixel %u: %.9g, expected %.9g", i,
                  (double)b.film.picture[i][c], (double)mean);
        }
    bench_close(&b);
}

// Whatever the light is, the halves differ only by rounding, so nothing is noise.
static struct made_pixel certain_pixel(const void *context, uint32_t x, uint32_t y)
{
    (void)context;
    struct made_pixel p = plain(1.0f + random_at(x, y, 0));
    for (int c = 0; c < 3; c++) {
        p.albedo[c] = 0.5f + 0.5f * random_at(x, y, 1);
        p.emission[c] = x % 5 == 0 ? 3.0f : 0.0f;
    }
    return p;
}

static uint64_t hash_film(const struct bench *b)
{
    const struct gpu_buffer *film = &b->film.renderer.film[0];
    unsigned char *bytes = malloc(film->bytes);
    uint64_t hash = 1469598103934665603u;
    struct err err = {0};
    if (bytes && gpu_download(b->film.gpu, film, 0, bytes, film->bytes, &err))
        for (uint64_t i = 0; i < film->bytes; i++)
            hash = (hash ^ bytes[i]) * 1099511628211u;
    free(bytes);
    return hash;
}

TEST(what_is_certain_stays_and_the_film_too)
{
    OPEN_BENCH(b, 70, 50);
    REQUIRE(film_make(&b.film, certain_pixel, NULL, &b.err), "%s", b.err.msg);
    uint64_t before = hash_film(&b);
    b.call.temporal = true;
    for (int i = 0; i < 2; i++) {
        REQUIRE(film_denoise(&b.film, &b.denoiser, &b.call, &b.err), "%s", b.err.msg);
        for (uint32_t p = 0; p < 70 * 50; p++) {
            struct made_pixel m = certain_pixel(NULL, p % 70, p / 70);
            for (int c = 0; c < 3; c++) {
                float mean = m.albedo[c] * m.light[c] + m.emission[c];
                // With an emission of 3, the sums have an error of 2^-22, which counts as noise for
                // divisors down to 0.04.
                CHECK(fabsf(b.film.picture[p][c] - mean) <= 64 * FLT_EPSILON * (1 + mean),
                      "pixel %u: %.9g, expected %.9g", p, (double)b.film.picture[p][c],
                      (double)mean);
            }
        }
        REQUIRE(denoiser_keep(&b.denoiser, &b.call, &b.err), "%s", b.err.msg);
    }
    CHECK(hash_film(&b) == before, "the film has other bits");
    bench_close(&b);
}

// --- noise ---------------------------------------------------------------------------------------

// An impulse of colour with constant luminance: no weight is below that of the kernel.
static struct made_pixel impulse_pixel(const void *context, uint32_t x, uint32_t y)
{
    const uint32_t *size = context;
    struct made_pixel p = plain(1.0f);
    bool here = x == size[0] / 2 && y == size[1] / 2;
    p.light[0] += here ? 0.7152f : 0.0f;
    p.light[1] -= here ? 0.2126f : 0.0f;
    p.apart[0] = p.apart[1] = p.apart[2] = 0.5f;
    return p;
}

// Computes the cascade of this many levels of the B3 spline, for distances from -62 to 62.
static void cascade(uint32_t levels, double kernel[125])
{
    static const double spline[] = {0.0625, 0.25, 0.375, 0.25, 0.0625};
    memset(kernel, 0, 125 * sizeof *kernel);
    kernel[62] = 1;
    for (uint32_t level = 0; level < levels; level++) {
        double next[125] = {0};
        for (int i = 0; i < 125; i++)
            for (int k = 0; k < 5 && kernel[i] > 0; k++)
                next[i + (k - 2) * (1 << level)] += kernel[i] * spline[k];
        memcpy(kernel, next, sizeof next);
    }
}

TEST(the_wavelet_is_the_cascade_of_splines)
{
    static const uint32_t size[] = {133, 131};
    OPEN_BENCH(b, 133, 131);
    for (uint32_t levels = 1; levels <= 5; levels++) {
        double kernel[125], squares = 0, expected = 0, worst = 0;
        cascade(levels, kernel);
        b.call.iterations = levels;
        RUN_BENCH(b, impulse_pixel, size);
        for (int y = -62; y <= 62; y++)
            for (int x = -62; x <= 62; x++) {
                uint32_t i = (uint32_t)(131 / 2 + y) * 133 + (uint32_t)(133 / 2 + x);
                double got = ((double)b.film.picture[i][0] / 0.5 - 1.0) / 0.7152;
                double want = kernel[62 + x] * kernel[62 + y];
                worst = fmax(worst, fabs(got - want));
                squares += got * got;
                expected += want * want;
            }
        printf("  %u levels: noise falls to %.5f of its variance, the kernel says %.5f\n", levels,
               squares, expected);
        CHECK(worst < 1e-5, "%u levels: %g beside the kernel", levels, worst);
        CHECK(fabs(squares / expected - 1) < 0.01, "%u levels: %g of the variance, expected %g",
              levels, squares, expected);
    }
    bench_close(&b);
}

// White noise, which the halves show: each half has a mean of two samples.
static struct made_pixel noisy_pixel(const void *context, uint32_t x, uint32_t y)
{
    const float *sigma = context;
    struct made_pixel p = plain(1.0f);
    float a = *sigma * random_at(x, y, 2), b = *sigma * random_at(x, y, 3);
    for (int c = 0; c < 3; c++) {
        p.light[c] += 0.5f * (a + b);
        p.apart[c] = 0.5f * (a - b);
    }
    return p;
}

// Different luminances have less weight, and the variance is uncertain with 25 degrees of freedom,
// so less noise is removed than the kernel could remove.
TEST(white_noise_goes)
{
    static const float sigma = 0.3f;
    OPEN_BENCH(b, 200, 160);
    RUN_BENCH(b, noisy_pixel, &sigma);
    double before = 0, after = 0, mean = 0;
    uint32_t count = 0;
    for (uint32_t y = 20; y < 140; y++)
        for (uint32_t x = 20; x < 180; x++, count++) {
            struct made_pixel p = noisy_pixel(&sigma, x, y);
            double now = (double)b.film.picture[y * 200 + x][1] / 0.5 - 1;
            before += ((double)p.light[1] - 1) * ((double)p.light[1] - 1);
            after += now * now;
            mean += now;
        }
    printf("  white noise: 1/%.0f of its variance is left\n", before / after);
    CHECK(after * 25 < before, "1/%.1f of the variance is left", before / after);
    // The deviation is 0.3 / sqrt(6) per pixel, over 19200 pixels: 0.0009.
    CHECK(fabs(mean / count) < 4 * 0.0009, "the mean moved by %g", mean / count);
    bench_close(&b);
}

// --- edges ---------------------------------------------------------------------------------------

enum edge { EDGE_NORMAL, EDGE_DEPTH, EDGE_ALBEDO, EDGE_LUMINANCE, EDGES };
static const char *const edge_names[] = {"normal", "depth", "albedo", "luminance"};

struct edge_film {
    enum edge edge;
    float sigma;
};

static struct made_pixel edge_pixel(const void *context, uint32_t x, uint32_t y)
{
    const struct edge_film *film = context;
    struct made_pixel p = noisy_pixel(&film->sigma, x, y);
    bool right = x >= 60;
    // A step of a texture does not change the light; other edges are steps of the light.
    for (int c = 0; c < 3; c++) {
        p.albedo[c] = film->edge == EDGE_ALBEDO && right ? 0.4f : 0.5f;
        p.light[c] += film->edge != EDGE_ALBEDO && right ? -0.8f : 0.0f;
    }
    p.normal[0] = film->edge == EDGE_NORMAL && right ? 1.0f : 0.0f;
    p.normal[2] = film->edge == EDGE_NORMAL && right ? 0.0f : 1.0f;
    p.depth = film->edge == EDGE_DEPTH && right ? 4.2f : 4.0f;
    return p;
}

// The mean error of a column as a fraction of the edge's height, and the fraction of its noise's
// variance that remains.
struct column {
    double offset, noise;
};

static struct column judge_column(const struct bench *b, const struct edge_film *film, uint32_t x)
{
    double dark = film->edge == EDGE_ALBEDO ? 0.4 : 0.1, truth = x < 60 ? 0.5 : dark;
    double sum = 0, before = 0, after = 0;
    for (uint32_t y = 0; y < 200; y++) {
        struct made_pixel p = edge_pixel(film, x, y);
        double was = (double)p.albedo[0] * (double)p.light[0] - truth;
        double now = (double)b->film.picture[y * 120 + x][0] - truth;
        sum += now;
        before += was * was;
        after += now * now;
    }
    return (struct column){fabs(sum / 200) / (0.5 - dark), after / before};
}

TEST(edges_stay_sharp)
{
    OPEN_BENCH(b, 120, 200);
    for (int e = 0; e < EDGES; e++) {
        // If only the light shows an edge, the edge must exceed the noise.
        const struct edge_film film = {(enum edge)e, e == EDGE_LUMINANCE ? 0.1f : 0.3f};
        RUN_BENCH(b, edge_pixel, &film);
        struct column worst = {0};
        for (uint32_t x = 56; x < 64; x++) {
            struct column column = judge_column(&b, &film, x);
            worst.offset = fmax(worst.offset, column.offset);
            worst.noise = fmax(worst.noise, column.noise);
        }
        printf("  %s: columns beside the edge are off by %.2f %% of its height at most, %.3f of "
               "their noise is left\n",
               edge_names[e], 100 * worst.offset, worst.noise);
        double most = e == EDGE_ALBEDO ? 0.08 : 0.03;
        CHECK(worst.offset < most, "%s: off by %g of the edge", edge_names[e], worst.offset);
        CHECK(worst.noise < 0.25, "%s: %g of the noise is left", edge_names[e], worst.noise);
    }
    bench_close(&b);
}

// --- what is not there, or extreme ---------------------------------------------------------------

static struct made_pixel wild_pixel(const void *context, uint32_t x, uint32_t y)
{
    (void)context;
    struct made_pixel p = noisy_pixel(&(float){0.3f}, x, y);
    uint32_t kind = (uint32_t)((1.0f + random_at(x, y, 4)) * 8.0f);
    for (int c = 0; c < 3; c++) {
        if (kind == 0)
            p.samples = 0;
        if (kind == 1)
            p.normal[c] = p.alpha = 0; // no surface
        if (kind == 2)
            p.albedo[c] = p.light[c] = p.apart[c] = 0;
        if (kind == 3)
            p.light[c] = p.apart[c] = 1e30f;
        if (kind == 4)
            p.emission[c] = 1e30f;
        if (kind == 5)
            p.light[c] = p.apart[c] = 1e-38f;
        if (kind == 6)
            p.normal[c] = 0; // the normals of several samples cancel
    }
    p.depth = kind == 7 ? 1e-18f : kind == 8 ? 1e18f : p.depth;
    p.samples = kind == 9 ? 1 : kind == 10 ? 1u << 24 : p.samples;
    return p;
}

static void check_wild(const struct bench *b)
{
    for (uint32_t i = 0; i < b->film.width * b->film.height; i++) {
        const float *pixel = b->film.picture[i];
        uint32_t samples = wild_pixel(NULL, i % b->film.width, i / b->film.width).samples;
        bool finite = isfinite(pixel[0]) && isfinite(pixel[1]) && isfinite(pixel[2]);
        bool black = pixel[0] == 0 && pixel[1] == 0 && pixel[2] == 0;
        CHECK(finite && (samples > 0 || black), "pixel %u of %u samples: %g %g %g", i, samples,
              (double)pixel[0], (double)pixel[1], (double)pixel[2]);
        CHECK(pixel[3] == (float)samples, "pixel %u: %g samples, expected %u", i, (double)pixel[3],
              samples);
    }
}

TEST(nothing_becomes_infinite)
{
    OPEN_BENCH(b, 90, 80);
    struct camera camera = across;
    camera.fov_y = 0.8;
    b.call.camera = &camera;
    b.call.temporal = true;
    for (uint32_t kind = 0; kind < 3; kind++) {
        camera.kind = kind;
        for (int i = 0; i < 2; i++) {
            RUN_BENCH(b, wild_pixel, NULL);
            check_wild(&b);
            REQUIRE(denoiser_keep(&b.denoiser, &b.call, &b.err), "%s", b.err.msg);
        }
    }
    bench_close(&b);
}

static struct made_pixel empty_beside(const void *context, uint32_t x, uint32_t y)
{
    const bool *holes = context;
    struct made_pixel p = noisy_pixel(&(float){0.3f}, x, y);
    if (x >= 32)
        p = *holes ? (struct made_pixel){0} : p;
    p.normal[2] = x >= 32 ? -1.0f : 1.0f;
    return p;
}

// Pixels without samples contribute nothing: their neighbours are filtered as if another surface
// were there.
TEST(empty_pixels_give_nothing)
{
    OPEN_BENCH(b, 64, 32);
    float kept[64 * 32][4];
    RUN_BENCH(b, empty_beside, &(bool){false});
    memcpy(kept, b.film.picture, sizeof kept);
    RUN_BENCH(b, empty_beside, &(bool){true});
    uint32_t differing = 0;
    // The weights of the last pass reach 2 pixels, and the Gaussian of the variance 1 pixel for
    // each level.
    for (uint32_t i = 0; i < 64 * 32; i++)
        for (int c = 0; c < 3 && i % 64 < 22; c++)
            differing += fabsf(kept[i][c] - b.film.picture[i][c]) > 0.02f;
    CHECK(differing == 0, "%u values differ", differing);
    bench_close(&b);
}

// --- sizes, and what is refused ------------------------------------------------------------------

TEST(pictures_of_any_size)
{
    static const uint32_t sizes[][2] = {{33, 9}, {1, 1}, {3, 200}, {65, 64}, {64, 65}, {7, 5}};
    struct gpu gpu;
    struct denoiser denoiser = {0};
    struct err err = {0};
    static const float sigma = 0.3f;
    OPEN_GPU(&gpu, .validation = true);
    REQUIRE_OK(denoiser_create(&gpu, &denoiser, &err));
    for (int i = 0; i < 6; i++) {
        struct made_film film;
        REQUIRE_OK(film_open(&gpu, sizes[i][0], sizes[i][1], &film, &err));
        const struct denoise_call call = {
            .renderer = &film.renderer, .camera = &across, .temporal = true};
        REQUIRE_OK(film_make(&film, noisy_pixel, &sigma, &err));
        REQUIRE_OK(film_denoise(&film, &denoiser, &call, &err));
        CHECK(denoiser.width == sizes[i][0] && denoiser.height == sizes[i][1], "%u x %u",
              denoiser.width, denoiser.height);
        for (uint32_t p = 0; p < film.width * film.height; p++)
            CHECK(fabsf(film.picture[p][0] - 0.5f) <= 0.15f, "%u x %u: pixel %u: %g", film.width,
                  film.height, p, (double)film.picture[p][0]);
        REQUIRE_OK(denoiser_keep(&denoiser, &call, &err));
        film_close(&film);
    }
    denoiser_finish(&denoiser);
    gpu_close(&gpu);
    CHECK(gpu.validation_messages == 0, "%u validation messages", gpu.validation_messages);
    CHECK(gpu.allocated_bytes == 0, "%llu bytes are left", (unsigned long long)gpu.allocated_bytes);
}

// The device's workgroups take 1 ms, and it is lost after 250 ms, which any kernel over the whole
// film would exceed.
static void denoise_twice(const struct gpu_limit_overrides *limits, struct arena *arena,
                          float (**pictures)[4])
{
    enum { WIDTH = 200, HEIGHT = 150 };
    const float sigma = 0.3f;
    struct bench b = {0};
    OPEN_GPU(&b.gpu, .limits = *limits);
    REQUIRE(bench_open(&b, WIDTH, HEIGHT), "%s", b.err.msg);
    b.call.temporal = true;
    const size_t bytes = WIDTH * HEIGHT * sizeof **pictures;
    for (int i = 0; i < 2; i++) {
        RUN_BENCH(b, noisy_pixel, &sigma);
        pictures[i] = arena_alloc(arena, bytes, 16);
        memcpy(pictures[i], b.film.picture, bytes);
        REQUIRE(denoiser_keep(&b.denoiser, &b.call, &b.err), "%s", b.err.msg);
        b.call.has_changed = true;
    }
    for (int pass = 0; pass < DENOISE_PASS_COUNT && limits->group_ns && b.gpu.has_timestamps;
         pass++)
        CHECK(b.denoiser.pass_ms[pass] > 0.0 || pass > DENOISE_PASS_blend, "pass %d", pass);
    bench_close(&b);
}

TEST(a_slow_device_shows_the_same)
{
    float(*pictures[2][2])[4] = {0};
    struct arena arena = {0};
    denoise_twice(&(struct gpu_limit_overrides){0}, &arena, pictures[0]);
    denoise_twice(&(struct gpu_limit_overrides){.group_ns = 1000000, .watchdog_ms = 250}, &arena,
                  pictures[1]);
    for (int i = 0; i < 2; i++)
        CHECK(pictures[0][i] && pictures[1][i] &&
                  memcmp(pictures[0][i], pictures[1][i], 200 * 150 * sizeof *pictures[0][i]) == 0,
              "picture %d", i);
    arena_finish(&arena);
}

TEST(bad_calls_are_refused)
{
    OPEN_BENCH(b, 8, 8);
    b.call.iterations = 6;
    CHECK(!denoiser_run(&b.denoiser, &b.call, &b.err) && b.err.code == ERR_USAGE, "%s", b.err.msg);
    b.call.iterations = 0;
    struct renderer bare;
    struct renderer_params params = {.gpu = &b.gpu, .scene = &b.film.scene, .wave = 1024};
    REQUIRE(renderer_create(&params, &bare, &b.err), "%s", b.err.msg);
    b.call.renderer = &bare;
    CHECK(!denoiser_run(&b.denoiser, &b.call, &b.err) && b.err.code == ERR_BUG, "%s", b.err.msg);
    renderer_finish(&bare);
    bench_close(&b);
}

TEST_MAIN(TEST_CASE(constant_stays), TEST_CASE(what_is_certain_stays_and_the_film_too),
          TEST_CASE(the_wavelet_is_the_cascade_of_splines), TEST_CASE(white_noise_goes),
          TEST_CASE(edges_stay_sharp), TEST_CASE(nothing_becomes_infinite),
          TEST_CASE(empty_pixels_give_nothing), TEST_CASE(pictures_of_any_size),
          TEST_CASE(a_slow_device_shows_the_same), TEST_CASE(bad_calls_are_refused))
