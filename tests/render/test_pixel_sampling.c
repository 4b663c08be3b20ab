// Compares the results of each kind of pixel sampling at an edge with closed forms: the mean, its
// variance, and the variance estimated from half-buffers.
#include "render_fixture.h"
#include <stdio.h>

// The number of pixels is the width of the light. With 1024, the limits of check_expectation() for
// contiguous halves are exceeded for one seed of 16.
enum { PIXELS = 1984, STRATA = 4 };

// The lower 30 % of each pixel emit.
#define SHARE 0.3

static void render_edge(struct gpu *gpu, const struct settings *wanted, uint64_t samples,
                        struct arena *arena, struct film_image *film)
{
    struct scene scene;
    struct err err = {0};
    REQUIRE_OK(load_scene("src/check/scenes/edge.json",
                          (struct scene_override[]){{"film.width", "1984"}, {0}}, &scene, &err));
    scene.settings.max_bounces = 0;
    scene.settings.pixel_jitter = wanted->pixel_jitter;
    scene.settings.pixel_sampling = wanted->pixel_sampling;
    scene.settings.pixel_strata = STRATA;
    scene.settings.halves = wanted->halves;
    scene.settings.spp = samples;
    scene.settings.seed = 5;
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    REQUIRE_OK(render_film(&params, samples, arena, film, NULL, &err));
    scene_finish(&scene);
}

// The mean of a value over independent pixels, and its standard error.
struct average {
    double mean, error;
};

static struct average average(const double *values)
{
    double sum = 0, squares = 0;
    for (int i = 0; i < PIXELS; i++)
        sum += values[i];
    for (int i = 0; i < PIXELS; i++)
        squares += (values[i] - sum / PIXELS) * (values[i] - sum / PIXELS);
    return (struct average){sum / PIXELS, sqrt(squares / (PIXELS - 1) / PIXELS)};
}

struct expectation {
    uint32_t pixel_sampling, halves;
    uint64_t samples;
    double mean, variance; // of a pixel
};

static const double light[3] = {1, 2, 4};

// The limit is |t| <= 4, which any of eleven values exceeds with a probability of 0.2 %. The
// relative standard deviation of a variance of 1984 pixels is 3.2 % for normal variables.
static void check_expectation(struct gpu *gpu, const struct expectation *e)
{
    static double means[PIXELS], squares[PIXELS], excess[PIXELS];
    const char *name = pixel_sampling_names[e->pixel_sampling];
    struct arena arena = {0};
    struct film_image film;
    render_edge(gpu,
                &(struct settings){
                    .pixel_jitter = true, .pixel_sampling = e->pixel_sampling, .halves = e->halves},
                e->samples, &arena, &film);
    for (int i = 0; i < PIXELS; i++) {
        double mean = (double)film.mean[i][2] / light[2];
        double difference = ((double)film.half_a[i][2] - (double)film.half_b[i][2]) / light[2];
        means[i] = mean;
        squares[i] = (mean - e->mean) * (mean - e->mean);
        excess[i] = difference * difference / 4 - squares[i];
    }
    struct average mean = average(means), variance = average(squares), more = average(excess);
    printf("  %-10s %2d samples, halves %-11s: mean %.4f (%.4f), variance %.5f (%.5f), halves' "
           "%.5f\n",
           name, (int)e->samples, halves_names[e->halves], mean.mean, e->mean, variance.mean,
           e->variance, variance.mean + more.mean);
    CHECK(fabs(mean.mean - e->mean) <= 4 * mean.error, "%s: mean %.4f, not %.4f", name, mean.mean,
          e->mean);
    CHECK(fabs(variance.mean - e->variance) <= 0.2 * e->variance, "%s: variance %.5f, not %.5f",
          name, variance.mean, e->variance);
    // Contiguous halves share a round: strata that one half has, the other lacks, so they differ by
    // more.
    bool is_bound = e->halves == HALVES_CONTIGUOUS && e->pixel_sampling != PIXEL_SAMPLING_RANDOM;
    CHECK(is_bound ? more.mean > 4 * more.error : fabs(more.mean) <= 4 * more.error,
          "%s: the halves say %.5f, the variance is %.5f", name, variance.mean + more.mean,
          variance.mean);
    arena_finish(&arena);
}

