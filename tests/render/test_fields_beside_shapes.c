// A still life of distance fields and the same of analytic shapes must give the same picture.
#include "check/replicates.h"
#include "metrics/metrics.h"
#include "render_fixture.h"

// Turns its argument into a string with a value for the scene file.
#define JSON(...) #__VA_ARGS__

// clang-format off
static const struct scene_override as_fields[] = {
    {"define.ball", JSON({"type": "sdf", "material": "glass", "field": {"type": "sphere",
     "radius": 0.4}, "transform": {"translate": [-0.45, 0.42, 0.3]}})},
    {"define.block", JSON({"type": "sdf", "material": "white", "field": {"type": "box",
     "size": [0.6, 1.2, 0.6]}, "transform": [{"translate": [0, 0.6, 0]},
     {"rotate": {"axis": [0, 1, 0], "degrees": 18}}, {"translate": [0.4, 0, -0.35]}]})},
    {"define.drum", JSON({"type": "sdf", "material": "metal", "field": {"type": "cylinder",
     "radius": 0.25, "height": 0.5}, "transform": {"translate": [0.45, 0.26, 0.5]}})},
    {0},
};
static const struct scene_override as_shapes[] = {
    {"define.ball", JSON({"type": "sphere", "material": "glass", "radius": 0.4,
     "center": [-0.45, 0.42, 0.3]})},
    {"define.block", JSON({"type": "box", "material": "white", "min": [-0.3, 0, -0.3],
     "max": [0.3, 1.2, 0.3], "transform": [{"rotate": {"axis": [0, 1, 0], "degrees": 18}},
     {"translate": [0.4, 0, -0.35]}]})},
    {"define.drum", JSON({"type": "cylinder", "material": "metal", "radius": 0.25,
     "from": [0.45, 0.01, 0.5], "to": [0.45, 0.51, 0.5]})},
    {0},
};
// clang-format on

static void render_form(struct gpu *gpu, const struct scene_override *overrides, uint32_t seed,
                        uint64_t samples, struct replicates *out)
{
    struct scene scene;
    struct renderer r;
    struct err err = {0};
    REQUIRE_OK(load_scene("tests/render/scenes/fields.json", overrides, &scene, &err));
    CHECK((scene.sdf_count == 3) == (overrides == as_fields));
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    REQUIRE_OK(replicates_render(&r, &MEASURE_4X4_TILES, seed, samples, out, &err));
    renderer_finish(&r);
    scene_finish(&scene);
}

// Any of all comparisons exceeds the limit by chance with probability 1e-3.
static void compare(uint64_t samples)
{
    static struct replicates results[2];
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    render_form(&gpu, as_shapes, 2000, samples, &results[0]);
    render_form(&gpu, as_fields, 2000 + REPLICATES, samples, &results[1]);
    gpu_close(&gpu);
    uint32_t count = MEASURE_4X4_TILES.count;
    double limit = stats_t_quantile(1.0 - 0.5e-3 / count, REPLICATES - 1), worst = 0.0;
    for (uint32_t v = 0; v < count; v++) {
        struct estimate a = replicates_estimate(&results[0], v);
        struct estimate b = replicates_estimate(&results[1], v);
        double difference = fabs(a.mean - b.mean);
        // Pixels that see only the environment have no variance.
        double t = difference > 0.0 ? difference / hypot(a.standard_error, b.standard_error) : 0.0;
        worst = fmax(worst, t);
        CHECK(t <= limit, "value %u: %.6g and %.6g, t = %.2f of at most %.2f", v, a.mean, b.mean, t,
              limit);
    }
    printf("greatest t %.2f of at most %.2f\n", worst, limit);
}

TEST(agree)
{
    compare(4);
}

TEST(agree_long)
{
    compare(256);
}

TEST_MAIN(TEST_CASE(agree), TEST_CASE(agree_long))
