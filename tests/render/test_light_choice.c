// Whichever emitters a vertex is connected to, the picture is the same: in the mean for each
// strategy of light sampling, and bit for bit for all wave sizes and compiled features.
#include "base/clock.h"
#include "check/estimators.h"
#include "check/replicates.h"
#include "render_fixture.h"

#define SCENE "tests/render/scenes/lights.json"

#define WHOLE 4 // the value after those of the tiles

struct plan {
    uint32_t choice;
    enum light_estimator estimator;
    uint64_t samples;
};

static void render_choice(struct gpu *gpu, const struct plan *plan, uint32_t first_seed,
                          struct replicates *out)
{
    uint64_t start = clock_ns();
    struct scene scene;
    struct renderer r;
    struct err err = {0};
    REQUIRE_OK(load_scene(SCENE, NULL, &scene, &err));
    scene.settings.light_choice = plan->choice;
    set_estimator(&scene.settings, plan->estimator);
    REQUIRE_OK(renderer_create(&(struct renderer_params){.gpu = gpu, .scene = &scene}, &r, &err));
    REQUIRE_OK(replicates_render(&r, &MEASURE_2X2_TILES, first_seed, plan->samples, out, &err));
    struct estimate whole = replicates_estimate(out, WHOLE);
    printf("  %-8s estimator %d: %.6g +-%.2g %%, %.1f s\n", light_choice_names[plan->choice],
           (int)plan->estimator, whole.mean, 100 * whole.half_width / whole.mean,
           clock_seconds_since(start));
    renderer_finish(&r);
    scene_finish(&scene);
}

// Compares plans[0] with each of the others.
static void check_plans(const struct plan *plans, size_t count, double half_width)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    static struct replicates first, other;
    render_choice(&gpu, &plans[0], 1, &first);
    for (size_t i = 1; i < count; i++) {
        render_choice(&gpu, &plans[i], (uint32_t)i * 1000, &other);
        for (uint32_t v = 0; v <= WHOLE; v++) {
            struct estimate a = replicates_estimate(&first, v), b = replicates_estimate(&other, v);
            double error = hypot(a.standard_error, b.standard_error);
            double t = (b.mean - a.mean) / error;
            CHECK(fabs(t) <= REPLICATES_T_MAX, "plan %zu, value %u: %g and %g, t = %g", i, v,
                  a.mean, b.mean, t);
            CHECK(v != WHOLE || 2 * error <= half_width * a.mean, "plan %zu: +-%g %% says little",
                  i, 200 * error / a.mean);
        }
    }
    gpu_close(&gpu);
}

TEST(agree)
{
    static const struct plan plans[] = {{LIGHT_CHOICE_POWER, ESTIMATOR_MIS, 32},
                                        {LIGHT_CHOICE_UNIFORM, ESTIMATOR_MIS, 32},
                                        {LIGHT_CHOICE_TREE, ESTIMATOR_MIS, 32},
                                        {LIGHT_CHOICE_ALL, ESTIMATOR_MIS, 8}};
    check_plans(plans, sizeof plans / sizeof plans[0], 0.0075);
}

TEST(agree_long)
{
    static const struct plan plans[] = {
        {LIGHT_CHOICE_POWER, ESTIMATOR_MIS, 1024},   {LIGHT_CHOICE_UNIFORM, ESTIMATOR_MIS, 1024},
        {LIGHT_CHOICE_TREE, ESTIMATOR_MIS, 1024},    {LIGHT_CHOICE_ALL, ESTIMATOR_MIS, 256},
        {LIGHT_CHOICE_UNIFORM, ESTIMATOR_NEE, 1024}, {LIGHT_CHOICE_TREE, ESTIMATOR_NEE, 1024},
        {LIGHT_CHOICE_ALL, ESTIMATOR_NEE, 256},
    };
    check_plans(plans, sizeof plans / sizeof plans[0], 0.002);
}

static bool render_with(struct gpu *gpu, const struct scene *scene, uint32_t wave, bool compile_all,
                        struct arena *arena, struct film_image *film)
{
    struct err err = {0};
    const struct renderer_params params = {
        .gpu = gpu, .scene = scene, .wave = wave, .compile_all = compile_all};
    bool ok = render_film(&params, 4, arena, film, NULL, &err);
    CHECK(ok, "%s", err.msg);
    return ok;
}

// Runs under the validation layers.
TEST(same_bits)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = true);
    for (uint32_t choice = LIGHT_CHOICE_ALL; choice <= LIGHT_CHOICE_TREE; choice++) {
        bool compile_all = gpu.info.is_cpu && choice == LIGHT_CHOICE_TREE;
        struct scene scene;
        struct err err = {0};
        struct arena arena = {0};
        struct film_image films[3];
        REQUIRE_OK(load_scene(SCENE, NULL, &scene, &err));
        scene.settings.light_choice = choice;
        if (render_with(&gpu, &scene, 128, false, &arena, &films[0]) &&
            render_with(&gpu, &scene, 4096, false, &arena, &films[1]) &&
            (!compile_all || render_with(&gpu, &scene, 4096, true, &arena, &films[2]))) {
            size_t size = 16 * 16 * sizeof *films[0].mean;
            for (int i = 1; i < (compile_all ? 3 : 2); i++)
                CHECK(memcmp(films[0].half_a, films[i].half_a, size) == 0 &&
                          memcmp(films[0].half_b, films[i].half_b, size) == 0,
                      "%s: %s", light_choice_names[choice], i == 1 ? "wave" : "everything");
        }
        arena_finish(&arena);
        scene_finish(&scene);
    }
    gpu_close(&gpu);
}

// The default chooses by the number of lamps, and for a single lamp by what it is made of.
TEST(by_default)
{
    static const struct {
        const char *path;
        uint32_t way, vertices, rays;
    } cases[] = {
        {"scenes/cornell.json", LIGHT_CHOICE_POWER, 0, 1},           // two halves of a lamp
        {"tests/render/scenes/strip.json", LIGHT_CHOICE_TREE, 0, 1}, // one long lamp
        {"scenes/veach_mis.json", LIGHT_CHOICE_ALL, 1, 5},           // five lamps
        {"tests/coverage/many_lamps.json", LIGHT_CHOICE_TREE, 0, 1},
    };
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct scene scene;
        struct renderer r;
        struct err err = {0};
        REQUIRE_OK(load_scene(cases[i].path, NULL, &scene, &err));
        scene.settings.light_choice = LIGHT_CHOICE_AUTO;
        REQUIRE_OK(
            renderer_create(&(struct renderer_params){.gpu = &gpu, .scene = &scene}, &r, &err));
        const struct specialization *s = &r.specialization;
        CHECK(s->light_choice == cases[i].way && s->light_vertices == cases[i].vertices &&
                  s->light_rays == cases[i].rays,
              "%s: %s, %u vertices, %u rays", cases[i].path, light_choice_names[s->light_choice],
              s->light_vertices, s->light_rays);
        renderer_finish(&r);
        scene_finish(&scene);
    }
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(agree), TEST_CASE(agree_long), TEST_CASE(same_bits), TEST_CASE(by_default))
