// The following must not change any bit of a picture: the size of waves, the division of samples
// among calls, features that the scene lacks, ways of reading and reserving memory, and lower
// limits of the device.
#include "check/bits.h"
#include "check/scaled_scene.h"
#include "render/probe/replay.h"
#include "render_fixture.h"
#include <math.h>
#include <string.h>

// Counts pixels that are not black: if all were black, equal pictures would prove nothing.
static size_t lit_pixels(const struct film_image *film)
{
    size_t lit = 0;
    for (size_t i = 0; i < (size_t)film->width * film->height; i++)
        lit += film->mean[i][0] > 0.0f || film->mean[i][1] > 0.0f || film->mean[i][2] > 0.0f;
    return lit;
}

// 64 KiB of triangles.
static bool fits_smallest_buffers(const struct scene *scene)
{
    uint64_t triangles = 0;
    for (uint32_t m = 0; m < scene->mesh_count; m++)
        triangles += scene->meshes[m].triangle_count;
    return triangles * sizeof(struct gpu_triangle) <= 1u << 16;
}

static void check_scene(struct gpu *gpu, struct scene *scene, const char *name, bool all)
{
    const struct bits_variant plain = {"plain", {0}};
    struct arena arena = {0};
    struct film_image expected, film;
    struct err err = {0};
    REQUIRE_OK(bits_render(gpu, scene, &plain, &arena, &expected, &err));
    size_t pixels = (size_t)expected.width * expected.height;
    CHECK(lit_pixels(&expected) > pixels / 2, "%s is dark", name);
    CHECK(expected.least_samples == BITS_SAMPLES && expected.most_samples == BITS_SAMPLES,
          "%s: wrong number of samples", name);
    bool large = !fits_smallest_buffers(scene);
    for (size_t i = 0; i < bits_variant_count; i++) {
        const struct gpu_limit_overrides *limits = &bits_variants[i].limits;
        if ((large && (limits->storage_range || limits->allocation)) ||
            !(all || bits_variants[i].representative))
            continue;
        CHECK(bits_render(gpu, scene, &bits_variants[i], &arena, &film, &err), "%s, %s: %s", name,
              bits_variants[i].name, err.msg);
        if (err.code == ERR_NONE)
            CHECK(bits_are_same(&film, &expected), "%s, %s: different", name,
                  bits_variants[i].name);
        err = (struct err){0};
    }
    scene->settings.seed++;
    REQUIRE_OK(bits_render(gpu, scene, &plain, &arena, &film, &err));
    CHECK(!bits_are_same(&film, &expected), "%s: another seed gives the same picture", name);
    arena_finish(&arena);
}

static void check_file(const char *path, const char *max_bounces, struct scene_override setting,
                       bool all)
{
    const struct scene_override small[] = {{"film.width", "48"},
                                           {"film.height", "32"},
                                           {"settings.max_bounces", max_bounces},
                                           setting,
                                           {0}};
    struct scene scene;
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_scene(path, small, &scene, &err));
    check_scene(&gpu, &scene, path, all);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// Tests camera paths, with or without splitting.
static void check_paths(const char *path, const char *split_lobes, bool all)
{
    check_file(path, "6", (struct scene_override){"settings.split_lobes", split_lobes}, all);
}

TEST(cornell)
{
    check_paths("scenes/cornell.json", "0", true);
}

// all_classes.json has every class of surfaces, media, and lights of every kind.
static const char *const further_scenes[] = {
    "scenes/glow_worms.json",
    "scenes/furnace.json",
    "scenes/furnace_sky.json",
    "scenes/all_classes.json",
};

static void check_further_scenes(bool all)
{
    for (size_t i = 0; i < sizeof further_scenes / sizeof further_scenes[0]; i++)
        check_paths(further_scenes[i], "0", all);
}

// Light paths add to pixels of any wave and of any buffer of the film.
static void check_light_paths(const char *path)
{
    check_file(path, "4", (struct scene_override){"settings.integrator", "\"bidir\""}, false);
}

TEST(light_paths)
{
    check_light_paths("scenes/cornell.json");
}

TEST(light_paths_long)
{
    check_light_paths("tests/render/scenes/focus.json");
    check_light_paths("scenes/all_classes.json");
}

