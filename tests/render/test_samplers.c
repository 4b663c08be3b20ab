// Pictures by all samplers have the same mean, and pixel filters weight an edge according to their
// integral.
#include "metrics/metrics.h"
#include "render_fixture.h"
#include "check/replicates.h"

// --- the same picture ----------------------------------------------------------------------------

// All samplers except the grid, whose places are fixed: it is a quadrature with a bias.
static const uint32_t samplers[] = {SAMPLER_SOBOL, SAMPLER_PCG, SAMPLER_LCG, SAMPLER_STRATIFIED,
                                    SAMPLER_BLUE_NOISE};
enum { SAMPLERS = sizeof samplers / sizeof *samplers };

static void render_replicates(struct gpu *gpu, const char *path, uint32_t sampler, uint32_t samples,
                              struct replicates *out)
{
    const struct scene_override size[] = {{"film.width", "16"}, {"film.height", "16"}, {0}};
    struct scene scene;
    struct renderer r;
    struct err err = {0};
    REQUIRE_OK(load_scene(path, size, &scene, &err));
    scene.settings.sampler = sampler;
    scene.settings.spp = samples;
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    REQUIRE_OK(replicates_render(&r, &MEASURE_MEAN, REPLICATES * sampler, samples, out, &err));
    renderer_finish(&r);
    scene_finish(&scene);
}

// Computes Welch's t of the means of every pair and channel. Channels of one scene depend on each
// other: for 10 pairs, |t| <= 4.2 has a probability of error of 1e-3.
static void check_means(const char *path, uint32_t samples)
{
    static struct replicates replicates[SAMPLERS];
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (int i = 0; i < SAMPLERS; i++) {
        render_replicates(&gpu, path, samplers[i], samples, &replicates[i]);
        struct estimate e = replicates_estimate(&replicates[i], 1);
        printf("%s, %u samples, %-10s green %.6g +- %.2g %%\n", path, samples,
               sampler_names[samplers[i]], e.mean, 100 * e.half_width / e.mean);
    }
    for (int pair = 0; pair < SAMPLERS * SAMPLERS; pair++) {
        int a = pair / SAMPLERS, b = pair % SAMPLERS;
        for (uint32_t c = 0; c < 3 && a < b; c++) {
            struct estimate x = replicates_estimate(&replicates[a], c);
            struct estimate y = replicates_estimate(&replicates[b], c);
            double t = (x.mean - y.mean) / hypot(x.standard_error, y.standard_error);
            CHECK(fabs(t) <= 4.2, "%s, %u samples, channel %u: %s and %s differ, t = %.2f", path,
                  samples, c, sampler_names[samplers[a]], sampler_names[samplers[b]], t);
        }
    }
    gpu_close(&gpu);
}

// The number of samples gives halves that are neither a power of two nor a square.
TEST(same_means)
{
    check_means("scenes/cornell.json", 6);
}

TEST(same_means_long)
{
    check_means("scenes/cornell.json", 74);
    check_means("scenes/spheres.json", 11);
    check_means("scenes/classical.json", 37);
}

// --- an edge -------------------------------------------------------------------------------------

// Returns the weight of a filter with this radius below a horizontal line at this distance under
// the pixel's centre: its density integrated over y in 2^16 strips. All four filters are symmetric.
static double weight_below(uint32_t filter, double radius, double line)
{
    enum { STRIPS = 1 << 16 };
    double sum = 0, under = 0;
    for (int i = 0; i < STRIPS; i++) {
        double y = (2 * i + 1.0) / STRIPS - 1, w = 1;
        if (filter == FILTER_TENT)
            w = 1 - fabs(y);
        if (filter == FILTER_GAUSSIAN) // within the disc: the chord at y
            w = exp(-4.5 * y * y) * erf(sqrt(4.5 * (1 - y * y)));
        if (filter == FILTER_BLACKMAN_HARRIS)
            w = 0.35875 + 0.48829 * cos(M_PI * y) + 0.14128 * cos(2 * M_PI * y) +
                0.01168 * cos(3 * M_PI * y);
        sum += w;
        under += y * radius > line ? w : 0;
    }
    return under / sum;
}

