// Contributions that are not finite are left out, counted by their place in the code, and can be
// followed. Loaders reject such scenes, so each test modifies one in memory.
#include "check/estimators.h"
#include "render/probe/replay.h"
#include "render_fixture.h"

#include <inttypes.h>

#define SAMPLES 4u
#define SIDE 32u // side of the pictures

// Loads a light close above a floor, as a file would describe it: a disc, whose points are chosen
// by area, so that densities per solid angle may be small.
static bool load_floor(enum light_estimator estimator, struct scene *scene, struct err *err)
{
    const struct scene_override light[] = {
        {"light", "{\"type\": \"disc\", \"material\": \"light\", \"center\": [0, 0.01, 0],"
                  " \"normal\": [0, -1, 0], \"radius\": 1}"},
        {0}};
    bool ok = load_scene("src/check/scenes/floor_light.json", light, scene, err);
    set_estimator(&scene->settings, estimator);
    return ok;
}

static struct material *material_named(struct scene *scene, const char *name)
{
    for (uint32_t i = 0; i < scene->material_count; i++)
        if (strcmp(scene->materials[i].name, name) == 0)
            return &scene->materials[i];
    abort();
}

// Checks that the film counts the omitted contributions, and that all other values are correct.
static void check_film(const struct film_image *film, uint64_t dropped)
{
    CHECK(film->dropped == dropped, "%" PRIu64 " dropped, expected %" PRIu64, film->dropped,
          dropped);
    for (size_t i = 0; i < (size_t)film->width * film->height; i++)
        for (int c = 0; c < 3; c++)
            CHECK(isfinite(film->mean[i][c]) && isfinite(film->half_a[i][c]) &&
                      isfinite(film->half_b[i][c]),
                  "pixel %zu is not finite", i);
}

// Following a recorded contribution gives a path that loses a contribution again, at the same
// bounce.
static void check_replay(struct renderer *r, uint32_t x, uint32_t y, uint64_t sample)
{
    struct arena arena = {0};
    struct replay replay;
    struct err err = {0};
    REQUIRE_OK(renderer_replay(r, x, y, sample, &arena, &replay, &err));
    CHECK(replay.dropped, "pixel %u,%u sample %" PRIu64 " is finite", x, y, sample);
    CHECK(replay.vertex_count > r->stats.nonfinite.bounce, "%u vertices", replay.vertex_count);
    arena_finish(&arena);
}

// Renders a modified scene, which must lose contributions at `site` and nowhere else.
static void check_site(struct gpu *gpu, const struct scene *scene, int site)
{
    const struct renderer_params params = {.gpu = gpu, .scene = scene};
    const struct render_call call = {.samples = SAMPLES};
    struct renderer r;
    struct arena arena = {0};
    struct film_image film;
    struct err err = {0};
    REQUIRE_OK(renderer_create(&params, &r, &err) && renderer_render(&r, &call, &err) &&
               renderer_read(&r, &arena, &film, &err));
    const struct nonfinite_stats *stats = &r.stats.nonfinite;
    for (int i = 0; i < SITE_COUNT; i++)
        CHECK((stats->count[i] > 0) == (i == site), "site %d: %" PRIu64, i, stats->count[i]);
    check_film(&film, stats->count[site]);
    REQUIRE(stats->recorded && (int)stats->site == site, "not recorded");
    check_replay(&r, stats->pixel % film.width, stats->pixel / film.width, stats->sample);
    arena_finish(&arena);
    renderer_finish(&r);
}

TEST(emission)
{
    struct scene scene;
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_floor(ESTIMATOR_BSDF, &scene, &err));
    material_named(&scene, "light")->emission[1] = INFINITY;
    check_site(&gpu, &scene, SITE_EMISSION);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// The contribution is finite until it is divided by the density of the light sample.
TEST(light_connection)
{
    struct scene scene;
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_floor(ESTIMATOR_NEE, &scene, &err));
    for (int c = 0; c < 3; c++)
        material_named(&scene, "light")->emission[c] = 3e36f;
    check_site(&gpu, &scene, SITE_SHADOW);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST(throughput)
{
    struct scene scene;
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_floor(ESTIMATOR_BSDF, &scene, &err));
    material_named(&scene, "floor")->base_color[2] = NAN;
    check_site(&gpu, &scene, SITE_THROUGHPUT);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST(environment)
{
    struct scene scene;
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_scene("src/check/scenes/sky.json", NULL, &scene, &err));
    scene.environment.radiance[0] = INFINITY;
    check_site(&gpu, &scene, SITE_MISS);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST(validation_is_silent)
{
    struct scene scene;
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = true);
    REQUIRE_OK(load_floor(ESTIMATOR_MIS, &scene, &err));
    material_named(&scene, "light")->emission[1] = INFINITY;
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
    struct renderer r;
    REQUIRE_OK(renderer_create(&params, &r, &err));
    const struct render_call call = {.samples = 1};
    REQUIRE_OK(renderer_render(&r, &call, &err));
    REQUIRE(r.stats.nonfinite.recorded, "nothing was left out");
    check_replay(&r, r.stats.nonfinite.pixel % SIDE, r.stats.nonfinite.pixel / SIDE,
                 r.stats.nonfinite.sample);
    CHECK(gpu.validation_messages == 0, "%u messages", gpu.validation_messages);
    renderer_finish(&r);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(emission), TEST_CASE(light_connection), TEST_CASE(throughput),
          TEST_CASE(environment), TEST_CASE(validation_is_silent))
