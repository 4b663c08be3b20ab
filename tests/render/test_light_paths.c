// Light paths (--integrator bidir) give the same picture as camera paths alone, as a whole and in 4
// x 4 tiles, by 64 replicates each. So do light paths alone if they find all light. The bits are
// the same however the work is divided.
#include "check/replicates.h"
#include "metrics/metrics.h"
#include "render_fixture.h"

#include "alone_shade_light.spv.h"
#include "alone_shade_miss.spv.h"
#include "alone_shade_surface.spv.h"
#include <math.h>
#include <string.h>

#define TILES 17

struct picture {
    const char *name, *scene;
    struct scene_override overrides[12]; // up to the first one without a key
    void (*prepare)(struct scene *scene);
    uint64_t samples;
    double half_width; // greatest half-width for the mean of the whole picture
};

// Compiled with LIGHT_PATHS_ALONE: camera paths contribute only what light paths cannot.
static const struct kernel_set light_paths_alone = {
    .codes = {
        [KERNEL_shade_surface] = {"shade_surface", alone_shade_surface_spirv,
                                  sizeof alone_shade_surface_spirv},
        [KERNEL_shade_miss] = {"shade_miss", alone_shade_miss_spirv, sizeof alone_shade_miss_spirv},
        [KERNEL_shade_light] = {"shade_light", alone_shade_light_spirv,
                                sizeof alone_shade_light_spirv},
    }};

static void render_picture(struct gpu *gpu, const struct picture *p, uint32_t integrator,
                           const struct kernel_set *kernels, uint64_t samples, uint32_t first_seed,
                           struct replicates *out)
{
    struct scene scene;
    struct renderer r;
    struct err err = {0};
    REQUIRE_OK(load_scene(p->scene, p->overrides, &scene, &err));
    if (p->prepare)
        p->prepare(&scene);
    scene.settings.integrator = integrator;
    const struct renderer_params params = {
        .gpu = gpu, .scene = &scene, .merge_classes = kernels != NULL, .kernels = kernels};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    REQUIRE_OK(replicates_render(&r, &MEASURE_4X4_TILES, first_seed, samples, out, &err));
    renderer_finish(&r);
    scene_finish(&scene);
}

// Returns the |t| that any of all comparisons exceeds by chance with probability 1e-3. Welch's
// degrees of freedom are at least those of one picture.
static double t_limit(uint32_t pictures)
{
    return stats_t_quantile(1.0 - 0.5e-3 / (pictures * TILES), REPLICATES - 1);
}

static void compare(const struct picture *p, const char *way, const struct replicates *a,
                    const struct replicates *b, double limit)
{
    double worst = 0.0;
    for (uint32_t v = 0; v < TILES; v++) {
        struct estimate x = replicates_estimate(a, v), y = replicates_estimate(b, v);
        double error = hypot(x.standard_error, y.standard_error);
        double t = error > 0.0 ? fabs(x.mean - y.mean) / error : x.mean == y.mean ? 0.0 : INFINITY;
        if (t > 3.0)
            printf("%s, %s, value %u: %.6g +-%.2g and %.6g +-%.2g, t %.2f\n", p->name, way, v,
                   x.mean, x.half_width, y.mean, y.half_width, t);
        worst = fmax(worst, t);
    }
    struct estimate x = replicates_estimate(a, TILES - 1), y = replicates_estimate(b, TILES - 1);
    printf("%s, %s: mean %.6g +-%.2g %% and %.6g +-%.2g %%, greatest t %.2f\n", p->name, way,
           x.mean, 100 * x.half_width / x.mean, y.mean, 100 * y.half_width / y.mean, worst);
    CHECK(worst <= limit, "%s, %s: t = %.2f, limit %.2f", p->name, way, worst, limit);
    CHECK(x.half_width <= p->half_width * x.mean && y.half_width <= p->half_width * y.mean,
          "%s, %s: half-widths %.3g, %.3g of at most %.3g", p->name, way, x.half_width / x.mean,
          y.half_width / y.mean, p->half_width);
}

static void check_pictures(const struct picture *pictures, uint32_t count, bool alone)
{
    static struct replicates by_path, by_both, by_light;
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (uint32_t i = 0; i < count; i++) {
        const struct picture *p = &pictures[i];
        uint32_t seed = 3000 * i;
        double limit = t_limit(alone ? 2 * count : count);
        render_picture(&gpu, p, INTEGRATOR_PATH, NULL, 4 * p->samples, seed, &by_path);
        render_picture(&gpu, p, INTEGRATOR_BIDIR, NULL, p->samples, seed + 1000, &by_both);
        compare(p, "both", &by_path, &by_both, limit);
        if (!alone)
            continue;
        render_picture(&gpu, p, INTEGRATOR_BIDIR, &light_paths_alone, 4 * p->samples, seed + 2000,
                       &by_light);
        compare(p, "light paths", &by_path, &by_light, limit);
    }
    gpu_close(&gpu);
}

