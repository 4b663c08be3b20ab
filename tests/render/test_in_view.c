// Compares the emitters found in view with how often samples hit them.
#include "render/probe/in_view.h"
#include "render_fixture.h"
#include <math.h>
#include <stdlib.h>

enum { SIDE = 24, SAMPLES = 4096 };

struct way {
    const char *name;
    const char *keys[4], *values[4]; // overrides
};

#define FOV "camera.fov_degrees"

static const struct way ways[] = {
    {"pinhole", {FOV}, {"40"}},
    {"lens", {FOV, "camera.aperture_radius_mm", "camera.focus_distance"}, {"40", "400", "9"}},
    {"gaussian", {FOV, "settings.filter"}, {"40", "gaussian"}},
    {"tent", {FOV, "settings.filter", "settings.filter_radius"}, {"40", "tent", "1.2"}},
    {"blackman-harris", {FOV, "settings.filter"}, {"40", "blackman-harris"}},
    {"panorama", {"camera.type", "film.width", "film.height"}, {"panoramic", "64", "32"}},
    {"orthographic", {"camera.type", "camera.height"}, {"orthographic", "8"}},
};

static void check_way(struct gpu *gpu, const struct way *way)
{
    struct scene_override overrides[5] = {0};
    struct scene scene;
    struct renderer renderer;
    struct arena arena = {0};
    struct film_image film;
    struct unseen_light unseen;
    struct err err = {0};
    for (int i = 0; i < 4 && way->keys[i]; i++)
        overrides[i] = (struct scene_override){way->keys[i], way->values[i]};
    REQUIRE_OK(load_scene("tests/render/scenes/in_view.json", overrides, &scene, &err));
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    const struct render_call call = {.samples = SAMPLES};
    REQUIRE_OK(renderer_create(&params, &renderer, &err) &&
               renderer_render(&renderer, &call, &err) &&
               renderer_read(&renderer, &arena, &film, &err) &&
               renderer_find_unseen(&renderer, &arena, &unseen, &err));
    uint64_t pixels = (uint64_t)film.width * film.height;
    double *parts = calloc(pixels, sizeof *parts), sum = 0, met = 0, worst = 0;
    REQUIRE(parts, "out of memory");
    for (size_t i = 0; i < unseen.small_count; i++) {
        const struct small_light *light = &unseen.small[i];
        CHECK(light->radius <= 0, "%s: spread over %g pixels", way->name, (double)light->radius);
        CHECK(fabs((double)light->radiance[0] - 1) < 0.01, "%g", (double)light->radiance[0]);
        parts[(uint64_t)light->y * film.width + light->x] += (double)light->part;
        sum += (double)light->part;
    }
    for (uint64_t i = 0; i < pixels; i++) {
        double seen = (double)film.mean[i][0];
        double deviation = sqrt(fmax(seen, 1.0 / SAMPLES) / SAMPLES);
        worst = fmax(worst, fabs(parts[i] - seen) - 4 * deviation);
        met += seen;
        CHECK(seen <= 0 || unseen.emitter_in_view[i], "%s, pixel %lu: %g, not marked", way->name,
              (unsigned long)i, seen);
    }
    printf("  %s: %zu pixels, %.4f of a pixel in all, samples meet %.4f; worst %.3f\n", way->name,
           unseen.small_count, sum, met, worst);
    CHECK(fabs(sum - met) < 0.02 * met + 4 * sqrt(met / SAMPLES),
          "%s: %g of a pixel, samples meet %g", way->name, sum, met);
    CHECK(worst < 0.025, "%s: a pixel is off by %g", way->name, worst);
    free(parts);
    arena_finish(&arena);
    renderer_finish(&renderer);
    scene_finish(&scene);
}

// Tests shapes of all kinds and a sun with each camera and filter. Occluded emitters are not among
// those found.
TEST(parts_are_what_samples_meet)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++)
        check_way(&gpu, &ways[i]);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(parts_are_what_samples_meet))
