// Tests the sources of the error: closed forms of its parts, and the brightest contributions
// against those of all paths of their pixels.
#include "job/job.h"
#include "render/probe/replay.h"
#include "render_fixture.h"
#include "shared/aov.h"

#include <math.h>
#include <string.h>

#define ALL AOVS_BY

static const struct scene_override small[] = {{"film", "{\"width\": 16, \"height\": 16}"}, {0}};

// Renders `samples` per pixel with a job and estimates the error.
static bool run(struct job *job, struct gpu *gpu, struct scene *scene, uint32_t aovs,
                uint64_t samples, struct err *err)
{
    const struct job_params params = {
        .renderer = {.gpu = gpu, .aovs = aovs},
        .scene = scene,
        .goal = {.samples = samples},
    };
    return job_start(&params, job, err) && job_run(job, err) && job_judge_end(job, err);
}

static bool is_near(double value, double expected, double tolerance)
{
    return fabs(value - expected) <= tolerance;
}

// --- closed forms --------------------------------------------------------------------------------

// If only a lamp is visible, all light and all error is visible emission.
TEST(emission_alone)
{
    struct gpu gpu;
    struct scene scene;
    struct job job;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = true);
    REQUIRE_OK(load_scene("tests/render/scenes/lone_lamp.json", NULL, &scene, &err));
    REQUIRE_OK(run(&job, &gpu, &scene, ALL, 16, &err));
    const uint32_t first[] = {0, 0, BY_EMITTER_SHAPES};
    CHECK(!job.sources.reason && job.sources.has_intervals);
    for (int kind = 0; kind < ERROR_KIND_COUNT; kind++) {
        const struct error_by *by = &job.sources.by[kind];
        CHECK(by->error > 0.0 && by->together.error == 0.0, "%s", error_kind_names[kind]);
        for (uint32_t k = 0; k < by->count; k++) {
            double expected = k == first[kind] ? 1.0 : 0.0;
            CHECK(is_near(by->classes[k].share.value, expected, 1e-12) &&
                      is_near(by->light[k], expected, 1e-12),
                  "%s %u: %g of the error, %g of the light", error_kind_names[kind], k,
                  by->classes[k].share.value, by->light[k]);
        }
    }
    CHECK(job.sources.brightest_count == BRIGHT_PATHS_MAX, "%u", job.sources.brightest_count);
    for (uint32_t i = 0; i < job.sources.brightest_count; i++) {
        const struct bright_path *path = &job.sources.brightest[i];
        CHECK(path->scattering_events == 0 && path->emitter == BY_EMITTER_SHAPES &&
                  !path->is_connection && path->radiance[0] == 4.0f && path->radiance[2] == 2.0f,
              "%u", i);
    }
    job_finish(&job);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// Without shadow rays, every path in a closed furnace contributes .5 * .5^n after n scattering
// events, in any pixel. All bounces have light, and none has an error.
TEST(furnace_by_bounce)
{
    static const struct scene_override overrides[] = {{"film", "{\"width\": 16, \"height\": 16}"},
                                                      {"settings.max_bounces", "9"},
                                                      {"settings.nee", "false"},
                                                      {0}};
    struct gpu gpu;
    struct scene scene;
    struct job job;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = false);
    REQUIRE_OK(load_scene("scenes/furnace.json", overrides, &scene, &err));
    REQUIRE_OK(run(&job, &gpu, &scene, ALL, 4, &err));
    const struct error_by *bounce = &job.sources.by[ERROR_BY_BOUNCE];
    const struct error_by *part = &job.sources.by[ERROR_BY_PART];
    const double whole = 1.0 - pow(0.5, 10.0);
    for (int n = 0; n < 7; n++)
        CHECK(is_near(bounce->light[n], pow(0.5, n + 1) / whole, 1e-5), "bounce %d: %.9g", n,
              bounce->light[n]);
    CHECK(is_near(bounce->light[7], (pow(0.5, 7.0) - pow(0.5, 10.0)) / whole, 1e-5), "later: %.9g",
          bounce->light[7]);
    CHECK(is_near(part->light[0], 0.5 / whole, 1e-5) &&
              is_near(part->light[1], 0.25 / whole, 1e-5) &&
              is_near(part->light[2], (0.25 - pow(0.5, 10.0)) / whole, 1e-5),
          "parts of %g, %g and %g", part->light[0], part->light[1], part->light[2]);
    CHECK(bounce->error < 1e-10, "an error of %g", bounce->error);
    job_finish(&job);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// A sample connects to one of two lights that contribute 2 and 1. So it has 4 or 2, with the
