// Measures how often unbiased methods whose light comes from few samples are reported as biased: by
// converge, from replicates, and by render --reference, from one picture. Pictures, seeds and
// references are those of `lampyris converge --spp S`: 16 replicates, and 100 S samples of another
// seed.
#include "metrics/bias.h"
#include "metrics/forecast.h"
#include "metrics/metrics.h"
#include "render_fixture.h"

enum { REPLICATES = 16, REFERENCE_FACTOR = 100, OVERRIDES = 8, SEEDS = 500 };

struct method {
    const char *name, *path, *width, *height;
    uint32_t samples;
    struct scene_override scene[OVERRIDES];  // settings of the method and of the reference
    struct scene_override varied[OVERRIDES]; // settings of the method only
};

static const struct method methods[] = {
    {
        .name = "Phong's lobes, even directions",
        .path = "scenes/phong_lobes.json",
        .width = "24",
        .height = "18",
        .samples = 64,
        .scene = {{"exponent", "300"}, {"settings.nee", "false"}},
        .varied = {{"settings.directions", "hemisphere"}},
    },
    {
        .name = "caustic by chance",
        .path = "tests/render/scenes/caustic.json",
        .width = "16",
        .height = "16",
        .samples = 4,
    },
    {
        .name = "tiny lamp without NEE",
        .path = "tests/render/scenes/tiny_lamp.json",
        .width = "16",
        .height = "16",
        .samples = 16,
        .varied = {{"settings.nee", "false"}},
    },
    {
        .name = "small sun, even directions",
        .path = "tests/render/scenes/small_sun.json",
        .width = "16",
        .height = "16",
        .samples = 16,
        .varied = {{"settings.nee", "false"}, {"settings.directions", "hemisphere"}},
    },
    {
        .name = "lamps out of focus",
        .path = "tests/render/scenes/lamps_out_of_focus.json",
        .width = "16",
        .height = "16",
        .samples = 16,
    },
};
enum { METHODS = sizeof methods / sizeof *methods };

// A renderer for the reference, and one for the method.
struct study {
    const struct method *method;
    struct gpu gpu;
    struct scene scenes[2];
    struct renderer renderers[2];
};

static uint32_t append(struct scene_override *list, uint32_t count,
                       const struct scene_override *more)
{
    for (uint32_t i = 0; i < OVERRIDES && more[i].key; i++)
        list[count++] = more[i];
    return count;
}

static bool open_renderer(struct study *s, bool is_method, struct err *err)
{
    const struct method *m = s->method;
    struct scene_override list[2 * OVERRIDES + 3] = {{"film.width", m->width},
                                                     {"film.height", m->height}};
    uint32_t count = append(list, 2, m->scene);
    if (is_method)
        append(list, count, m->varied);
    struct scene *scene = &s->scenes[is_method];
    const struct renderer_params params = {.gpu = &s->gpu, .scene = scene};
    if (!load_scene(m->path, list, scene, err))
        return false;
    scene->settings.spp = is_method ? m->samples : REFERENCE_FACTOR * m->samples;
    return renderer_create(&params, &s->renderers[is_method], err);
}

static bool render(struct study *s, bool is_method, uint32_t seed, struct arena *arena,
                   struct film_image *film, struct err *err)
{
    struct renderer *r = &s->renderers[is_method];
    const struct render_call call = {.samples = s->scenes[is_method].settings.spp};
    return renderer_restart(r, seed, err) && renderer_render(r, &call, err) &&
           renderer_read(r, arena, film, err);
}

struct verdict {
    bool converge, render;
};

