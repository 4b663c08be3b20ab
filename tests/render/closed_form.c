#include "closed_form.h"

#include "base/clock.h"
#include "replicates.h"
#include "scaled_scene.h"
#include <inttypes.h>

// Half-width of the 95 % confidence interval and bias, relative to the value.
#define HALF_WIDTH_MAX 1e-3
#define BIAS_MAX 3e-3
// What single precision may add on a path of many bounces; also the bound for forms without
// variance.
#define ROUNDING_MAX 1e-5

const double closed_form_albedo[3] = {0.8, 0.5, 0.2}, closed_form_emission[3] = {1, 2, 4};

static const char *const estimator_names[] = {
    [ESTIMATOR_MIS] = "mis", [ESTIMATOR_NEE] = "nee", [ESTIMATOR_BSDF] = "bsdf"};

// One form by one estimator.
struct trial {
    const struct closed_form *form;
    enum light_estimator estimator;
    uint32_t light_choice; // LIGHT_CHOICE_*
    uint32_t first_seed;   // of its replicates
    struct renderer renderer;
    double expected[3];
    uint64_t samples;
};

// Where nothing is expected, anything is too much.
static double relative_error(double value, double expected)
{
    return expected > 0.0 ? fabs(value / expected - 1.0) : value == 0.0 ? 0.0 : INFINITY;
}

static void check_pixels(struct trial *trial)
{
    struct arena arena = {0};
    struct film_image film;
    struct err err = {0};
    // A power of two: the mean of as many equal values is exact.
    trial->samples = trial->form->kind == EXACT ? 64 : 1;
    const struct render_call call = {.samples = trial->samples};
    REQUIRE_OK(renderer_render(&trial->renderer, &call, &err) &&
               renderer_read(&trial->renderer, &arena, &film, &err));
    double worst = 0.0;
    for (size_t i = 0; i < (size_t)film.width * film.height; i++)
        for (int c = 0; c < 3; c++)
            worst = fmax(worst, relative_error(film.mean[i][c], trial->expected[c]));
    printf("  bias of the worst pixel %.1e", worst);
    CHECK(worst <= (trial->form->kind == EXACT ? 0.0 : ROUNDING_MAX), "%s: off by %.3e",
          trial->form->name, worst);
    arena_finish(&arena);
}

static void check_channel(const struct trial *trial, const struct replicates *replicates, int c)
{
    struct estimate e = replicates_estimate(replicates, (uint32_t)c);
    double expected = trial->expected[c], bias = e.mean - expected;
    double t = bias / e.standard_error;
    printf("  %+.1e (t %+.1f) +-%.1e", bias / expected, t, e.half_width / expected);
    CHECK(fabs(t) <= REPLICATES_T_MAX || fabs(bias) <= ROUNDING_MAX * expected,
          "%s, channel %d: mean %.9g, expected %.9g: t = %.2f", trial->form->name, c, e.mean,
          expected, t);
    CHECK(e.half_width <= HALF_WIDTH_MAX * expected, "%s, channel %d: half-width %.3g of the value",
          trial->form->name, c, e.half_width / expected);
    CHECK(fabs(bias) <= BIAS_MAX * expected, "%s, channel %d: mean %.9g, expected %.9g",
          trial->form->name, c, e.mean, expected);
}

static void check_statistics(struct trial *trial, uint64_t samples)
{
    struct replicates replicates;
    struct err err = {0};
    trial->samples = samples;
    REQUIRE_OK(samples || replicates_pilot(&trial->renderer, &MEASURE_MEAN, HALF_WIDTH_MAX,
                                           CLOSED_FORM_LONG_SAMPLES, &trial->samples, &err));
    REQUIRE_OK(replicates_render(&trial->renderer, &MEASURE_MEAN, trial->first_seed, trial->samples,
                                 &replicates, &err));
    for (int c = 0; c < 3; c++)
        check_channel(trial, &replicates, c);
}