// Lobes share the weights of Schlick's curve. A lobe that the scene lacks must not change how those
// of the coat are rounded.
TEST(clearcoat)
{
    static const struct bits_variant plain = {"plain", {0}},
                                     all = {"all", {0}, .compile_all = true};
    const struct scene_override small[] = {{"film.width", "64"}, {"film.height", "24"}, {0}};
    struct film_image expected, film;
    struct arena arena = {0};
    struct scene scene;
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_scene("scenes/materials_clearcoat.json", small, &scene, &err));
    REQUIRE_OK(bits_render(&gpu, &scene, &plain, &arena, &expected, &err));
    REQUIRE_OK(bits_render(&gpu, &scene, &all, &arena, &film, &err));
    CHECK(bits_are_same(&film, &expected), "features that the scene lacks change it");
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// There are up to eight slots per sample; the long form compiles all features.
TEST(split_lobes)
{
    static const struct bits_variant plain = {"plain", {0}}, others[] = {
                                                                 {"waves of 352", {0}, .wave = 352},
                                                                 {"split 13 + 10 + 9",
                                                                  {.no_texel = true},
                                                                  .wave = 1u << 10,
                                                                  .first_calls = {13, 10}},
                                                             };
    const struct scene_override split[] = {
        {"film.width", "48"}, {"film.height", "32"}, {"settings.split_lobes", "3"}, {0}};
    struct film_image expected, film;
    struct arena arena = {0};
    struct scene scene;
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_scene("scenes/phong_lobes.json", split, &scene, &err));
    REQUIRE_OK(bits_render(&gpu, &scene, &plain, &arena, &expected, &err));
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        REQUIRE_OK(bits_render(&gpu, &scene, &others[i], &arena, &film, &err));
        CHECK(bits_are_same(&film, &expected), "%s: different", others[i].name);
    }
    scene.settings.split_lobes = 0;
    REQUIRE_OK(bits_render(&gpu, &scene, &plain, &arena, &film, &err));
    CHECK(!bits_are_same(&film, &expected), "nothing is split");
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// A replay describes a path by its vertices in sequence, which a path that splits does not have.
TEST(split_paths_are_not_replayed)
{
    const struct scene_override split[] = {
        {"film.width", "8"}, {"film.height", "8"}, {"settings.split_lobes", "1"}, {0}};
    struct renderer r = {0};
    struct arena arena = {0};
    struct replay replay;
    struct scene scene;
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_scene("scenes/phong_lobes.json", split, &scene, &err));
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    CHECK(!renderer_replay(&r, 4, 4, 0, &arena, &replay, &err), "it is replayed");
    CHECK(err.code == ERR_INPUT && strstr(err.msg, "expected --split-lobes 0"), "%s", err.msg);
    renderer_finish(&r);
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST(split_lobes_long)
{
    check_paths("scenes/all_classes.json", "3", true);
}

TEST(further_scenes)
{
    check_further_scenes(false);
}

TEST(further_scenes_long)
{
    check_further_scenes(true);
}

// Tests shading normals under an environment image whose texels are all different.
static void check_normals_and_environment_image(bool all)
{
    enum { WIDTH = 16, HEIGHT = 8 };
    struct scene scene;
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_scene("tests/render/scenes/blob.json", NULL, &scene, &err));
    struct environment *environment = &scene.environment;
    environment->width = WIDTH;
    environment->height = HEIGHT;
    environment->texels = arena_alloc(&scene.arena, WIDTH * HEIGHT, sizeof *environment->texels);
    REQUIRE(environment->texels, "out of memory");
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
        for (uint32_t c = 0; c < 3; c++)
            environment->texels[i][c] = 0.01f * (float)(1 + (i * 7 + c * 31) % 101);
    check_scene(&gpu, &scene, "blob", all);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST(normals_and_environment_image)
{
    check_normals_and_environment_image(false);
}

TEST(normals_and_environment_image_long)
{
    check_normals_and_environment_image(true);
}

// Tests this number of threads, which a device may not support. Also simulates a device that can
// dispatch only few workgroups at a time, so that work must be divided.
static void check_workgroup(struct gpu *gpu, const struct scene *scene, uint32_t workgroup,
                            struct arena *arena, const struct film_image *expected)
{
    const struct renderer_params params = {
        .gpu = gpu, .scene = scene, .wave = 4096, .workgroup = workgroup};
    struct film_image film;
    struct err err = {0};
    if (workgroup > gpu->max_invocations)
        return;
    bool ok = render_film(&params, BITS_SAMPLES, arena, &film, NULL, &err);
    CHECK(ok, "workgroups of %u: %s", workgroup, err.msg);
    CHECK(!ok || bits_are_same(&film, expected),
          "workgroups of %u, ballot %d, %u groups: different", workgroup, gpu->has_ballot,
          gpu->max_groups);
}

