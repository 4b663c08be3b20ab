// Next-event estimation alone, BSDF sampling alone and their combination by multiple importance
// sampling estimate the same picture: the Cornell box and a row of rough materials, as a whole and
// in 4 x 4 tiles. Estimates are compared in pairs, each with 64 replicates.
#include "base/clock.h"
#include "check/estimators.h"
#include "metrics/metrics.h"
#include "render_fixture.h"
#include "check/replicates.h"

#define SIDE 32u

#define WHOLE 16 // the value after those of the tiles

struct plan {
    const char *scene;
    uint64_t samples[3]; // for each estimator
    // Greatest half-width of the 95 % confidence interval of a difference, relative to the value.
    double half_width_whole, half_width_tile;
};

static void render_estimator(struct gpu *gpu, const struct plan *plan,
                             enum light_estimator estimator, struct replicates *out)
{
    const struct scene_override size[] = {{"film.width", "32"}, {"film.height", "32"}, {0}};
    uint64_t start = clock_ns();
    struct scene scene;
    struct renderer r;
    struct err err = {0};
    REQUIRE_OK(load_scene(plan->scene, size, &scene, &err));
    set_estimator(&scene.settings, estimator);
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    REQUIRE_OK(replicates_render(&r, &MEASURE_4X4_TILES, REPLICATES * estimator,
                                 plan->samples[estimator], out, &err));
    struct estimate whole = replicates_estimate(out, WHOLE);
    printf("estimator %d: mean %.6g +-%.2g %%, %.1f s\n", estimator, whole.mean / (3 * SIDE * SIDE),
           100 * whole.half_width / whole.mean, clock_seconds_since(start));
    renderer_finish(&r);
    scene_finish(&scene);
}

static void check_pair(const struct replicates *a, const struct replicates *b,
                       const struct plan *plan)
{
    for (uint32_t v = 0; v < MEASURE_4X4_TILES.count; v++) {
        struct estimate of_a = replicates_estimate(a, v), of_b = replicates_estimate(b, v);
        double error = hypot(of_a.standard_error, of_b.standard_error);
        double t = (of_a.mean - of_b.mean) / error, mean = 0.5 * (of_a.mean + of_b.mean);
        // The least of Welch's degrees of freedom, which are between these numbers.
        double half_width = error * stats_t_quantile(0.975, REPLICATES - 1);
        double bound = v == WHOLE ? plan->half_width_whole : plan->half_width_tile;
        if (v == WHOLE)
            printf("  difference %+.2g %%, t %+.1f\n", 100 * (of_a.mean / of_b.mean - 1), t);
        CHECK(fabs(t) <= REPLICATES_T_MAX, "value %u: %.6g and %.6g: t = %.2f", v, of_a.mean,
              of_b.mean, t);
        CHECK(half_width <= bound * mean, "value %u: half-width %.3g of the value", v,
              half_width / mean);
    }
}

static void check_estimators(const struct plan *plan)
{
    struct gpu gpu;
    struct replicates replicates[3] = {0};
    OPEN_GPU(&gpu, 0);
    for (int e = 0; e < 3; e++)
        render_estimator(&gpu, plan, (enum light_estimator)e, &replicates[e]);
    gpu_close(&gpu);
    check_pair(&replicates[ESTIMATOR_MIS], &replicates[ESTIMATOR_NEE], plan);
    check_pair(&replicates[ESTIMATOR_MIS], &replicates[ESTIMATOR_BSDF], plan);
    check_pair(&replicates[ESTIMATOR_NEE], &replicates[ESTIMATOR_BSDF], plan);
}

// The lamp fills a small part of a surface's view, so BSDF sampling alone needs the most samples.
TEST(agree)
{
    check_estimators(
        &(struct plan){"scenes/cornell.json",
                       {[ESTIMATOR_MIS] = 32, [ESTIMATOR_NEE] = 32, [ESTIMATOR_BSDF] = 128},
                       0.007,
                       0.10});
}

TEST(agree_long)
{
    check_estimators(
        &(struct plan){"scenes/cornell.json",
                       {[ESTIMATOR_MIS] = 512, [ESTIMATOR_NEE] = 512, [ESTIMATOR_BSDF] = 2048},
                       0.002,
                       0.025});
}

#define ROUGH_ROW "tests/render/scenes/rough_row.json"

TEST(agree_on_materials)
{
    check_estimators(
        &(struct plan){ROUGH_ROW,
                       {[ESTIMATOR_MIS] = 32, [ESTIMATOR_NEE] = 64, [ESTIMATOR_BSDF] = 64},
                       0.007,
                       0.10});
}

TEST(agree_on_materials_long)
{
    check_estimators(
        &(struct plan){ROUGH_ROW,
                       {[ESTIMATOR_MIS] = 512, [ESTIMATOR_NEE] = 1024, [ESTIMATOR_BSDF] = 1024},
                       0.002,
                       0.025});
}

TEST_MAIN(TEST_CASE(agree), TEST_CASE(agree_long), TEST_CASE(agree_on_materials),
          TEST_CASE(agree_on_materials_long))