// variance (2 - 1)^2. The contribution of each light alone is twice its light or nothing, with
// variances of 2^2 and 1^2, and twice their covariance is -2 * 2 * 1.
TEST(one_of_two_lights)
{
    enum { SAMPLES = 16 };
    struct gpu gpu;
    struct scene scene;
    struct job job;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = false);
    REQUIRE_OK(load_scene("tests/render/scenes/two_lights.json", NULL, &scene, &err));
    REQUIRE_OK(run(&job, &gpu, &scene, ALL, SAMPLES, &err));
    const struct error_by *by = &job.sources.by[ERROR_BY_EMITTER];
    const struct error_by *part = &job.sources.by[ERROR_BY_PART];
    const struct error_share *lamp = &by->classes[BY_EMITTER_LIGHTS],
                             *sun = &by->classes[BY_EMITTER_SUNS];
    // The expected error is the mean over 1024 pixels, each with one degree of freedom. The mean
    // radiance is 3.
    const double unit = 1.0 / SAMPLES / (9.0 + METRICS_RELMSE_EPSILON);
    printf("  error %.4g, expected %.4g; shares %.6f %.6f %.6f\n", by->error, unit,
           lamp->share.value, sun->share.value, by->together.share.value);
    CHECK(is_near(by->error, unit, 6.0 * sqrt(2.0 / 1024.0) * unit));
    CHECK(is_near(lamp->share.value, 4.0, 1e-4) && is_near(sun->share.value, 1.0, 1e-4) &&
          is_near(by->together.share.value, -4.0, 1e-4));
    CHECK(is_near(lamp->error + sun->error + by->together.error, by->error, 1e-12));
    CHECK(is_near(by->light[BY_EMITTER_LIGHTS], 2.0 / 3.0, 0.02), "%g",
          by->light[BY_EMITTER_LIGHTS]);
    CHECK(is_near(part->classes[1].share.value, 1.0, 1e-12) && part->together.error == 0.0);
    CHECK(is_near(by->error, job.error.local_relmse, 1e-6 * by->error), "%g, but %g in all",
          by->error, job.error.local_relmse);
    job_finish(&job);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// --- kinds of emitters ---------------------------------------------------------------------------

static void mean_light(const struct film_image *film, double out[BY_EMITTER_COUNT], double *whole)
{
    uint64_t pixels = (uint64_t)film->width * film->height;
    memset(out, 0, BY_EMITTER_COUNT * sizeof *out);
    *whole = 0.0;
    for (uint64_t i = 0; i < pixels; i++) {
        *whole += ((double)film->half_a[i][1] + (double)film->half_b[i][1]) / 2;
        for (uint32_t k = 0; k < BY_EMITTER_COUNT; k++) {
            uint64_t at = i * BY_EMITTER_COUNT + k;
            out[k] += ((double)film->aovs.class_a[at][1] + (double)film->aovs.class_b[at][1]) / 2;
        }
    }
}

static bool render_lights(struct gpu *gpu, const struct scene_override *overrides,
                          double light[BY_EMITTER_COUNT], double *whole, struct err *err)
{
    struct scene scene;
    struct arena arena = {0};
    struct film_image film;
    if (!load_scene("tests/render/scenes/lights.json", overrides, &scene, err))
        return false;
    scene.settings.light_choice = LIGHT_CHOICE_ALL;
    const struct renderer_params params = {.gpu = gpu, .scene = &scene, .aovs = AOV_BY_EMITTER};
    bool ok = render_film(&params, 64, &arena, &film, NULL, err);
    if (ok)
        mean_light(&film, light, whole);
    arena_finish(&arena);
    scene_finish(&scene);
    return ok;
}

