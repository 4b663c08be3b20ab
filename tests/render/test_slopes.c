// Measures how the error decreases with the number of samples, for each sampler. The error is the
// variance between replicates with different seeds, relative to the square of their mean as in
// relMSE, averaged over pixels and channels. It needs no reference, and a bias common to all
// replicates does not count.
#include "metrics/metrics.h"
#include "render_fixture.h"

#define SIDE 16u
#define VALUES (SIDE * SIDE * 3)
#define SEEDS 16u
#define COUNTS_MAX 9u

// The pictures of every seed, at doubling numbers of samples from 2^4 on.
struct pictures {
    uint32_t counts;
    float value[COUNTS_MAX][SEEDS][VALUES];
};

static const char *const paths[] = {
    "scenes/classical.json",
    "scenes/materials_roughness.json",
    "scenes/spheres.json",
    "scenes/cornell.json",
};
#define PATHS (sizeof paths / sizeof *paths)

static void open_scene(const char *path, struct scene *scene)
{
    const struct scene_override size[] = {{"film.width", "16"}, {"film.height", "16"}, {0}};
    struct err err = {0};
    REQUIRE_OK(load_scene(path, size, scene, &err));
}

static void keep(struct renderer *r, float *values)
{
    struct arena arena = {0};
    struct film_image film;
    struct err err = {0};
    REQUIRE_OK(renderer_read(r, &arena, &film, &err));
    memcpy(values, film.mean, VALUES * sizeof *values);
    arena_finish(&arena);
}

// Every replicate continues from each number of samples to the next.
static void render_counts(struct gpu *gpu, const char *path, uint32_t sampler, struct pictures *out)
{
    struct scene scene;
    struct renderer r;
    struct err err = {0};
    open_scene(path, &scene);
    scene.settings.sampler = sampler;
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        REQUIRE_OK(renderer_restart(&r, seed, &err));
        for (uint32_t i = 0; i < out->counts; i++) {
            uint64_t all = UINT64_C(16) << i;
            const struct render_call call = {.samples = i ? all / 2 : all};
            REQUIRE_OK(renderer_render(&r, &call, &err));
            keep(&r, out->value[i][seed]);
        }
    }
    renderer_finish(&r);
    scene_finish(&scene);
}

// Returns the variance between seeds without seed `left_out`, averaged over the picture.
static double variance(float (*value)[VALUES], uint32_t left_out)
{
    double sum = 0;
    for (uint32_t v = 0; v < VALUES; v++) {
        double samples[SEEDS], mean, own;
        size_t count = 0;
        for (uint32_t seed = 0; seed < SEEDS; seed++)
            if (seed != left_out)
                samples[count++] = (double)value[seed][v];
        stats_mean_variance(samples, count, &mean, &own);
        sum += own / (mean * mean + METRICS_RELMSE_EPSILON);
    }
    return sum / VALUES;
}

// Returns the slope of log variance over log samples, by least squares.
static double slope_without(struct pictures *pictures, uint32_t left_out)
{
    double center = (pictures->counts - 1) / 2.0, products = 0, squares = 0;
    for (uint32_t i = 0; i < pictures->counts; i++) {
        products += (i - center) * log2(variance(pictures->value[i], left_out));
        squares += (i - center) * (i - center);
    }
    return products / squares;
}

struct slope {
    double value, half_width; // half-width of its 95 % interval, by the jackknife over seeds
};

static struct slope find_slope(struct pictures *pictures)
{
    double left_out[SEEDS], mean, spread;
    for (uint32_t seed = 0; seed < SEEDS; seed++)
        left_out[seed] = slope_without(pictures, seed);
    stats_mean_variance(left_out, SEEDS, &mean, &spread);
    double error = (SEEDS - 1) * sqrt(spread / SEEDS);
    return (struct slope){slope_without(pictures, SEEDS),
                          error * stats_t_quantile(0.975, SEEDS - 1)};
}

// For independent samples, -1 must be in the interval widened by 0.05. For Sobol the slope must be
// at most -0.95, with the same allowance.
static void check_slopes(uint32_t path_count, uint32_t counts)
{
    static struct pictures pictures;
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    pictures.counts = counts;
    printf("2^4 to 2^%u samples, %u seeds\n", counts + 3, SEEDS);
    for (uint32_t s = 0; s < path_count; s++) {
        struct slope slopes[2];
        for (uint32_t sampler = SAMPLER_SOBOL; sampler <= SAMPLER_PCG; sampler++) {
            render_counts(&gpu, paths[s], sampler, &pictures);
            slopes[sampler] = find_slope(&pictures);
            printf("%-32s %-5s slope %.3f +- %.3f, variance %.3g to %.3g\n", paths[s],
                   sampler_names[sampler], slopes[sampler].value, slopes[sampler].half_width,
                   variance(pictures.value[0], SEEDS), variance(pictures.value[counts - 1], SEEDS));
        }
        struct slope sobol = slopes[SAMPLER_SOBOL], pcg = slopes[SAMPLER_PCG];
        CHECK(fabs(pcg.value + 1) <= 0.05 + pcg.half_width, "%s: independent samples fall with %g",
              paths[s], pcg.value);
        CHECK(sobol.value <= -0.95 + sobol.half_width, "%s: Sobol falls with %g", paths[s],
              sobol.value);
        // With wider intervals these checks would mean nothing.
        CHECK(pcg.half_width <= 0.1 && sobol.half_width <= 0.1, "%s: intervals of %g and %g",
              paths[s], pcg.half_width, sobol.half_width);
    }
    gpu_close(&gpu);
}

