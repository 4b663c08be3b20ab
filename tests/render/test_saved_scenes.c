// A scene that was edited and saved gives the same picture as the scene in memory.
#define _GNU_SOURCE // nftw
#include "../base/temporary_folder.h"
#include "render_fixture.h"
#include "scene/json/scene_write.h"
#include "scene_edit_fixture.h"

// Makes the settings small, with one method; everything about surfaces, lights and cameras remains
// as edited.
static void shorten(struct settings *settings)
{
    *settings = settings_default();
    settings->width = 40;
    settings->height = 30;
    settings->spp = 2;
}

static bool same_pictures(struct gpu *gpu, const struct scene *a, const struct scene *b,
                          const char *what, struct err *err)
{
    struct arena arena = {0};
    struct film_image first, second;
    const struct renderer_params one = {.gpu = gpu, .scene = a}, other = {.gpu = gpu, .scene = b};
    bool ok = render_film(&one, 2, &arena, &first, NULL, err) &&
              render_film(&other, 2, &arena, &second, NULL, err);
    double sum = 0;
    size_t pixels = ok ? (size_t)first.width * first.height : 0;
    for (size_t i = 0; i < pixels; i++)
        sum += (double)first.mean[i][1];
    CHECK(!ok || memcmp(first.mean, second.mean, pixels * sizeof *first.mean) == 0, "%s", what);
    CHECK(!ok || sum > 0, "%s is black", what);
    arena_finish(&arena);
    return ok;
}

static bool check_scene(struct gpu *gpu, const char *path, uint64_t seed, const char *saved,
                        struct err *err)
{
    char full[512];
    const char *root = getenv("LAMPYRIS_SOURCE_ROOT");
    snprintf(full, sizeof full, "%s/%s", root ? root : ".", path);
    const struct scene_load_params load = {.path = full};
    const struct scene_load_params again = {.path = saved, .allow_outside_paths = true};
    struct random random = {seed};
    struct scene scene = {0}, before, reloaded = {0};
    struct arena arena = {0};
    if (!scene_load(&load, &scene, err) || !scene_snapshot(&arena, &scene, &before, err))
        return false;
    struct camera camera = scene.cameras[0]; // the edited camera may see nothing
    edit_at_random(&scene, &random);
    scene.cameras[0] = camera;
    scene.cameras[0].position[0] += 1.0 / 3;
    scene.cameras[0].fov_y *= 0.9;
    shorten(&scene.settings);
    const struct scene_write_params params = {
        .path = saved, .load = &load, .before = &before, .scene = &scene};
    bool ok = scene_write(&params, err) && scene_load(&again, &reloaded, err) &&
              same_pictures(gpu, &scene, &reloaded, path, err);
    scene_finish(&reloaded);
    scene_finish(&scene);
    arena_finish(&arena);
    return ok;
}

TEST(the_same_bits)
{
    static const char *const scenes[] = {"scenes/shapes.json", "scenes/profiles.json",
                                         "scenes/sky.json"};
    char folder[512];
    struct gpu gpu = {0};
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = true);
    REQUIRE(temporary_enter(folder, sizeof folder));
    for (uint64_t i = 0; i < sizeof scenes / sizeof *scenes; i++)
        CHECK(check_scene(&gpu, scenes[i], i + 1, "saved.json", &err), "%s: %s", scenes[i],
              err.msg);
    CHECK(gpu.validation_messages == 0, "%u messages", gpu.validation_messages);
    temporary_leave(folder);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(the_same_bits))
