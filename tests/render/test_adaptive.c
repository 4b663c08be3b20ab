// Tests numbers of samples by tile: how they are distributed, that they cause no bias, and what
// they gain. Also tests that --error is reached on a real scene.
#include "job/job.h"
#include "metrics/metrics.h"
#include "render_fixture.h"
#include "check/replicates.h"

// --- the plan ------------------------------------------------------------------------------------

static struct tile_plan plan_of(uint32_t width, uint32_t height, const double *variances,
                                uint32_t average, struct arena *arena)
{
    const struct tile_plan_params params = {
        .width = width, .height = height, .variances = variances, .average = average};
    struct tile_plan plan;
    struct err err = {0};
    if (!tile_plan_make(&params, arena, &plan, &err))
        CHECK(false, "%s", err.msg);
    uint32_t least = UINT32_MAX, most = 0;
    for (uint32_t i = 0; i < plan.tiles_x * plan.tiles_y; i++) {
        CHECK(plan.counts[i] % 2 == 0 && plan.counts[i] >= TILE_SAMPLES_MIN, "%u", plan.counts[i]);
        CHECK(plan.counts[i] <= TILE_MOST_FACTOR * average);
        CHECK(plan.counts[i] >= average / TILE_LEAST_DIVISOR);
        least = plan.counts[i] < least ? plan.counts[i] : least;
        most = plan.counts[i] > most ? plan.counts[i] : most;
    }
    CHECK(plan.least == least && plan.most == most);
    CHECK(plan.total <= (uint64_t)average * width * height, "%llu samples",
          (unsigned long long)plan.total);
    return plan;
}

TEST(even_pictures_are_sampled_evenly)
{
    struct arena arena = {0};
    double ones[12] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}, none[12] = {0};
    double useless[12] = {NAN, INFINITY, -1, -INFINITY, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    const double *all[] = {NULL, ones, none, useless};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        struct tile_plan plan = plan_of(50, 47, all[i], 16, &arena);
        CHECK(plan.tiles_x == 4 && plan.tiles_y == 3 && plan.least == 16 && plan.most == 16,
              "%zu: %u to %u", i, plan.least, plan.most);
        CHECK(plan.total == 16 * 50 * 47);
    }
    CHECK(plan_of(1, 1, NULL, 2, &arena).counts[0] == 2);
    CHECK(plan_of(1 << 24, 1, NULL, 1000000, &arena).least == 1000000);
    arena_finish(&arena);
}

// Neyman 1934: the number of samples is proportional to the standard deviation, here with the
// neighbours' part.
TEST(counts_go_with_the_root_of_the_variance)
{
    enum { TILES = 40 };
    struct arena arena = {0};
    double variances[TILES * TILES];
    for (int i = 0; i < TILES * TILES; i++)
        variances[i] = i % TILES < TILES / 2 ? 1.0 : 9.0;
    struct tile_plan plan = plan_of(16 * TILES, 16 * TILES, variances, 100, &arena);
    CHECK(plan.least == 50 && plan.most >= 146 && plan.most <= 150, "%u to %u", plan.least,
          plan.most);
    CHECK((double)plan.total > 0.98 * 100 * 256 * TILES * TILES);
    // One tile has all the variance and gets the greatest number; the others share the rest.
    for (int i = 0; i < TILES * TILES; i++)
        variances[i] = i == 5 * TILES + 5 ? 1e300 : 1e-300;
    plan = plan_of(16 * TILES, 16 * TILES, variances, 16, &arena);
    CHECK(plan.counts[5 * TILES + 5] == 256 && plan.counts[4 * TILES + 4] == 256);
    CHECK(plan.counts[5 * TILES + 8] == 14, "%u", plan.counts[5 * TILES + 8]);
    for (int i = 0; i < TILES * TILES; i++)
        variances[i] = i % 2 ? 1.0 : 0.01;
    plan = plan_of(16 * TILES, 16 * TILES, variances, 3, &arena);
    CHECK(plan.least == 2 && plan.most <= 48);
    arena_finish(&arena);
}

// --- renders -------------------------------------------------------------------------------------

// Repeats the program's work many times in one process.
struct trial {
    struct scene scene;
    struct job job;
};

static bool start_trial(struct trial *trial, struct job_goal goal, struct gpu *gpu,
                        const char *scene, const struct scene_override *overrides, struct err *err)
{
    *trial = (struct trial){0};
    const struct job_params params = {
        .renderer = {.gpu = gpu, .wave = 16384}, .scene = &trial->scene, .goal = goal};
    return load_scene(scene, overrides, &trial->scene, err) && job_start(&params, &trial->job, err);
}

static void finish_trial(struct trial *trial)
{
    job_finish(&trial->job);
    scene_finish(&trial->scene);
}