// Adds an environment with a bright horizon and a brighter patch.
static void add_surroundings(struct scene *scene)
{
    static float texels[8][3] = {{0.3f, 0.4f, 0.8f}, {0.3f, 0.4f, 0.8f}, {4.0f, 3.0f, 2.0f},
                                 {0.3f, 0.4f, 0.8f}, {0.1f, 0.1f, 0.1f}, {0.2f, 0.2f, 0.1f},
                                 {0.1f, 0.1f, 0.1f}, {0.1f, 0.1f, 0.1f}};
    scene->environment = (struct environment){
        .present = true, .radiance = {1, 1, 1}, .width = 4, .height = 2, .texels = texels};
}

#define METHODS "tests/render/scenes/methods.json"
#define LIGHTS "tests/render/scenes/lights.json"
#define FOCUS "tests/render/scenes/focus.json"
#define SMALL                                                                                      \
    {"film.width", "16"},                                                                          \
    {                                                                                              \
        "film.height", "16"                                                                        \
    }

TEST(lamps)
{
    static const struct picture pictures[] = {
        {"box", "scenes/cornell.json", {SMALL}, NULL, 16, 0.015},
        {"lights of all kinds", LIGHTS, {SMALL}, NULL, 16, 0.02},
        {"lights and an image", LIGHTS, {SMALL}, add_surroundings, 16, 0.02},
    };
    check_pictures(pictures, sizeof pictures / sizeof *pictures, true);
}

TEST(surfaces)
{
    static const struct picture pictures[] = {
        {"surfaces", METHODS, {SMALL}, NULL, 16, 0.02},
        {"surfaces, balance", METHODS, {SMALL, {"settings.mis", "\"balance\""}}, NULL, 16, 0.02},
        {"surfaces and an image", METHODS, {SMALL}, add_surroundings, 16, 0.02},
        // Without the spot and the point light: what smooth glass and mirrors focus of these is
        // found by light paths alone.
        {"every class",
         "scenes/all_classes.json",
         {SMALL, {"settings.max_bounces", "6"}, {"lights", "[]"}},
         NULL,
         64,
         0.05},
    };
    check_pictures(pictures, sizeof pictures / sizeof *pictures, false);
}

#define CAMERA(...)                                                                                \
    {                                                                                              \
        "camera", #__VA_ARGS__                                                                     \
    }

TEST(cameras)
{
    static const struct picture pictures[] = {
        {"lens",
         LIGHTS,
         {SMALL, CAMERA({
              "position" : [ 0, 3, 7 ],
              "target" : [ 0, 0.8, 0 ],
              "fov_degrees" : 45,
              "aperture_radius" : 0.3,
              "blades" : 5,
              "focus_distance" : 5
          })},
         NULL,
         16,
         0.02},
        {"orthographic",
         LIGHTS,
         {SMALL, CAMERA({
              "type" : "orthographic",
              "position" : [ 0, 3, 7 ],
              "target" : [ 0, 0.8, 0 ],
              "height" : 4
          })},
         NULL,
         16,
         0.02},
        {"panorama",
         LIGHTS,
         {SMALL,
          CAMERA({"type" : "panoramic", "position" : [ 0.2, 2, 1.5 ], "target" : [ 0, 0.8, 0 ]})},
         NULL,
         16,
         0.03},
        {"far",
         LIGHTS,
         {SMALL,
          CAMERA(
              {"position" : [ 0, 30000, 70000 ], "target" : [ 0, 0.8, 0 ], "fov_degrees" : 0.004})},
         NULL,
         16,
         0.02},
        {"tent", LIGHTS, {SMALL, {"settings.filter", "\"tent\""}}, NULL, 16, 0.02},
        {"gaussian", LIGHTS, {SMALL, {"settings.filter", "\"gaussian\""}}, NULL, 16, 0.02},
        {"blackman-harris",
         LIGHTS,
         {SMALL, {"settings.filter", "\"blackman-harris\""}},
         NULL,
         16,
         0.02},
    };
    check_pictures(pictures, sizeof pictures / sizeof *pictures, true);
}

// Rough glass and metal below a lamp that camera paths find, too; nested media; shading normals
// that differ strongly from the geometric ones; a sun; lamps of each shape; cut-outs, textures and
// dispersion.
TEST(focus)
{
    static const struct picture pictures[] = {
        {"focus", FOCUS, {SMALL}, NULL, 16, 0.02},
        {"focus, an image", FOCUS, {SMALL}, add_surroundings, 16, 0.02},
        {"focus, without scaling",
         FOCUS,
         {SMALL, {"settings.radiance_scaling", "false"}},
         NULL,
         16,
         0.02},
        {"focus, normals by D", FOCUS, {SMALL, {"settings.normals", "\"ndf\""}}, NULL, 16, 0.03},
    };
    check_pictures(pictures, sizeof pictures / sizeof *pictures, false);
}

