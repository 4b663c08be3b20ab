#include "form_trials.h"

#include "base/clock.h"
#include "check/closed_form.h"
#include "check/embedded_scene.h"
#include "check/replicates.h"
#include "render_fixture.h"
#include <inttypes.h>

static const char *const estimator_names[] = {[ESTIMATOR_MIS] = "mis",
                                              [ESTIMATOR_NEE] = "nee",
                                              [ESTIMATOR_BSDF] = "bsdf",
                                              [ESTIMATOR_LIGHT_PATHS] = "bidir"};

// Sets `out` to false where the integrator refuses the scene of a form, or has nothing to do in it.
static void has_light_paths(struct gpu *gpu, const struct closed_form *form, bool *out)
{
    struct scene scene;
    struct renderer renderer;
    struct err err = {0};
    REQUIRE_OK(embedded_scene_load(form->scene, form->overrides, &scene, &err));
    if (form->prepare)
        REQUIRE_OK(form->prepare(&scene, form->parameter, &err));
    set_estimator(&scene.settings, ESTIMATOR_LIGHT_PATHS);
    const struct renderer_params params = {
        .gpu = gpu, .scene = &scene, .instancing = form->instancing};
    bool is_created = renderer_create(&params, &renderer, &err);
    *out = is_created && renderer.specialization.integrator == INTEGRATOR_BIDIR;
    CHECK(is_created || strstr(err.msg, "--integrator"), "%s", err.msg);
    if (is_created)
        renderer_finish(&renderer);
    scene_finish(&scene);
}

static void try_form(struct gpu *gpu, const struct check_case *form,
                     const struct closed_form_trial *trial)
{
    uint64_t start = clock_ns();
    const struct check check = {.gpu = gpu};
    struct closed_form_seen seen;
    struct err err = {0};
    printf("%-34s %-4s %-7s", form->name, estimator_names[trial->estimator],
           light_choice_names[trial->light_choice]);
    REQUIRE_OK(closed_form_try(&check, trial, &seen, NULL, &err));
    for (int c = 0; c < 3; c++)
        printf("  %+.1e (t %+.1f) +-%.1e", seen.bias[c], seen.t[c], seen.half_width[c]);
    CHECK(seen.passed, "%s: %s", form->name, seen.why);
    printf("  %" PRIu64 " spp, %.1f s\n", seen.samples, clock_seconds_since(start));
}

// Each form has seeds of its own; with equal ones, forms would share their random numbers.
static struct closed_form_trial trial_of(const struct check_group *group, size_t index,
                                         uint32_t first_seed, enum light_estimator estimator)
{
    return (struct closed_form_trial){.form = group->cases[index].data,
                                      .estimator = estimator,
                                      .first_seed = first_seed + REPLICATES * (uint32_t)index,
                                      .half_width_max = CLOSED_FORM_HALF_WIDTH};
}

static void by_default(const struct check_group *group, uint32_t first_seed, bool longer)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (size_t i = 0; i < group->count; i++) {
        if (group->cases[i].is_long && !longer)
            continue;
        const struct closed_form_trial trial = trial_of(group, i, first_seed, ESTIMATOR_MIS);
        try_form(&gpu, &group->cases[i], &trial);
    }
    gpu_close(&gpu);
}

void forms_by_default(const struct check_group *group, uint32_t first_seed)
{
    by_default(group, first_seed, true);
}

void forms_that_are_short(const struct check_group *group, uint32_t first_seed)
{
    by_default(group, first_seed, false);
}

static void by_estimator(struct gpu *gpu, const struct check_group *group, size_t index,
                         uint32_t first_seed, enum light_estimator estimator)
{
    struct closed_form_trial trial = trial_of(group, index, first_seed, estimator);
    trial.samples = CLOSED_FORM_LONG_SAMPLES;
    try_form(gpu, &group->cases[index], &trial);
}

void forms_by_every_estimator(const struct check_group *group, uint32_t first_seed)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (size_t i = 0; i < group->count; i++) {
        const struct closed_form *form = group->cases[i].data;
        by_estimator(&gpu, group, i, first_seed, ESTIMATOR_MIS);
        if (form->alone & NEE_ALONE)
            by_estimator(&gpu, group, i, first_seed, ESTIMATOR_NEE);
        if (form->alone & BSDF_ALONE)
            by_estimator(&gpu, group, i, first_seed, ESTIMATOR_BSDF);
    }
    gpu_close(&gpu);
}

void forms_by_every_light_choice(const struct check_group *group, uint32_t first_seed)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (size_t i = 0; i < group->count; i++)
        for (uint32_t choice = LIGHT_CHOICE_UNIFORM; choice <= LIGHT_CHOICE_TREE; choice++) {
            struct closed_form_trial trial = trial_of(group, i, first_seed, ESTIMATOR_MIS);
            trial.light_choice = choice;
            try_form(&gpu, &group->cases[i], &trial);
        }
    gpu_close(&gpu);
}

void forms_by_light_paths(const struct check_group *group, uint32_t first_seed, size_t least)
{
    struct gpu gpu;
    size_t tried = 0;
    OPEN_GPU(&gpu, 0);
    for (size_t i = 0; i < group->count; i++) {
        // Light paths have variance where paths from the camera have none.
        struct closed_form form = *(const struct closed_form *)group->cases[i].data;
        struct closed_form_trial trial = trial_of(group, i, first_seed, ESTIMATOR_LIGHT_PATHS);
        bool has = false;
        form.kind = BY_STATISTICS;
        trial.form = &form;
        trial.half_width_max = 4 * CLOSED_FORM_HALF_WIDTH;
        has_light_paths(&gpu, &form, &has);
        if (!has)
            continue;
        try_form(&gpu, &group->cases[i], &trial);
        tried++;
    }
    printf("%zu of %zu forms of %s\n", tried, group->count, group->name);
    CHECK(tried >= least, "%s: %zu forms have light paths, expected %zu", group->name, tried,
          least);
    gpu_close(&gpu);
}

void forms_validated(const struct check_group *group)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = true);
    for (size_t i = 0; i < group->count; i++) {
        const struct closed_form *form = group->cases[i].data;
        const char *name = group->cases[i].name;
        struct scene scene;
        struct arena arena = {0};
        struct film_image film;
        struct err err = {0};
        REQUIRE_OK(embedded_scene_load(form->scene, form->overrides, &scene, &err));
        const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
        CHECK(render_film(&params, 1, &arena, &film, NULL, &err), "%s: %s", name, err.msg);
        CHECK(gpu.validation_messages == 0, "%s: %u messages", name, gpu.validation_messages);
        arena_finish(&arena);
        scene_finish(&scene);
    }
    gpu_close(&gpu);
}
