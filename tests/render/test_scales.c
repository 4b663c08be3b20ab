// Tests scenes from 1e-12 m to 1e12 m: the same bits in units that differ by a power of two, small
// solid lamps, and the limits of single precision. src/check/forms_scales.c has the closed forms.
#include "base/log.h"
#include "check/closed_form.h"
#include "check/scaled_scene.h"
#include "render/probe/replay.h"
#include "render_fixture.h"
#include "shared/aov.h"
#include <math.h>

// --- units ---------------------------------------------------------------------------------------

#define MOST_UNITS 5

// A scene in several units of length, each 2^exponent metres; the list ends with 0. The film has
// the same bits in all units; depths and positions are in metres.
struct units {
    const char *path;
    int exponents[MOST_UNITS];
    enum instancing instancing;
};

static bool same_bits(const struct film_image *a, const struct film_image *b)
{
    size_t bytes = (size_t)a->width * a->height * sizeof *a->mean;
    return memcmp(a->mean, b->mean, bytes) == 0 && memcmp(a->half_a, b->half_a, bytes) == 0 &&
           memcmp(a->half_b, b->half_b, bytes) == 0;
}

// If all pixels were black, equal pictures would prove nothing.
static bool is_lit(const struct film_image *film)
{
    for (size_t i = 0; i < (size_t)film->width * film->height; i++)
        if (film->mean[i][0] > 0.0f)
            return true;
    return false;
}

static size_t other_places(const struct film_image *a, const struct film_image *b, int exponent)
{
    size_t others = 0;
    for (size_t i = 0; i < (size_t)a->width * a->height; i++) {
        others += ldexpf(a->aovs.depth[i], exponent) != b->aovs.depth[i];
        for (int c = 0; c < 3; c++)
            others += ldexpf(a->aovs.position[i][c], exponent) != b->aovs.position[i][c];
    }
    return others;
}

static void render_in_unit(struct gpu *gpu, const struct units *units, int exponent,
                           struct arena *arena, struct film_image *film)
{
    const struct scene_override small[] = {{"film.width", "32"}, {"film.height", "24"}, {0}};
    struct scene scene;
    struct err err = {0};
    REQUIRE_OK(load_scene(units->path, small, &scene, &err));
    scale_scene(&scene, ldexp(1.0, exponent));
    const struct renderer_params params = {
        .gpu = gpu,
        .scene = &scene,
        .instancing = units->instancing,
        .aovs = AOV_DEPTH | AOV_POSITION,
    };
    REQUIRE_OK(render_film(&params, 4, arena, film, NULL, &err));
    scene_finish(&scene);
}

static void check_units(struct gpu *gpu, const struct units *units)
{
    struct arena arena = {0};
    struct film_image first, film;
    render_in_unit(gpu, units, 0, &arena, &first);
    for (int i = 0; i < MOST_UNITS && units->exponents[i] != 0; i++) {
        int exponent = units->exponents[i];
        render_in_unit(gpu, units, exponent, &arena, &film);
        size_t others = other_places(&first, &film, exponent);
        CHECK(is_lit(&first) && same_bits(&first, &film), "%s times 2^%d: another picture",
              units->path, exponent);
        CHECK(others == 0, "%s times 2^%d: %zu other depths and coordinates", units->path, exponent,
              others);
    }
    arena_finish(&arena);
}

static void check_all_units(const struct units *units, size_t count)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (size_t i = 0; i < count; i++)
        check_units(&gpu, &units[i]);
    gpu_close(&gpu);
}

TEST(units)
{
    static const struct units units[] = {
        {"src/check/scenes/all_lengths.json", {-40, 40}},
        {"scenes/all_classes.json", {-40, 40}, INSTANCING_ON},
    };
    check_all_units(units, sizeof units / sizeof units[0]);
}

TEST(units_long)
{
    static const struct units units[] = {
        {"src/check/scenes/all_lengths.json", {-40, -20, -1, 24, 40}},
        {"src/check/scenes/alpha_shadow.json", {-40, 24, 40}},
        {"tests/render/scenes/aovs.json", {-30, 24, 30}},
        {"scenes/all_classes.json", {-40, -24, 24, 40}},
        {"scenes/cornell.json", {-40, 24, 40}},
        {"scenes/glow_worms.json", {-40, 24, 36}},
        {"scenes/profiles.json", {-40, 24, 40}},
        {"scenes/shapes.json", {-40, 24, 40}},
        {"scenes/sdf_csg.json", {-40, 24, 40}},
        {"scenes/glass.json", {-40, 24, 40}},
        {"scenes/all_classes.json", {-24, 24}, INSTANCING_ON},
    };
    check_all_units(units, sizeof units / sizeof units[0]);
}