// Renders from the beginning with another seed.
static bool run_trial(struct trial *trial, uint32_t seed, struct err *err)
{
    struct job *job = &trial->job;
    return job_begin(job, seed, trial->scene.settings.spp, err) && job_run(job, err) &&
           job_read_film(job, err);
}

#define REFERENCE_SEED 100000u
static const char caustic_scene[] = "tests/render/scenes/caustic.json";

// The only light is a small lamp, which scattered paths hit about once in 250 times. With light
// sampling, the picture is lit evenly.
#define SMALL_LAMP                                                                                 \
    {"film.width", "48"}, {"film.height", "48"}, {"settings.sampler", "pcg"},                      \
        {"settings.max_bounces", "2"},                                                             \
    {                                                                                              \
        "environment.radiance", "[0, 0, 0]"                                                        \
    }
static const struct scene_override spiky[] = {SMALL_LAMP, {"settings.nee", "false"}, {0}};
static const struct scene_override smooth[] = {SMALL_LAMP, {0}};

enum { BIAS_TILES = 9 }; // tiles of 48 x 48 pixels

// The number of samples that a replicate gave to a tile, and the tile's mean.
struct tile_results {
    double counts[BIAS_TILES][REPLICATES], means[BIAS_TILES][REPLICATES];
};

static void note_tiles(const struct job *job, uint32_t replicate, struct tile_results *out)
{
    for (uint32_t tile = 0; tile < BIAS_TILES; tile++) {
        out->counts[tile][replicate] = job->plan.counts[tile];
        out->means[tile][replicate] = 0;
    }
    for (uint32_t i = 0; i < job->film.width * job->film.height; i++) {
        uint32_t x = i % job->film.width, y = i / job->film.width;
        out->means[y / TILE_SIDE * 3 + x / TILE_SIDE][replicate] += job->film.mean[i][0];
    }
}

// Returns Student's t of the covariance between a tile's number of samples and its mean, summed
// over tiles relative to their averages. It is zero if the numbers do not depend on the samples
// that they count. If the pilot's samples were part of the picture, tiles that began bright would
// have more samples.
static double covariance_t(const struct tile_results *results)
{
    double sums[REPLICATES] = {0}, mean, variance;
    for (uint32_t tile = 0; tile < BIAS_TILES; tile++) {
        double count, value;
        stats_mean_variance(results->counts[tile], REPLICATES, &count, &variance);
        stats_mean_variance(results->means[tile], REPLICATES, &value, &variance);
        for (uint32_t i = 0; i < REPLICATES && value > 0; i++)
            sums[i] +=
                (results->counts[tile][i] / count - 1) * (results->means[tile][i] / value - 1);
    }
    stats_mean_variance(sums, REPLICATES, &mean, &variance);
    return mean / sqrt(variance / REPLICATES);
}

// Compares the mean of pictures with numbers of samples from a pilot to that of pictures with equal
// numbers and another estimator of the same light.
TEST(counts_bias_nothing)
{
    const struct job_goal adaptive = {.samples = 16, .adaptive = true}, plain = {.samples = 32};
    struct trial trial, reference;
    const struct job *job = &trial.job;
    struct replicates tiles = {.count = 3}, even = {.count = 3};
    static struct tile_results results;
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(start_trial(&trial, adaptive, &gpu, caustic_scene, spiky, &err));
    REQUIRE_OK(start_trial(&reference, plain, &gpu, caustic_scene, smooth, &err));
    for (uint32_t i = 0; i < REPLICATES; i++) {
        double values[2][REPLICATES_VALUES];
        REQUIRE_OK(run_trial(&trial, i, &err) && run_trial(&reference, REFERENCE_SEED + i, &err));
        CHECK(job->plan.least < job->plan.most, "seed %u: all tiles have %u", i, job->plan.least);
        note_tiles(job, i, &results);
        MEASURE_MEAN.measure(&job->film, values[0]);
        MEASURE_MEAN.measure(&reference.job.film, values[1]);
        for (int c = 0; c < 3; c++) {
            tiles.values[c][i] = values[0][c];
            even.values[c][i] = values[1][c];
        }
    }
    for (uint32_t c = 0; c < 3; c++) {
        struct estimate a = replicates_estimate(&tiles, c), b = replicates_estimate(&even, c);
        double t = (a.mean - b.mean) / hypot(a.standard_error, b.standard_error);
        printf("channel %u: by tile %.5f +- %.5f, even %.5f +- %.5f, t = %.2f\n", c, a.mean,
               a.standard_error, b.mean, b.standard_error, t);
        CHECK(fabs(t) < REPLICATES_T_MAX, "channel %u: t = %g", c, t);
        CHECK(a.standard_error < 0.02 * a.mean, "too noisy to tell");
    }
    double t = covariance_t(&results);
    printf("counts and means of tiles: t = %.2f\n", t);
    CHECK(fabs(t) < REPLICATES_T_MAX, "counts and means of tiles go together: t = %g", t);
    finish_trial(&trial);
    finish_trial(&reference);
    gpu_close(&gpu);
}