// Each kind of emitter contributes the same together with others as alone, and a scene with one
// kind has only that kind.
TEST(emitters_add_up)
{
#define DARK                                                                                       \
    {"materials.warm.emission", "[0, 0, 0]"},                                                      \
    {                                                                                              \
        "materials.cold.emission", "[0, 0, 0]"                                                     \
    }
#define NO_SKY                                                                                     \
    {                                                                                              \
        "environment", "{\"type\": \"constant\", \"radiance\": [0, 0, 0]}"                         \
    }
#define NO_LIGHTS                                                                                  \
    {                                                                                              \
        "lights", "[]"                                                                             \
    }
    static const struct {
        uint32_t class;
        struct scene_override overrides[5];
    } cases[] = {
        {BY_EMITTER_SHAPES, {NO_SKY, NO_LIGHTS}},
        {BY_EMITTER_ENVIRONMENT, {DARK, NO_LIGHTS}},
        {BY_EMITTER_LIGHTS,
         {DARK,
          NO_SKY,
          {"lights", "[{\"type\": \"point\", \"position\": [-2, 1.5, 1], \"intensity\": [1, 1, "
                     "0.8]}, {\"type\": \"spot\", \"position\": [2.5, 2.5, 1.5], \"target\": [1, "
                     "0, 0], \"intensity\": [6, 4, 4], \"inner_degrees\": 10, \"outer_degrees\": "
                     "35}, {\"type\": \"directional\", \"direction\": [1, -3, -1], "
                     "\"irradiance\": [0.2, 0.2, 0.4]}]"}}},
        {BY_EMITTER_SUNS,
         {DARK,
          NO_SKY,
          {"lights", "[{\"type\": \"directional\", \"direction\": [-2, -3, -1], \"irradiance\": "
                     "[0.5, 0.4, 0.3], \"angular_diameter_degrees\": 20}]"}}},
    };
    struct gpu gpu;
    struct err err = {0};
    double together[BY_EMITTER_COUNT], whole, sum = 0.0;
    OPEN_GPU(&gpu, .validation = false);
    REQUIRE_OK(render_lights(&gpu, NULL, together, &whole, &err));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double alone[BY_EMITTER_COUNT], all;
        uint32_t class = cases[i].class;
        REQUIRE_OK(render_lights(&gpu, cases[i].overrides, alone, &all, &err));
        printf("  %-13s %.4f of the light, alone %.4f\n", error_class_name(ERROR_BY_EMITTER, class),
               together[class] / whole, alone[class] / whole);
        // The lamps are shapes and triangles.
        if (class == BY_EMITTER_SHAPES)
            all -= alone[BY_EMITTER_TRIANGLES];
        CHECK(is_near(alone[class], all, 1e-5 * all), "%s: others have light",
              error_class_name(ERROR_BY_EMITTER, class));
        CHECK(is_near(together[class], alone[class], 0.03 * alone[class]), "%s",
              error_class_name(ERROR_BY_EMITTER, class));
        sum += together[class];
    }
    sum += together[BY_EMITTER_TRIANGLES];
    CHECK(together[BY_EMITTER_TRIANGLES] > 0.0 && is_near(sum, whole, 1e-5 * whole), "%g of %g",
          sum, whole);
    gpu_close(&gpu);
}

// --- the brightest contributions -----------------------------------------------------------------

static double luminance(const float radiance[3])
{
    return 0.2126 * (double)radiance[0] + 0.7152 * (double)radiance[1] +
           0.0722 * (double)radiance[2];
}

// Replaces `best` if the contribution is brighter.
static void offer(struct film_brightest *best, const float radiance[3], uint32_t events,
                  uint32_t site, uint32_t sample)
{
    if (luminance(radiance) <= luminance(best->radiance))
        return;
    memcpy(best->radiance, radiance, sizeof best->radiance);
    best->origin = BRIGHTEST_ORIGIN(events, site, 0u);
    best->sample = sample;
}