TEST(slopes)
{
    check_slopes(2, 5);
}

TEST(slopes_long)
{
    check_slopes(PATHS, COUNTS_MAX);
}

// --- all samplers at equal samples ---------------------------------------------------------------

struct method {
    uint32_t sampler, halves, samples;
};

static void render_seeds(struct gpu *gpu, const char *path, struct method method,
                         float (*value)[VALUES])
{
    struct scene scene;
    struct renderer r;
    struct err err = {0};
    open_scene(path, &scene);
    scene.settings.sampler = method.sampler;
    scene.settings.halves = method.halves;
    scene.settings.spp = method.samples;
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    const struct render_call call = {.samples = method.samples};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        REQUIRE_OK(renderer_restart(&r, seed, &err) && renderer_render(&r, &call, &err));
        keep(&r, value[seed]);
    }
    renderer_finish(&r);
    scene_finish(&scene);
}

static double variance_of(struct gpu *gpu, const char *path, struct method method)
{
    static float value[SEEDS][VALUES];
    render_seeds(gpu, path, method, value);
    return variance(value, SEEDS);
}

// Samplers with independent halves; one of them also with contiguous halves, to show the cost of
// independence.
static const struct {
    const char *name;
    uint32_t sampler, halves;
} methods[] = {
    {"sobol", SAMPLER_SOBOL, HALVES_INDEPENDENT},
    {"sobol, contiguous halves", SAMPLER_SOBOL, HALVES_CONTIGUOUS},
    {"lcg", SAMPLER_LCG, HALVES_INDEPENDENT},
    {"stratified", SAMPLER_STRATIFIED, HALVES_INDEPENDENT},
    {"grid", SAMPLER_GRID, HALVES_INDEPENDENT},
    {"blue-noise", SAMPLER_BLUE_NOISE, HALVES_INDEPENDENT},
};

// Compares with independent samples. One of the numbers of samples is neither even nor a square.
static void compare_samplers(const uint32_t *counts, uint32_t count)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    printf("variance relative to that of independent samples, %u seeds\n", SEEDS);
    for (uint32_t i = 0; i < PATHS * count; i++) {
        const char *path = paths[i / count];
        struct method method = {SAMPLER_PCG, HALVES_INDEPENDENT, counts[i % count]};
        double base = variance_of(&gpu, path, method);
        printf("%s, %u samples: pcg %.3g", path, method.samples, base);
        for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
            method.sampler = methods[m].sampler;
            method.halves = methods[m].halves;
            double ratio = variance_of(&gpu, path, method) / base;
            printf("; %s %.2f", methods[m].name, ratio);
            // With few samples some pixels have most of the variance, which is then known only to
            // 20 %.
            CHECK(ratio <= 1.5, "%s, %u samples, %s: %g", path, method.samples, methods[m].name,
                  ratio);
        }
        printf("\n");
        fflush(stdout);
    }
    gpu_close(&gpu);
}

TEST(samplers_long)
{
    static const uint32_t counts[] = {4, 16, 37, 256};
    compare_samplers(counts, sizeof counts / sizeof *counts);
}

// --- to the eye ----------------------------------------------------------------------------------

// Blurs like the eye from afar: computes means over a pixel and its neighbours, weighted (1, 2, 1)
// / 4 horizontally and vertically, for pixels that have all neighbours.
static void blur(float (*value)[VALUES])
{
    static float sharp[VALUES];
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        memcpy(sharp, value[seed], sizeof sharp);
        memset(value[seed], 0, sizeof sharp);
        for (uint32_t i = 0; i < VALUES; i++) {
            uint32_t x = i / 3 % SIDE, y = i / 3 / SIDE;
            if (x == 0 || y == 0 || x + 1 == SIDE || y + 1 == SIDE)
                continue;
            for (uint32_t n = 0; n < 9; n++) {
                uint32_t across = n % 3, down = n / 3;
                float weight = (across == 1 ? 2.0f : 1.0f) * (down == 1 ? 2.0f : 1.0f) / 16.0f;
                value[seed][i] += weight * sharp[i - 3 * (SIDE + 1) + 3 * (SIDE * down + across)];
            }
        }
    }
}

TEST(blurred_long)
{
    static const uint32_t others[] = {SAMPLER_SOBOL, SAMPLER_BLUE_NOISE};
    static float value[SEEDS][VALUES];
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    printf("variance after a blur, relative to that of independent samples, %u seeds\n", SEEDS);
    for (uint32_t i = 0; i < PATHS * 3; i++) {
        struct method method = {SAMPLER_PCG, HALVES_INDEPENDENT, 1u << i % 3};
        double ratio[2];
        render_seeds(&gpu, paths[i / 3], method, value);
        blur(value);
        double base = variance(value, SEEDS);
        for (int o = 0; o < 2; o++) {
            method.sampler = others[o];
            render_seeds(&gpu, paths[i / 3], method, value);
            blur(value);
            ratio[o] = variance(value, SEEDS) / base;
        }
        printf("%s, %u samples: sobol %.2f; blue-noise %.2f\n", paths[i / 3], method.samples,
               ratio[0], ratio[1]);
        fflush(stdout);
        // With skewed noise, the variance of 16 seeds has an error of about 20 %.
        CHECK(ratio[1] <= 1.3 * ratio[0], "%s, %u samples: %g, sobol %g", paths[i / 3],
              method.samples, ratio[1], ratio[0]);
    }
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(slopes), TEST_CASE(slopes_long), TEST_CASE(samplers_long),
          TEST_CASE(blurred_long))
