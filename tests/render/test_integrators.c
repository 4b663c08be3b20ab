// Tests other integrators: settings that must not change a bit of their pictures, where shadows
// end, and Whitted's model against path tracing where both are the same.
#include "render_fixture.h"
#include <math.h>

struct variant {
    const char *name;
    struct gpu_limit_overrides limits;
    uint32_t wave;
    bool compile_all;
};

static const struct variant variants[] = {
    {"waves of 2^10", {0}, .wave = 1u << 10},
    {"waves of 2^14", {0}, .wave = 1u << 14},
    {"with all features", {0}, .compile_all = true},
    {"without texel buffers and ballot", {.no_texel = true, .no_ballot = true}},
};

static bool render(const char *path, const struct scene_override *overrides,
                   const struct variant *variant, uint64_t samples, struct arena *arena,
                   struct film_image *film, struct err *err)
{
    const struct gpu_params gpu_params = {.limits = variant->limits};
    struct scene scene;
    struct gpu gpu;
    if (!load_scene(path, overrides, &scene, err))
        return false;
    bool ok = gpu_open(&gpu_params, &gpu, err);
    if (ok) {
        const struct renderer_params params = {.gpu = &gpu,
                                               .scene = &scene,
                                               .wave = variant->wave,
                                               .compile_all = variant->compile_all};
        ok = render_film(&params, samples, arena, film, NULL, err);
        gpu_close(&gpu);
    }
    scene_finish(&scene);
    return ok;
}

static void check_bits(const char *path, const struct scene_override *overrides)
{
    struct arena arena = {0};
    struct film_image first, other;
    struct err err = {0};
    const struct variant plain = {0};
    REQUIRE_OK(render(path, overrides, &plain, 4, &arena, &first, &err));
    double sum = 0;
    for (size_t i = 0; i < (size_t)first.width * first.height; i++)
        sum += first.mean[i][0];
    CHECK(sum > 0, "%s is black", path);
    for (size_t i = 0; i < sizeof variants / sizeof variants[0]; i++) {
        REQUIRE_OK(render(path, overrides, &variants[i], 4, &arena, &other, &err));
        CHECK(memcmp(first.mean, other.mean,
                     (size_t)first.width * first.height * sizeof *first.mean) == 0,
              "%s: other bits %s", path, variants[i].name);
    }
    arena_finish(&arena);
}

static void need_gpu(void)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    gpu_close(&gpu);
}

#define SMALL                                                                                      \
    {                                                                                              \
        "film", "{\"width\": 24, \"height\": 16}"                                                  \
    }

TEST(whitted_keeps_bits)
{
    need_gpu();
    check_bits("scenes/glass.json", (const struct scene_override[]){
                                        SMALL,
                                        {"settings.integrator", "whitted"},
                                        {"settings.max_bounces", "9"},
                                        {NULL, NULL},
                                    });
}

TEST(ao_keeps_bits)
{
    need_gpu();
    check_bits("scenes/classical.json",
               (const struct scene_override[]){SMALL, {"settings.integrator", "ao"}, {NULL, NULL}});
}

// A disc of radius 0.5 is half-way between a lamp at height 2 and a floor, so its shadow has radius
// 1. The camera looks straight down from beside the disc. Pixels near the shadow's edge, whose side
// single precision decides, are left out.
TEST(shadows_are_hard)
{
    struct arena arena = {0};
    struct film_image film;
    struct err err = {0};
    const struct variant plain = {0};
    const struct scene_override overrides[] = {
        {"settings.integrator", "whitted"},
        {"light", "{\"type\":\"point\",\"position\":[0,2,0],\"intensity\":[1,1,1]}"},
        {"camera.position", "[0, 0.5, 0]"},
        {"shapes", "[{\"type\":\"quad\",\"material\":\"floor\",\"corner\":[-4,0,4],\"u\":[8,0,0],"
                   "\"v\":[0,0,-8]},{\"type\":\"disc\",\"material\":\"floor\",\"center\":[0,1,0],"
                   "\"normal\":[0,1,0],\"radius\":0.5}]"},
        {NULL, NULL},
    };
    need_gpu();
    REQUIRE_OK(render("tests/render/scenes/floor_profile.json", overrides, &plain, 1, &arena, &film,
                      &err));
    uint32_t lit = 0, dark = 0;
    for (int y = 0; y < 32; y++) {
        for (int x = 0; x < 32; x++) {
            double at[2] = {(x + 0.5) / 8 - 2, (y + 0.5) / 8 - 2}, r = hypot(at[0], at[1]);
            double d2 = r * r + 4, value = film.mean[y * 32 + x][0];
            double expected = 0.5 / M_PI * 2 / (d2 * sqrt(d2));
            if (fabs(r - 1) < 1e-5)
                continue;
            CHECK(r < 1 ? value == 0 : fabs(value / expected - 1) < 1e-6,
                  "pixel %d %d: %.9g, expected %.9g", x, y, value, r < 1 ? 0 : expected);
            lit += r > 1;
            dark += r < 1;
        }
    }
    CHECK(lit > 100 && dark > 100, "%u lit, %u dark", lit, dark);
    arena_finish(&arena);
}

// With delta lights, Lambertian and Phong surfaces and one scattering event, the picture equals
// that of path tracing.
TEST(whitted_is_direct_light)
{
    struct arena arena = {0};
    struct film_image whitted, path;
    struct err err = {0};
    const struct variant plain = {0};
    struct scene_override overrides[] = {
        {"settings.integrator", "whitted"},
        {"light", "{\"type\":\"spot\",\"position\":[1,2,0.5],\"direction\":[-1,-2,0],"
                  "\"intensity\":[3,2,1]}"},
        {"materials.floor", "{\"type\":\"phong\",\"base_color\":[0.5,0.4,0.3],"
                            "\"specular_color\":[0.3,0.3,0.3],\"exponent\":20}"},
        {NULL, NULL},
    };
    need_gpu();
    REQUIRE_OK(render("tests/render/scenes/floor_profile.json", overrides, &plain, 1, &arena,
                      &whitted, &err));
    overrides[0].value = "direct";
    REQUIRE_OK(render("tests/render/scenes/floor_profile.json", overrides, &plain, 1, &arena, &path,
                      &err));
    double worst = 0, brightest = 0;
    for (int i = 0; i < 32 * 32; i++) {
        worst = fmax(worst, fabs(whitted.mean[i][0] - path.mean[i][0]));
        brightest = fmax(brightest, path.mean[i][0]);
    }
    printf("  off by %.1e of the brightest pixel\n", worst / brightest);
    CHECK(brightest > 0 && worst <= 1e-6 * brightest, "off by %.3g of %.3g", worst, brightest);
    arena_finish(&arena);
}

TEST(trees_have_a_limit)
{
    struct arena arena = {0};
    struct film_image film;
    struct err err = {0};
    const struct variant plain = {0};
    need_gpu();
    bool ok = render("scenes/glass.json",
                     (const struct scene_override[]){SMALL,
                                                     {"settings.integrator", "whitted"},
                                                     {"settings.max_bounces", "65"},
                                                     {NULL, NULL}},
                     &plain, 1, &arena, &film, &err);
    CHECK(!ok && err.code == ERR_INPUT && strstr(err.msg, "64"), "%s", ok ? "rendered" : err.msg);
    arena_finish(&arena);
}

TEST_MAIN(TEST_CASE(whitted_keeps_bits), TEST_CASE(ao_keeps_bits), TEST_CASE(shadows_are_hard),
          TEST_CASE(whitted_is_direct_light), TEST_CASE(trees_have_a_limit))