// --- solid lamps ---------------------------------------------------------------------------------

// A box of side a with radiance le / a^2, seen from the middle of the floor, at (2, 1, 0) or (-49,
// 30, 49): its near faces occlude the far ones. The relative error of its light is at most
// `tolerance`, four standard deviations.
struct solid_lamp {
    const char *name;
    struct scene_override overrides[4];
    double place[3];
    double tolerance;
};

#define BOX(...)                                                                                   \
    {                                                                                              \
        "lamp", JSON({"type" : "box", "material" : "lamp", __VA_ARGS__})                           \
    }
// Overrides select a floor of 10 m and a lamp beside it.
#define WALL(corner, u, v)                                                                         \
    "{\"type\": \"quad\", \"material\": \"lamp\", \"corner\": " corner ", \"u\": " u ", \"v\": " v \
    "}"
#define WALLS(a, x, y)                                                                             \
    WALL("[2, 1, 0]", "[0, " a ", 0]", "[0, 0, " a "]")                                            \
    "," WALL("[" x ", 1, 0]", "[0, " a ", 0]", "[0, 0, " a "]") "," WALL(                          \
        "[2, 1, 0]", "[" a ", 0, 0]", "[0, " a ", 0]") "," WALL("[2, 1, " a "]", "[" a ", 0, 0]",  \
                                                                "[0, " a ", 0]")
#define LIDS(a, y)                                                                                 \
    "," WALL("[2, 1, 0]", "[" a ", 0, 0]",                                                         \
             "[0, 0, " a "]") "," WALL("[2, " y ", 0]", "[" a ", 0, 0]", "[0, 0, " a "]")
#define ON_FLOOR(walls)                                                                            \
    {                                                                                              \
        "shapes", "[{\"type\": \"quad\", \"material\": \"floor\", \"corner\": [-5, 0, 5], \"u\": " \
                  "[10, 0, 0], \"v\": [0, 0, -10]}," walls "]"                                     \
    }
#define NO_LAMP                                                                                    \
    {                                                                                              \
        "lamp", "0"                                                                                \
    }

// clang-format off
static const struct solid_lamp solid_lamps[] = {
    {"box of 1e-5 m",
     {BOX("min": [2, 1, 0], "max": [2.00001, 1.00001, 1e-5]), {"emission", "[1e10, 2e10, 4e10]"}},
     {2, 1, 0}, 0.01},
    {"box of 1e-6 m",
     {BOX("min": [2, 1, 0], "max": [2.000001, 1.000001, 1e-6]), {"emission", "[1e12, 2e12, 4e12]"}},
     {2, 1, 0}, 0.01},
    {"box of 1e-8 m",
     {BOX("min": [2, 1, 0], "max": [2.00000001, 1.00000001, 1e-8]),
      {"emission", "[1e16, 2e16, 4e16]"}},
     {2, 1, 0}, 0.01},
    {"box of 1e-3 m, at 75 m",
     {{"shapes[0]", JSON({"type": "quad", "material": "floor", "corner": [-50, 0, 50],
                          "u": [100, 0, 0], "v": [0, 0, -100]})},
      BOX("min": [-49, 30, 49], "max": [-48.999, 30.001, 49.001]),
      {"emission", "[1e6, 2e6, 4e6]"}},
     {-49, 30, 49}, 0.01},
    {"six quads of 1e-5 m",
     {ON_FLOOR(WALLS("1e-5", "2.00001", "1.00001") LIDS("1e-5", "1.00001")), NO_LAMP,
      {"emission", "[1e10, 2e10, 4e10]"}},
     {2, 1, 0}, 0.01},
    {"six quads of 1e-8 m",
     {ON_FLOOR(WALLS("1e-8", "2.00000001", "1.00000001") LIDS("1e-8", "1.00000001")), NO_LAMP,
      {"emission", "[1e16, 2e16, 4e16]"}},
     {2, 1, 0}, 0.01},
    // Its corners are exact in single precision, but those of the occluding objects are not.
    {"box of 2^-21 m",
     {BOX("min": [2, 1, 0], "max": [2.000000476837158203125, 1.000000476837158203125, 4.76837158203125e-7]),
      {"emission", "[4398046511104, 8796093022208, 17592186044416]"}},
     {2, 1, 0}, 0.01},
    // The walls of a square tube are visible through its ends, because nothing is visible through
    // both.
    {"an open tube of 1e-6 m",
     {ON_FLOOR(WALLS("1e-6", "2.000001", "1.000001")), NO_LAMP,
      {"emission", "[1e12, 2e12, 4e12]"}},
     {2, 1, 0}, 0.01},
};
// clang-format on