static void check_edge(struct gpu *gpu, uint32_t filter, float radius)
{
    enum { SAMPLES = 1 << 14 };
    struct scene scene;
    struct arena arena = {0};
    struct film_image film;
    struct err err = {0};
    REQUIRE_OK(load_scene("src/check/scenes/edge.json", NULL, &scene, &err));
    scene.settings.width = scene.settings.height = 1;
    scene.settings.max_bounces = 0;
    scene.settings.filter = filter;
    scene.settings.filter_radius = radius;
    double used = (double)settings_filter_radius(&scene.settings);
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    REQUIRE_OK(render_film(&params, SAMPLES, &arena, &film, NULL, &err));
    // The edge is 70 % of the way down. There is no light above it, nor more than a metre below it.
    double expected = weight_below(filter, used, 0.2), mean = (double)film.mean[0][0];
    printf("%-16s radius %.4g: %.5f, expected %.5f\n", filter_names[filter], used, mean, expected);
    // The error of Sobol's points at a straight edge is below 2 / sqrt(n)^1.5.
    CHECK(fabs(mean - expected) <= 1.5e-3, "%s, radius %g: %g, expected %g", filter_names[filter],
          used, mean, expected);
    arena_finish(&arena);
    scene_finish(&scene);
}

TEST(edge)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (uint32_t filter = 0; filter_names[filter]; filter++) {
        check_edge(&gpu, filter, 0);
        check_edge(&gpu, filter, 4);
    }
    gpu_close(&gpu);
}

// --- contiguous halves ---------------------------------------------------------------------------

static void render_halves(struct gpu *gpu, uint32_t halves, uint32_t planned, uint32_t samples,
                          struct arena *arena, struct film_image *film)
{
    const struct scene_override size[] = {{"film.width", "16"}, {"film.height", "16"}, {0}};
    struct scene scene;
    struct err err = {0};
    REQUIRE_OK(load_scene("scenes/cornell.json", size, &scene, &err));
    scene.settings.sampler = SAMPLER_PCG; // its samples do not depend on the halves
    scene.settings.halves = halves;
    scene.settings.spp = planned;
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    REQUIRE_OK(render_film(&params, samples, arena, film, NULL, &err));
    scene_finish(&scene);
}

static double largest_difference(float (*a)[3], float (*b)[3])
{
    double largest = 0;
    for (int i = 0; i < 16 * 16 * 3; i++) {
        double x = (double)a[i / 3][i % 3], y = (double)b[i / 3][i % 3];
        largest = fmax(largest, fabs(x - y) / (fabs(y) + 1e-3));
    }
    return largest;
}

// With 7 samples the first 4 are half A. A render that ends after 3 of them has no half B yet.
TEST(contiguous)
{
    struct gpu gpu;
    struct arena arena = {0};
    struct film_image whole, first, parted, ended;
    OPEN_GPU(&gpu, 0);
    render_halves(&gpu, HALVES_CONTIGUOUS, 7, 7, &arena, &parted);
    render_halves(&gpu, HALVES_INDEPENDENT, 7, 7, &arena, &whole);
    render_halves(&gpu, HALVES_INDEPENDENT, 7, 4, &arena, &first);
    double mean = largest_difference(parted.mean, whole.mean);
    double half = largest_difference(parted.half_a, first.mean);
    CHECK(mean <= 1e-6 && half <= 1e-6, "mean off by %g, first half by %g", mean, half);
    render_halves(&gpu, HALVES_CONTIGUOUS, 7, 3, &arena, &ended);
    render_halves(&gpu, HALVES_INDEPENDENT, 7, 3, &arena, &first);
    mean = largest_difference(ended.mean, first.mean);
    CHECK(mean <= 1e-6, "mean off by %g when ended early", mean);
    arena_finish(&arena);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(same_means), TEST_CASE(same_means_long), TEST_CASE(edge), TEST_CASE(contiguous))