static void offer_path(struct film_brightest *best, const struct replay *path, uint32_t sample)
{
    for (uint32_t v = 0; v < path->vertex_count; v++) {
        const struct replay_vertex *vertex = &path->vertices[v];
        offer(best, vertex->gained, vertex->bounce, SITE_EMISSION, sample);
        for (uint32_t i = 0; i < vertex->light_count; i++)
            if (!vertex->lights[i].occluded)
                offer(best, vertex->lights[i].radiance, vertex->bounce + 1, SITE_SHADOW, sample);
    }
}

// Follows all paths of a small image. A replay computes each contribution as a difference of sums,
// which have rounding errors.
TEST(brightest_of_all_paths)
{
    enum { SIDE = 5, SAMPLES = 6 };
    static const struct scene_override overrides[] = {
        {"film", "{\"width\": 5, \"height\": 5}"}, {"settings.light_choice", "power"}, {0}};
    struct gpu gpu;
    struct scene scene;
    struct job job;
    struct arena arena = {0};
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = false);
    REQUIRE_OK(load_scene("tests/render/scenes/lights.json", overrides, &scene, &err));
    REQUIRE_OK(run(&job, &gpu, &scene, AOV_BY_PART, SAMPLES, &err));
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        struct film_brightest best = {0};
        const struct film_brightest *found = &job.film.aovs.brightest[i];
        for (uint32_t sample = 0; sample < SAMPLES; sample++) {
            struct replay path;
            REQUIRE_OK(job_replay(&job, i % SIDE, i / SIDE, sample, &arena, &path, &err));
            offer_path(&best, &path, sample);
        }
        bool is_connection =
            (best.origin >> BRIGHTEST_SITE_SHIFT & BRIGHTEST_FIELD_MASK) == SITE_SHADOW;
        uint32_t site = found->origin >> BRIGHTEST_SITE_SHIFT & BRIGHTEST_FIELD_MASK;
        CHECK(best.sample == found->sample &&
                  ((best.origin ^ found->origin) & BRIGHTEST_BOUNCE_MASK) == 0 &&
                  (site == SITE_SHADOW) == is_connection,
              "pixel %u: sample %u, but %u by its paths", i, found->sample, best.sample);
        for (int c = 0; c < 3; c++)
            CHECK(is_near((double)found->radiance[c], (double)best.radiance[c],
                          is_connection ? 0.0 : 1e-5 * (double)best.radiance[c] + 1e-6),
                  "pixel %u: %.9g, but %.9g by its path", i, (double)found->radiance[c],
                  (double)best.radiance[c]);
    }
    arena_finish(&arena);
    job_finish(&job);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// --- what may not matter -------------------------------------------------------------------------

struct variant {
    const char *name;
    struct gpu_limit_overrides limits;
    uint32_t wave, aovs, first_call;
    bool compile_all;
};

enum { SAMPLES = 20 };

static bool render_variant(const struct scene *scene, const struct variant *v, struct arena *arena,
                           struct film_image *film, struct err *err)
{
    struct gpu gpu;
    struct renderer r;
    if (!gpu_open(&(struct gpu_params){.limits = v->limits}, &gpu, err))
        return false;
    const struct renderer_params params = {.gpu = &gpu,
                                           .scene = scene,
                                           .aovs = v->aovs,
                                           .wave = v->wave,
                                           .compile_all = v->compile_all};
    bool ok = renderer_create(&params, &r, err);
    if (ok) {
        const struct render_call first = {.samples = v->first_call},
                                 last = {.samples = SAMPLES - v->first_call};
        ok = renderer_render(&r, &first, err) && renderer_render(&r, &last, err) &&
             renderer_read(&r, arena, film, err);
        renderer_finish(&r);
    }
    gpu_close(&gpu);
    return ok;
}