// samples: 0 for as many as are needed.
static void check_form(struct gpu *gpu, struct trial trial, uint64_t samples)
{
    uint64_t start = clock_ns();
    const struct closed_form *form = trial.form;
    struct scene scene;
    struct err err = {0};
    REQUIRE_OK(load_scene(form->scene, form->overrides, &scene, &err));
    if (form->scale > 0.0)
        scale_scene(&scene, form->scale);
    set_estimator(&scene.settings, trial.estimator);
    scene.settings.light_choice = trial.light_choice;
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    for (int c = 0; c < 3; c++)
        trial.expected[c] =
            form->radiance(closed_form_albedo[c], closed_form_emission[c], form->parameter);
    printf("%-34s %-4s %-7s", form->name, estimator_names[trial.estimator],
           light_choice_names[trial.light_choice]);
    REQUIRE_OK(renderer_create(&params, &trial.renderer, &err));
    if (form->kind == BY_STATISTICS)
        check_statistics(&trial, samples);
    else
        check_pixels(&trial);
    printf("  %" PRIu64 " spp, %.1f s\n", trial.samples, clock_seconds_since(start));
    renderer_finish(&trial.renderer);
    scene_finish(&scene);
}

// Seeds of its own for each form: equal ones would give forms that share their random numbers.
static struct trial trial_of(const struct closed_form *form, size_t index, uint32_t first_seed,
                             enum light_estimator estimator)
{
    return (struct trial){.form = form,
                          .estimator = estimator,
                          .first_seed = first_seed + REPLICATES * (uint32_t)index};
}

void closed_forms_by_default(const struct closed_form *forms, size_t count, uint32_t first_seed)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (size_t i = 0; i < count; i++)
        check_form(&gpu, trial_of(&forms[i], i, first_seed, ESTIMATOR_MIS), 0);
    gpu_close(&gpu);
}

void closed_forms_by_every_estimator(const struct closed_form *forms, size_t count,
                                     uint32_t first_seed)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (size_t i = 0; i < count; i++) {
        const struct closed_form *form = &forms[i];
        check_form(&gpu, trial_of(form, i, first_seed, ESTIMATOR_MIS), CLOSED_FORM_LONG_SAMPLES);
        if (form->alone & NEE_ALONE)
            check_form(&gpu, trial_of(form, i, first_seed, ESTIMATOR_NEE),
                       CLOSED_FORM_LONG_SAMPLES);
        if (form->alone & BSDF_ALONE)
            check_form(&gpu, trial_of(form, i, first_seed, ESTIMATOR_BSDF),
                       CLOSED_FORM_LONG_SAMPLES);
    }
    gpu_close(&gpu);
}

void closed_forms_by_every_light_choice(const struct closed_form *forms, size_t count,
                                        uint32_t first_seed)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (size_t i = 0; i < count; i++)
        for (uint32_t choice = LIGHT_CHOICE_UNIFORM; choice <= LIGHT_CHOICE_TREE; choice++) {
            struct trial trial = trial_of(&forms[i], i, first_seed, ESTIMATOR_MIS);
            trial.light_choice = choice;
            check_form(&gpu, trial, 0);
        }
    gpu_close(&gpu);
}

void closed_forms_validated(const struct closed_form *forms, size_t count)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = true);
    for (size_t i = 0; i < count; i++) {
        struct scene scene;
        struct arena arena = {0};
        struct film_image film;
        struct err err = {0};
        REQUIRE_OK(load_scene(forms[i].scene, forms[i].overrides, &scene, &err));
        const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
        CHECK(render_film(&params, 1, &arena, &film, NULL, &err), "%s: %s", forms[i].name, err.msg);
        CHECK(gpu.validation_messages == 0, "%s: %u messages", forms[i].name,
              gpu.validation_messages);
        arena_finish(&arena);
        scene_finish(&scene);
    }
    gpu_close(&gpu);
}