static bool judge(const struct film_image *reference, const struct film_image *films,
                  struct arena *arena, struct verdict *out)
{
    const float *pictures[REPLICATES];
    double noise = 0;
    size_t length = 3 * (size_t)reference->width * reference->height;
    float(*means)[3] = arena_alloc(arena, length / 3, sizeof *means);
    if (!means || !metrics_local_means((const float(*)[3])reference->mean, reference->width,
                                       reference->height, NULL, means))
        return false;
    for (int r = 0; r < REPLICATES; r++)
        pictures[r] = films[r].mean[0];
    for (size_t i = 0; i < length; i++) {
        double half = ((double)reference->half_a[0][i] - (double)reference->half_b[0][i]) / 2;
        double mean = (double)means[0][i];
        noise += half * half / (mean * mean + METRICS_RELMSE_EPSILON) / (double)length;
    }
    const struct bias_params params = {
        .pictures = pictures,
        .count = REPLICATES,
        .length = length,
        .reference = reference->mean[0],
        .reference_halves = {reference->half_a[0], reference->half_b[0]},
    };
    const struct forecast_bias_params of_one = {
        .half_a = (const float(*)[3])films[0].half_a,
        .half_b = (const float(*)[3])films[0].half_b,
        .reference = (const float(*)[3])reference->mean,
        .means = (const float(*)[3])means,
        .width = reference->width,
        .height = reference->height,
        .reference_halves = {(const float(*)[3])reference->half_a,
                             (const float(*)[3])reference->half_b},
        .reference_error = noise,
    };
    struct interval bias = {NAN, NAN, NAN};
    struct forecast_bias stays;
    bool ok = bias_find(&params, &bias) && forecast_find_bias(&of_one, &stays);
    *out = (struct verdict){bias.low > 0, stays.is_certain};
    return ok;
}

static bool run_seed(struct study *s, uint32_t seed, struct verdict *out, struct err *err)
{
    struct arena arena = {0};
    struct film_image reference, films[REPLICATES];
    bool ok = render(s, false, ~seed, &arena, &reference, err);
    for (uint32_t r = 0; ok && r < REPLICATES; r++)
        ok = render(s, true, seed + r, &arena, &films[r], err);
    ok = ok && (judge(&reference, films, &arena, out) || err_memory(err, "bias", 0));
    arena_finish(&arena);
    return ok;
}

// Checks that at most `most` of the seeds first, first + step, … are reported as biased by either.
static void check_seeds(const struct method *method, uint32_t first, uint32_t step, uint32_t count,
                        uint32_t most)
{
    struct study s = {.method = method};
    struct err err = {0};
    uint32_t by_converge = 0, by_render = 0;
    OPEN_GPU(&s.gpu, 0);
    REQUIRE_OK(open_renderer(&s, false, &err) && open_renderer(&s, true, &err));
    for (uint32_t i = 0; i < count; i++) {
        struct verdict verdict;
        REQUIRE_OK(run_seed(&s, first + i * step, &verdict, &err));
        by_converge += verdict.converge;
        by_render += verdict.render;
    }
    printf("| %s | %s x %s | %u | %u | %.1f %% | %.1f %% |\n", method->name, method->width,
           method->height, method->samples, count, 100.0 * by_converge / count,
           100.0 * by_render / count);
    fflush(stdout);
    CHECK(by_converge <= most && by_render <= most, "%s: %u by converge and %u by render of %u",
          method->name, by_converge, by_render, count);
    for (int i = 0; i < 2; i++) {
        renderer_finish(&s.renderers[i]);
        scene_finish(&s.scenes[i]);
    }
    gpu_close(&s.gpu);
}

// Each of these was reported as biased when the interval came from the replicates' noise alone.
TEST(lobes)
{
    check_seeds(&methods[0], 1000, 100, 2, 0);
    check_seeds(&methods[0], 2400, 200, 2, 0);
}

// Each method is a row of docs/convergence.md.
TEST(honest_methods_long)
{
    printf("| method | pixels | samples | seeds | converge | render --reference |\n");
    printf("|---|---|---|---|---|---|\n");
    for (int m = 0; m < METHODS; m++)
        check_seeds(&methods[m], 1, REPLICATES, SEEDS, SEEDS * 25 / 1000);
}

TEST_MAIN(TEST_CASE(lobes), TEST_CASE(honest_methods_long))
