// Quads and boxes as triangles and as analytic shapes must give the same picture, as a whole and in
// 4 x 4 tiles, by 64 replicates of each.
#include "metrics/metrics.h"
#include "render_fixture.h"
#include "check/replicates.h"

static void render_form(struct gpu *gpu, const char *form, uint32_t seed, uint64_t samples,
                        struct replicates *out)
{
    struct scene scene;
    struct renderer r;
    struct err err = {0};
    const struct scene_override overrides[] = {{"form", form}, {0}};
    REQUIRE_OK(load_scene("tests/render/scenes/forms.json", overrides, &scene, &err));
    CHECK((scene.shape_count > 0) == (strcmp(form, "analytic") == 0));
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    REQUIRE_OK(replicates_render(&r, &MEASURE_4X4_TILES, seed, samples, out, &err));
    renderer_finish(&r);
    scene_finish(&scene);
}

// Any of all comparisons exceeds the limit by chance with probability 1e-3.
static void compare_forms(uint64_t samples, double half_width)
{
    static struct replicates results[2];
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    render_form(&gpu, "triangles", 1000, samples, &results[0]);
    render_form(&gpu, "analytic", 1000 + REPLICATES, samples, &results[1]);
    gpu_close(&gpu);
    uint32_t count = MEASURE_4X4_TILES.count;
    double limit = stats_t_quantile(1.0 - 0.5e-3 / count, REPLICATES - 1), worst = 0.0;
    for (uint32_t v = 0; v < count; v++) {
        struct estimate a = replicates_estimate(&results[0], v);
        struct estimate b = replicates_estimate(&results[1], v);
        double t = fabs(a.mean - b.mean) / hypot(a.standard_error, b.standard_error);
        worst = fmax(worst, t);
        CHECK(t <= limit, "value %u: %.6g and %.6g, t = %.2f of at most %.2f", v, a.mean, b.mean, t,
              limit);
        // The last value is that of the whole picture.
        if (v + 1 == count)
            CHECK(b.half_width <= half_width * b.mean, "half-width %.2g", b.half_width / b.mean);
    }
    printf("greatest t %.2f of at most %.2f\n", worst, limit);
}

TEST(agree)
{
    compare_forms(4, 0.01);
}

TEST(agree_long)
{
    compare_forms(256, 0.001);
}

TEST_MAIN(TEST_CASE(agree), TEST_CASE(agree_long))