static double relmse(const struct film_image *film, const struct film_image *reference)
{
    struct metrics metrics;
    metrics_compare((const float(*)[3])film->mean, (const float(*)[3])reference->mean,
                    (uint64_t)film->width * film->height, NULL, &metrics);
    return metrics.relmse;
}

// A small bright caustic on an evenly lit floor, with equal total numbers of samples, including the
// pilot's.
TEST(a_caustic_gains)
{
    enum { SEEDS = 8, SAMPLES = 128 };
    const struct scene_override overrides[] = {{"settings.sampler", "pcg"}, {0}};
    const struct job_goal by_tile = {.samples = SAMPLES, .adaptive = true};
    const struct job_goal even = {.samples = SAMPLES + 16}, many = {.samples = 4096};
    struct trial trials[2], reference;
    double sums[2] = {0};
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(start_trial(&trials[0], even, &gpu, caustic_scene, overrides, &err) &&
               start_trial(&trials[1], by_tile, &gpu, caustic_scene, overrides, &err) &&
               start_trial(&reference, many, &gpu, caustic_scene, overrides, &err));
    REQUIRE_OK(run_trial(&reference, REFERENCE_SEED, &err));
    for (uint32_t seed = 0; seed < SEEDS; seed++)
        for (int i = 0; i < 2; i++) {
            REQUIRE_OK(run_trial(&trials[i], seed, &err));
            sums[i] += relmse(&trials[i].job.film, &reference.job.film) / SEEDS;
        }
    printf("relMSE evenly %.5f, by tile (%u to %u) %.5f: %.2f times\n", sums[0],
           trials[1].job.film.samples ? (unsigned)trials[1].job.film.least_samples : 0,
           (unsigned)trials[1].job.film.most_samples, sums[1], sums[0] / sums[1]);
    // Both sums contain the reference's own error; with 8 seeds the noise is about 20 %.
    CHECK(sums[0] / sums[1] > 1.05, "%g", sums[0] / sums[1]);
    for (int i = 0; i < 2; i++)
        finish_trial(&trials[i]);
    finish_trial(&reference);
    gpu_close(&gpu);
}

// --- the promise of --error ----------------------------------------------------------------------

static double local_relmse(const struct film_image *film, const struct film_image *reference)
{
    uint64_t pixels = (uint64_t)film->width * film->height;
    const float(*truth)[3] = (const float(*)[3])reference->mean;
    float(*means)[3] = calloc(pixels, sizeof *means);
    CHECK(means && metrics_local_means(truth, film->width, film->height, NULL, means));
    double error = metrics_local_relmse((const float(*)[3])film->mean, truth,
                                        (const float(*)[3])means, pixels);
    free(means);
    return error;
}

TEST(errors_asked_for_are_kept)
{
    // If each interval is correct with a probability of 0.95, fewer than 19 of 24 are correct in
    // 0.2 % of cases.
    enum { SEEDS = 24, HOLD_MIN = 19 };
    const double limit = 0.01;
    const struct scene_override overrides[] = {{"film.width", "32"},
                                               {"film.height", "32"},
                                               {"settings.sampler", "pcg"},
                                               {"camera.focal_length_mm", "60"},
                                               {0}};
    struct trial trial, reference;
    const struct job *job = &trial.job;
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(start_trial(&trial, (struct job_goal){.error = limit}, &gpu, "scenes/cornell.json",
                           overrides, &err) &&
               start_trial(&reference, (struct job_goal){.samples = 2048}, &gpu,
                           "scenes/cornell.json", overrides, &err) &&
               run_trial(&reference, REFERENCE_SEED, &err));
    uint32_t holds = 0;
    double samples = 0, sum = 0;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        REQUIRE_OK(run_trial(&trial, seed, &err));
        double truth =
            local_relmse(&job->film, &reference.job.film) - reference.job.error.local_relmse;
        CHECK(job->ended_by == ENDED_BY_ERROR, "seed %u", seed);
        holds += truth < limit;
        sum += truth / SEEDS;
        samples += (double)job->film.least_samples / SEEDS;
    }
    printf("%u of %u are below %g; on average %.4f after %.0f spp\n", holds, SEEDS, limit, sum,
           samples);
    CHECK(holds >= HOLD_MIN, "%u of %u", holds, SEEDS);
    CHECK(sum > 0.1 * limit, "ended far too late: %g", sum);
    finish_trial(&trial);
    finish_trial(&reference);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(even_pictures_are_sampled_evenly),
          TEST_CASE(counts_go_with_the_root_of_the_variance), TEST_CASE(counts_bias_nothing),
          TEST_CASE(a_caustic_gains), TEST_CASE(errors_asked_for_are_kept))