static void check_workgroups(const char *path, const uint32_t *sizes, size_t count)
{
    const struct scene_override small[] = {
        {"film.width", "32"}, {"film.height", "24"}, {"settings.max_bounces", "6"}, {0}};
    const struct gpu_params without_ballot = {.limits = {.no_ballot = true, .no_texel = true}};
    struct arena arena = {0};
    struct scene scene;
    struct gpu gpu, plain;
    struct film_image expected;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(gpu_open(&without_ballot, &plain, &err));
    REQUIRE_OK(load_scene(path, small, &scene, &err));
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
    REQUIRE_OK(render_film(&params, BITS_SAMPLES, &arena, &expected, NULL, &err));
    CHECK(lit_pixels(&expected) > 32 * 24 / 2, "%s is dark", path);
    for (size_t i = 0; i < count; i++) {
        check_workgroup(&gpu, &scene, sizes[i], &arena, &expected);
        check_workgroup(&plain, &scene, sizes[i], &arena, &expected);
    }
    gpu.max_groups = 32;
    check_workgroup(&gpu, &scene, 8, &arena, &expected);
    scene_finish(&scene);
    gpu_close(&plain);
    gpu_close(&gpu);
    arena_finish(&arena);
}

TEST(workgroups)
{
    check_workgroups("scenes/glow_worms.json", (const uint32_t[]){8, 16, 32, 64, 256, 1024}, 6);
}

TEST(workgroups_of_all_classes)
{
    check_workgroups("scenes/all_classes.json", (const uint32_t[]){8}, 1);
}

// Changes the size of waves in the middle of a picture, the last time with suspended traversals. A
// size that is not possible is lowered without an error.
TEST(resized)
{
    static const struct {
        uint32_t wave, workgroup;
    } sizes[] = {{1u << 13, 32}, {352, 8}, {1u << 24, 256}, {1u << 10, 8}};
    const uint32_t rounds = sizeof sizes / sizeof sizes[0];
    const struct gpu_params low = {.limits = {.storage_range = 1u << 20}};
    const struct scene_override small[] = {{"film.width", "48"}, {"film.height", "32"}, {0}};
    struct arena arena = {0};
    struct scene scene;
    struct gpu gpu;
    struct renderer renderer;
    struct film_image expected, film;
    struct err err = {0};
    OPEN_GPU(&gpu, .limits = low.limits);
    REQUIRE_OK(load_scene("scenes/cornell.json", small, &scene, &err));
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
    REQUIRE_OK(render_film(&params, 5 * rounds, &arena, &expected, NULL, &err));
    REQUIRE_OK(renderer_create(&params, &renderer, &err));
    for (uint32_t i = 0; i < rounds; i++) {
        if (i == rounds - 1)
            renderer.specialization.iteration_budget = 8;
        REQUIRE_OK(renderer_resize(&renderer, sizes[i].wave, sizes[i].workgroup, &err));
        uint32_t slots = renderer.plan.wave_slots;
        CHECK(sizes[i].wave <= 1u << 13
                  ? slots == sizes[i].wave / sizes[i].workgroup * sizes[i].workgroup
                  : slots < sizes[i].wave,
              "a wave of %u paths is one of %u", sizes[i].wave, slots);
        const struct render_call call = {.samples = 5};
        REQUIRE_OK(renderer_render(&renderer, &call, &err));
    }
    CHECK(renderer.stats.suspended > 0, "no traversal was suspended");
    CHECK(!renderer_resize(&renderer, 1024, 48, &err) && err.code == ERR_USAGE, "48 threads");
    err = (struct err){0};
    REQUIRE_OK(renderer_read(&renderer, &arena, &film, &err));
    CHECK(bits_are_same(&film, &expected), "different");
    renderer_finish(&renderer);
    scene_finish(&scene);
    gpu_close(&gpu);
    arena_finish(&arena);
}

// The picture is large enough to fill a wave of 2^20 paths.
TEST(waves_of_a_large_picture)
{
    static const uint32_t waves[] = {1u << 10, 1u << 14, 1u << 20};
    const struct scene_override size[] = {{"film.width", "256"}, {"film.height", "256"}, {0}};
    struct scene scene;
    struct gpu gpu;
    struct arena arena = {0};
    struct film_image films[3];
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_scene("scenes/cornell.json", size, &scene, &err));
    for (int i = 0; i < 3; i++) {
        const struct renderer_params params = {.gpu = &gpu, .scene = &scene, .wave = waves[i]};
        struct render_stats stats;
        REQUIRE_OK(render_film(&params, 17, &arena, &films[i], &stats, &err));
        uint64_t full = (UINT64_C(1) << 20) / waves[i], last = full / 16 ? full / 16 : 1;
        // Limits may reduce the size of a wave.
        uint64_t bytes = waves[i] * sizeof(struct gpu_path);
        bool fits = bytes <= gpu.max_storage_range && bytes <= gpu.max_texel_elements * 16;
        CHECK(!fits || stats.waves == full + last, "%u paths: %u waves", waves[i],
              (unsigned)stats.waves);
        CHECK(bits_are_same(&films[i], &films[0]), "%u paths", waves[i]);
    }
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
}