// Returns the variance of the mean of m of 16 strata: that of a sample within its stratum, and that
// of the choice of strata (Cochran 1977, "Sampling Techniques", equation 2.8).
static double variance_of_some(double between, double within, double m)
{
    return (between * (16 - m) / 15 + within) / m;
}

TEST(edge)
{
    // The last of four rows of strata emits, and a fifth of the third one.
    const double third = SHARE * STRATA - 1;
    const double between = (1 + third * third) / 4 - SHARE * SHARE; // variance of the rows' means
    const double within = third * (1 - third) / 4;
    const double grid = 0.25 * 0.75;
    const double random = SHARE * (1 - SHARE);
    const struct expectation list[] = {
        {PIXEL_SAMPLING_RANDOM, HALVES_INDEPENDENT, 6, SHARE, random / 6},
        {PIXEL_SAMPLING_RANDOM, HALVES_INDEPENDENT, 32, SHARE, random / 32},
        {PIXEL_SAMPLING_RANDOM, HALVES_CONTIGUOUS, 16, SHARE, random / 16},
        // Each half has three strata and all 16; one sequence has all 16 and 6.
        {PIXEL_SAMPLING_STRATIFIED, HALVES_INDEPENDENT, 6, SHARE,
         variance_of_some(between, within, 3) / 2},
        {PIXEL_SAMPLING_STRATIFIED, HALVES_INDEPENDENT, 32, SHARE, within / 32},
        {PIXEL_SAMPLING_STRATIFIED, HALVES_CONTIGUOUS, 16, SHARE, within / 16},
        {PIXEL_SAMPLING_STRATIFIED, HALVES_CONTIGUOUS, 6, SHARE,
         variance_of_some(between, within, 6)},
        {PIXEL_SAMPLING_GRID, HALVES_INDEPENDENT, 6, 0.25, variance_of_some(grid, 0, 3) / 2},
        {PIXEL_SAMPLING_GRID, HALVES_CONTIGUOUS, 6, 0.25, variance_of_some(grid, 0, 6)},
    };
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (size_t i = 0; i < sizeof list / sizeof *list; i++)
        check_expectation(&gpu, &list[i]);
    gpu_close(&gpu);
}

// Deterministic places: full rounds of a grid are the same in all pixels and halves, and `centre`
// equals pixels without jitter, bit for bit.
TEST(fixed_places)
{
    struct gpu gpu;
    struct arena arena = {0};
    struct film_image grid, centre, off;
    uint32_t wrong = 0;
    OPEN_GPU(&gpu, 0);
    render_edge(&gpu,
                &(struct settings){.pixel_jitter = true, .pixel_sampling = PIXEL_SAMPLING_GRID}, 64,
                &arena, &grid);
    render_edge(&gpu,
                &(struct settings){.pixel_jitter = true, .pixel_sampling = PIXEL_SAMPLING_CENTRE},
                8, &arena, &centre);
    render_edge(&gpu, &(struct settings){.pixel_sampling = PIXEL_SAMPLING_STRATIFIED}, 8, &arena,
                &off);
    for (int i = 0; i < PIXELS; i++)
        for (int c = 0; c < 3; c++)
            wrong += (double)grid.half_a[i][c] != light[c] / 4 ||
                     (double)grid.half_b[i][c] != light[c] / 4 || centre.mean[i][c] != 0;
    CHECK(wrong == 0, "%u values", wrong);
    CHECK(memcmp(centre.mean, off.mean, sizeof *off.mean * PIXELS) == 0,
          "the centre and no jitter differ");
    arena_finish(&arena);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(edge), TEST_CASE(fixed_places))