// Returns the red light, (albedo / pi) cos (projected area / a^2) / d^2.
static double light_of_box(const double place[3])
{
    double square = 0, projected = 0;
    for (int i = 0; i < 3; i++) {
        square += place[i] * place[i];
        projected += fabs(place[i]);
    }
    return closed_form_albedo[0] / M_PI * place[1] * projected / (square * square);
}

static double mean_red(const struct film_image *film)
{
    size_t pixels = (size_t)film->width * film->height;
    double sum = 0;
    for (size_t i = 0; i < pixels; i++)
        sum += (double)film->mean[i][0];
    return sum / (double)pixels;
}

static void check_solid_lamp(struct gpu *gpu, const struct solid_lamp *lamp)
{
    struct arena arena = {0};
    struct film_image film;
    struct scene scene;
    struct err err = {0};
    REQUIRE_OK(load_scene("src/check/scenes/small_lamp.json", lamp->overrides, &scene, &err));
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    REQUIRE_OK(render_film(&params, 256, &arena, &film, NULL, &err));
    double ratio = mean_red(&film) / light_of_box(lamp->place);
    CHECK(fabs(ratio - 1) <= lamp->tolerance, "%s: %g of its light", lamp->name, ratio);
    scene_finish(&scene);
    arena_finish(&arena);
}

TEST(solid_lamps)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (size_t i = 0; i < sizeof solid_lamps / sizeof solid_lamps[0]; i++)
        check_solid_lamp(&gpu, &solid_lamps[i]);
    gpu_close(&gpu);
}

// --- what is beyond ------------------------------------------------------------------------------

static char warning[1024];

static void keep_warning(void *context, enum log_level level, const char *message)
{
    (void)context;
    if (level == LOG_WARN)
        snprintf(warning, sizeof warning, "%s", message);
}

// Scenes beyond single precision are reported with their numbers, by an error or a warning.
struct beyond {
    struct scene_override override;
    const char *error, *warning;
};

#define SEEN_FROM(z, degrees)                                                                      \
    {                                                                                              \
        "camera",                                                                                  \
            JSON({"position" : [ 0, 0, z ], "direction" : [ 0, 0, -1 ], "fov_degrees" : degrees})  \
    }

static const struct beyond beyonds[] = {
    {SEEN_FROM(1e17, 1), "camera.position[2]: 1e+17 is outside [-1e+13, 1e+13]", NULL},
    {SEEN_FROM(1e8, 40), NULL, "3.4641 m across and 1e+08 m away, and covers 7.6e-07 pixels"},
    {SEEN_FROM(100, 1e-6), NULL, "a pixel is 1.1e-09 radians wide"},
    {{"shapes", JSON([ {"type" : "sphere", "material" : "light", "radius" : 1e-14} ])},
     "far.json: the scene is 2e-14 m across; expected 1e-13 m to 2e+13 m",
     NULL},
    {{"shapes", JSON([ {"type" : "sphere", "material" : "light", "radius" : 1e14} ])},
     "shapes[0].radius: 1e+14 is outside [1e-18, 1e+13]",
     NULL},
    {{"lights",
      JSON([ {"type" : "point", "position" : [ 0, 1e14, 0 ], "intensity" : [ 1, 1, 1 ]} ])},
     "lights[0].position[1]: 1e+14 is outside [-1e+13, 1e+13]",
     NULL},
};

static void check_beyond(struct gpu *gpu, const struct beyond *beyond)
{
    const struct scene_override overrides[] = {beyond->override, {0}};
    struct scene scene;
    struct renderer renderer = {0};
    struct err err = {0};
    warning[0] = '\0';
    bool ok = load_scene("src/check/scenes/far.json", overrides, &scene, &err);
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    bool is_made = ok && renderer_create(&params, &renderer, &err);
    if (beyond->error)
        CHECK(!is_made && err.code == ERR_INPUT && strstr(err.msg, beyond->error), "%s", err.msg);
    else
        CHECK(is_made && strstr(warning, beyond->warning), "%s%s", err.msg, warning);
    renderer_finish(&renderer);
    if (ok)
        scene_finish(&scene);
}

TEST(what_is_beyond_is_told)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    log_configure(LOG_WARN, keep_warning, NULL);
    for (size_t i = 0; i < sizeof beyonds / sizeof beyonds[0]; i++)
        check_beyond(&gpu, &beyonds[i]);
    log_configure(LOG_WARN, NULL, NULL);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(units), TEST_CASE(solid_lamps), TEST_CASE(what_is_beyond_is_told),
          TEST_CASE(units_long))
