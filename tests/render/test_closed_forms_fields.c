// Distance fields in scenes whose radiance is known, and beside analytic shapes of the same form:
// closed rooms of fields, convex bodies under an even sky, glass and fog, a still life of both.
#include "closed_form.h"
#include "metrics/metrics.h"
#include "replicates.h"

// A convex body sees nothing but the environment.
static double convex(double rho, double le, double unused)
{
    (void)unused;
    return rho * le;
}

// Every ray meets a wall: the first `bounces` + 1 terms of a geometric series.
static double closed(double rho, double le, double bounces)
{
    return le * (1.0 - pow(rho, bounces + 1.0)) / (1.0 - rho);
}

// From within glass of an index whose square is `part`.
static double all(double rho, double le, double part)
{
    (void)rho;
    return part * le;
}

// Through as much fog of an index of 1 as lets rho pass in a metre.
static double fog(double rho, double le, double metres)
{
    return le * pow(rho, metres);
}

// A camera inside of a field that glows.
// clang-format off
#define ROOM(x, y, z, ...)                                                                         \
    {"camera", JSON({"position": [x, y, z], "direction": [0.3, -0.2, -1], "fov_degrees": 90})},    \
    {"shapes", "[{\"type\": \"sdf\", \"material\": \"glowing\", " JSON(__VA_ARGS__) "}]"},         \
    {"settings", JSON({"max_bounces": 2})}
#define ROOM_FILE OURS "sphere_furnace.json"
#define BODY(...)                                                                                  \
    {"camera", JSON({"position": [0, 2, 0], "target": [0, 0, -3], "fov_degrees": 5})},             \
    {"environment", JSON({"radiance": [1, 2, 4]})},                                                \
    {"shapes", "[{\"type\": \"sdf\", \"material\": \"plane\", " JSON(__VA_ARGS__) "}]"}
#define BODY_FILE OURS "plane.json"
#define MEDIUM(...) {"bodies", "[{\"type\": \"sdf\", \"material\": \"body\", " JSON(__VA_ARGS__) "}]"}
#define MEDIUM_FILE OURS "media.json"

static const struct closed_form forms[] = {
    {"3 field sphere", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {ROOM(0.3, -0.2, 0.4, "field": {"type": "sphere", "radius": 1})}},
    {"C1 field sphere of 1e-6", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {ROOM(3e-7, -2e-7, 4e-7, "field": {"type": "sphere", "radius": 1e-6})}},
    {"C1 field sphere of 1e6", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {ROOM(3e5, -2e5, 4e5, "field": {"type": "sphere", "radius": 1e6})}},
    {"C2 field sphere at 1e5", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {ROOM(100000.3, 99999.8, -99999.6, "field": {"type": "sphere", "radius": 1},
           "transform": {"translate": [1e5, 1e5, -1e5]})}},
    {"3 field box, turned and mirrored", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {ROOM(0.3, -0.2, 0.4, "field": {"type": "box", "size": [1, 1.5, 1.2]}, "transform":
           [{"scale": [2, -2, 2]}, {"rotate": {"axis": [1, 2, 3], "degrees": 40}}])}},
    {"3 field of smooth joints", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {ROOM(0.3, -0.2, 0.4, "field": {"type": "union", "smooth": 0.3, "of": [
           {"type": "sphere", "radius": 1}, {"type": "torus", "radius": 1, "tube": 0.5},
           {"type": "capsule", "from": [0, -2, 0], "to": [0, 2, 0], "radius": 0.5}]})}},
    {"3 field twisted", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {ROOM(0.3, -0.2, 0.4, "field": {"type": "twist", "degrees": 60, "of":
           {"type": "box", "size": [1.6, 2, 1.6], "round": 0.2}})}},
    {"3 metaballs", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {ROOM(0.1, -0.1, 0.1, "field": {"type": "metaballs", "balls": [[0, 0, 0, 1],
           [0.6, 0, 0, 1], [0, 0.7, 0.2, 0.8]]})}},
    {"2 field sphere under a sky", BODY_FILE, convex, 0, BY_STATISTICS, EACH_ALONE,
     {BODY("field": {"type": "sphere", "radius": 50}, "transform": {"translate": [0, -50, 0]})}},
    {"2 field plane under a sky", BODY_FILE, convex, 0, BY_STATISTICS, EACH_ALONE,
     {BODY("field": {"type": "plane", "normal": [0, 1, 0]},
           "bounds": {"min": [-9, -1, -9], "max": [9, 1, 9]})}},
    {"21 camera in a field of glass", MEDIUM_FILE, all, 2.25, WITHOUT_VARIANCE, 0,
     {{"body", JSON({"type": "dielectric", "ior": 1.5})}, {"from", "[0.2, 0.1, 0.1]"},
      {"towards", "[1, 0, 0]"}, {"fov", "20"},
      MEDIUM("field": {"type": "box", "size": [1, 1, 1]}, "transform": {"scale": 2})}},
    {"19 ball of fog", MEDIUM_FILE, fog, 2, WITHOUT_VARIANCE, 0,
     {{"body", JSON({"type": "dielectric", "ior": 1, "absorption": {"color": [0.8, 0.5, 0.2],
      "distance": 1}})}, {"fov", "1e-5"}, MEDIUM("field": {"type": "sphere", "radius": 1})}},
};
// clang-format on

#define COUNT(forms) (sizeof(forms) / sizeof(forms)[0])

TEST(by_default)
{
    closed_forms_by_default(forms, COUNT(forms), 76000);
}

TEST(by_every_estimator)
{
    closed_forms_by_every_estimator(forms, COUNT(forms), 88000);
}

TEST(validation_is_silent)
{
    closed_forms_validated(forms, COUNT(forms));
}

// --- beside analytic shapes ----------------------------------------------------------------------

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
    REQUIRE_OK(load_scene(OURS "fields.json", overrides, &scene, &err));
    CHECK((scene.sdf_count == 3) == (overrides == as_fields));
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    REQUIRE_OK(replicates_render(&r, &MEASURE_4X4_TILES, seed, samples, out, &err));
    renderer_finish(&r);
    scene_finish(&scene);
}

// What one of all comparisons exceeds by chance with probability 1e-3.
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
        // Where only the environment is seen there is no variance.
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

TEST_MAIN(TEST_CASE(by_default), TEST_CASE(by_every_estimator), TEST_CASE(validation_is_silent),
          TEST_CASE(agree), TEST_CASE(agree_long))