struct refusal {
    struct scene_override overrides[3];
    uint32_t aovs;
    bool tiles;
    const char *words; // NULL: the scene is not refused
};

// Scenes that light paths do not support are refused with a message; similar ones that they support
// are not.
TEST(refusals)
{
    static const struct refusal refusals[] = {
        {{{"settings.nee", "false"}}, 0, false, "vertices without shadow rays"},
        {{{"settings.nee_depth", "2"}}, 0, false, "vertices without shadow rays"},
        {{{"settings.nee_depth", "3"}}, 0, false, NULL},
        {{{"settings.mis", "\"none\""}}, 0, false, "--mis none"},
        {{{"settings.light_choice", "\"tree\""}}, 0, false, "--light-choice"},
        {{{"settings.light_choice", "\"power\""}}, 0, false, NULL},
        {{{"settings.directions", "\"cosine\""}}, 0, false, "--directions bsdf"},
        {{{"settings.clamp", "3"}}, 0, false, "--clamp"},
        {{{"settings.min_density", "0.1"}}, 0, false, "--min-density"},
        {{{"settings.split_lobes", "1"}}, 0, false, "--split-lobes"},
        {{{"settings.film_accumulation", "\"sum\""}}, 0, false, "--accumulation"},
        {{{"settings.pixel_jitter", "false"}}, 0, false, "fixed points of pixels"},
        {{{"settings.pixel_sampling", "\"grid\""}}, 0, false, "fixed points of pixels"},
        {{{"settings.pixel_sampling", "\"stratified\""}}, 0, false, NULL},
        {{CAMERA({"type" : "panoramic", "position" : [ 0, 2, 1 ], "target" : [ 0, 0, 0 ]}),
          {"settings.filter", "\"tent\""}},
         0,
         false,
         "panoramic camera"},
        {{{"settings.seed", "1"}}, 0, true, "--adaptive"},
        {{{"settings.seed", "1"}}, AOV_DIRECT, false, "--error-by"},
        {{{"settings.seed", "1"}}, AOV_BY_BOUNCE, false, "--error-by"},
        {{{"settings.seed", "1"}}, AOV_ALBEDO | AOV_DEPTH, false, NULL},
        {{{"lights.0.range", "5"}}, 0, false, "has a range of 5 m"},
        {{{"materials.plastic", "{\"type\": \"dielectric\"}"}}, 0, false, NULL},
        {{{"materials.floor", "{\"type\": \"dielectric\"}"},
          {"shapes.0", "{\"type\": \"sphere\", \"material\": \"floor\", \"center\": [2, 1, 0], "
                       "\"radius\": 1}"}},
         0,
         false,
         "a lamp intersects the bounding box of shape 0"},
        {{{"settings.filter_radius", "0.25"}}, 0, false, "a filter narrower than a pixel"},
        {{{"shapes.0", "{\"type\": \"plane\", \"material\": \"floor\", \"normal\": [0, 1, 0]}"}},
         0,
         false,
         "an infinite plane"},
    };
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
        const struct refusal *refusal = &refusals[i];
        struct scene scene;
        struct renderer r;
        struct err err = {0};
        REQUIRE_OK(load_scene(LIGHTS, refusal->overrides, &scene, &err));
        scene.settings.integrator = INTEGRATOR_BIDIR;
        const struct renderer_params params = {
            .gpu = &gpu, .scene = &scene, .aovs = refusal->aovs, .tiles = refusal->tiles};
        bool ok = renderer_prepare(&params, &r, &err);
        CHECK(ok == !refusal->words, "%zu: %s", i, ok ? "not refused" : err.msg);
        if (!ok && refusal->words)
            CHECK(err.code == ERR_INPUT && strstr(err.msg, refusal->words), "%zu: %s", i, err.msg);
        if (ok)
            renderer_finish(&r);
        scene_finish(&scene);
    }
    gpu_close(&gpu);
}

TEST(validated)
{
    static const char *const scenes[] = {LIGHTS, FOCUS};
    const struct scene_override small[] = {SMALL, {0}};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        struct scene scene;
        struct gpu gpu;
        struct arena arena = {0};
        struct film_image film;
        struct err err = {0};
        OPEN_GPU(&gpu, .validation = true, .limits = {.storage_range = 1u << 15});
        REQUIRE_OK(load_scene(scenes[i], small, &scene, &err));
        scene.settings.integrator = INTEGRATOR_BIDIR;
        const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
        REQUIRE_OK(render_film(&params, 3, &arena, &film, NULL, &err));
        CHECK(gpu.validation_messages == 0, "%u messages", gpu.validation_messages);
        arena_finish(&arena);
        scene_finish(&scene);
        gpu_close(&gpu);
    }
}

TEST_MAIN(TEST_CASE(lamps), TEST_CASE(surfaces), TEST_CASE(cameras), TEST_CASE(focus),
          TEST_CASE(refusals), TEST_CASE(validated))