// The image has the same bits with and without this option, and the results do not depend on
// anything that the image does not depend on. If paths split, all branches count.
TEST(same_bits)
{
    static const struct variant variants[] = {
        {"as it is", {0}, .aovs = ALL},
        {"not asked for", {0}, .aovs = 0},
        {"beside layers", {0}, .aovs = ALL | (AOV_END - 1u)},
        {"waves of 352", {0}, .aovs = ALL, .wave = 352},
        {"split", {0}, .aovs = ALL, .first_call = 3},
        {"all features", {0}, .aovs = ALL, .compile_all = true},
        {"two waves", {.waves = 2}, .aovs = ALL, .wave = 1024},
        {"no texel buffers, small ranges",
         {.no_texel = true, .storage_range = 1u << 17},
         .aovs = ALL},
    };
    static const struct {
        const char *path;
        uint32_t split_lobes;
        size_t variants; // uses only the first variants
    } scenes[] = {{"tests/render/scenes/lights.json", 0, sizeof variants / sizeof *variants},
                  {"scenes/phong_lobes.json", 2, 4}};
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    gpu_close(&gpu);
    for (size_t p = 0; p < sizeof scenes / sizeof *scenes; p++) {
        struct scene scene;
        struct arena arena = {0};
        struct film_image film = {0}, other;
        struct err err = {0};
        REQUIRE_OK(load_scene(scenes[p].path, small, &scene, &err));
        scene.settings.split_lobes = scenes[p].split_lobes;
        for (size_t i = 0; i < scenes[p].variants; i++) {
            REQUIRE_OK(render_variant(&scene, &variants[i], &arena, &other, &err));
            if (i == 0)
                film = other;
            const size_t pixels = (size_t)film.width * film.height,
                         classes = pixels * film.aovs.class_count;
            CHECK(memcmp(film.half_a, other.half_a, pixels * 12) == 0 &&
                      memcmp(film.half_b, other.half_b, pixels * 12) == 0,
                  "%s, %s: another picture", scenes[p].path, variants[i].name);
            CHECK((other.aovs.brightest != NULL) == (variants[i].aovs != 0));
            if (!other.aovs.brightest)
                continue;
            CHECK(memcmp(film.aovs.class_a, other.aovs.class_a, classes * 12) == 0 &&
                      memcmp(film.aovs.class_b, other.aovs.class_b, classes * 12) == 0 &&
                      memcmp(film.aovs.brightest, other.aovs.brightest,
                             pixels * sizeof *film.aovs.brightest) == 0,
                  "%s, %s: other classes, or other brightest", scenes[p].path, variants[i].name);
        }
        scene_finish(&scene);
        arena_finish(&arena);
    }
}

// The requested images take memory, which the plan includes: in a slot 16 bytes per class and 16
// for the brightest contribution; in a pixel of the film 64 and 32.
TEST(memory)
{
    static const struct {
        uint32_t aovs, classes;
    } cases[] = {{0, 0}, {AOV_BY_PART, 3}, {AOV_BY_BOUNCE, 8}, {AOV_BY_EMITTER, 5}, {ALL, 16}};
    struct gpu gpu;
    struct scene scene;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = false);
    REQUIRE_OK(load_scene("tests/render/scenes/lone_lamp.json", small, &scene, &err));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct renderer r;
        const struct renderer_params params = {
            .gpu = &gpu, .scene = &scene, .wave = 1024, .aovs = cases[i].aovs};
        REQUIRE_OK(renderer_prepare(&params, &r, &err));
        uint64_t classes = cases[i].classes, any = classes > 0;
        CHECK(r.plan.buffers[BINDING_RADIANCE].bytes == 1024 * 16 * (1 + classes + any));
        CHECK(r.plan.buffers[BINDING_FILM].bytes ==
                  256 * 16 * (FILM_WORDS * (1 + classes) + 2 * any),
              "%llu bytes", (unsigned long long)r.plan.buffers[BINDING_FILM].bytes);
        CHECK(film_aovs_bytes(cases[i].aovs) == 24 * classes + 20 * any);
        renderer_finish(&r);
    }
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(emission_alone), TEST_CASE(furnace_by_bounce), TEST_CASE(one_of_two_lights),
          TEST_CASE(emitters_add_up), TEST_CASE(brightest_of_all_paths), TEST_CASE(same_bits),
          TEST_CASE(memory))