static uint64_t all_hits(const struct render_stats *stats)
{
    uint64_t sum = 0;
    for (uint32_t c = 0; c < CLASS_COUNT; c++)
        sum += stats->surface_hits[c];
    return sum;
}

// Surfaces sorted by class, or shaded by one kernel, give the same bits and the same total of hits.
TEST(classes)
{
    const struct scene_override small[] = {{"film.width", "48"}, {"film.height", "32"}, {0}};
    struct scene scene;
    struct gpu gpu;
    struct arena arena = {0};
    struct film_image films[2];
    struct render_stats stats[2];
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_scene("scenes/all_classes.json", small, &scene, &err));
    for (int merged = 0; merged < 2; merged++) {
        const struct renderer_params params = {
            .gpu = &gpu, .scene = &scene, .merge_classes = merged != 0};
        REQUIRE_OK(render_film(&params, 8, &arena, &films[merged], &stats[merged], &err));
    }
    size_t size = (size_t)films[0].width * films[0].height * sizeof *films[0].half_a;
    CHECK(memcmp(films[0].half_a, films[1].half_a, size) == 0 &&
              memcmp(films[0].half_b, films[1].half_b, size) == 0,
          "classes change the picture's bits");
    for (uint32_t c = 0; c < CLASS_COUNT; c++) {
        CHECK(stats[0].surface_hits[c] > 0, "class %u is not hit", c);
        CHECK(stats[0].kernels[KERNEL_shade_diffuse + c].launches > 0 &&
                  stats[1].kernels[KERNEL_shade_diffuse + c].launches == 0,
              "class %u: wrong kernel", c);
    }
    CHECK(stats[0].kernels[KERNEL_shade_surface].launches == 0 &&
              stats[1].kernels[KERNEL_shade_surface].launches > 0,
          "the kernel of all classes");
    CHECK(all_hits(&stats[0]) == all_hits(&stats[1]) &&
              stats[1].surface_hits[0] == all_hits(&stats[1]),
          "%llu hits by class, %llu in all", (unsigned long long)all_hits(&stats[0]),
          (unsigned long long)all_hits(&stats[1]));
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// Radiance does not depend on the unit of length, nor do rounding errors that are relative. 2^20 is
// about the 1e6 of docs/verification.md, C1.
static void check_scales(const char *path)
{
    static const int exponents[] = {0, -20, 20};
    const struct scene_override small[] = {{"film.width", "64"}, {"film.height", "48"}, {0}};
    struct gpu gpu;
    struct arena arena = {0};
    struct film_image films[3];
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    for (int i = 0; i < 3; i++) {
        struct scene scene;
        REQUIRE_OK(load_scene(path, small, &scene, &err));
        scale_scene(&scene, ldexp(1.0, exponents[i]));
        const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
        REQUIRE_OK(render_film(&params, 16, &arena, &films[i], NULL, &err));
        CHECK(bits_are_same(&films[i], &films[0]), "%s scaled by 2^%d", path, exponents[i]);
        scene_finish(&scene);
    }
    arena_finish(&arena);
    gpu_close(&gpu);
}

TEST(scales)
{
    check_scales("scenes/cornell.json");
    check_scales("scenes/glow_worms.json");
    check_scales("tests/render/scenes/blob.json");
}

TEST(validation_is_silent)
{
    const struct scene_override size[] = {{"film.width", "32"}, {"film.height", "32"}, {0}};
    struct scene scene;
    struct gpu gpu;
    struct arena arena = {0};
    struct film_image film;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = true, .limits = {.storage_range = 1u << 15});
    REQUIRE_OK(load_scene("scenes/glow_worms.json", size, &scene, &err));
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene, .compile_all = true};
    REQUIRE_OK(render_film(&params, 3, &arena, &film, NULL, &err));
    CHECK(gpu.validation_messages == 0, "%u messages", gpu.validation_messages);
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(cornell), TEST_CASE(further_scenes), TEST_CASE(clearcoat),
          TEST_CASE(light_paths), TEST_CASE(split_lobes), TEST_CASE(split_paths_are_not_replayed),
          TEST_CASE(normals_and_environment_image), TEST_CASE(waves_of_a_large_picture),
          TEST_CASE(scales), TEST_CASE(classes), TEST_CASE(workgroups),
          TEST_CASE(workgroups_of_all_classes), TEST_CASE(resized), TEST_CASE(validation_is_silent),
          TEST_CASE(further_scenes_long), TEST_CASE(normals_and_environment_image_long),
          TEST_CASE(split_lobes_long), TEST_CASE(light_paths_long))
