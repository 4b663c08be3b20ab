// Tests jobs: which goals are refused, what ends a job, and that the film is the same however a job
// is driven.
#include "job/job.h"
#include "render/checkpoint.h"
#include "render/sampling_plan.h"
#include "render_fixture.h"

#include <string.h>

static bool load(struct scene *scene, const char *sampler, struct err *err)
{
    const struct scene_override overrides[] = {
        {"film.width", "16"}, {"film.height", "16"}, {"settings.sampler", sampler}, {0}};
    return load_scene("scenes/cornell.json", overrides, scene, err);
}

static bool start(struct job *job, struct gpu *gpu, struct scene *scene, struct job_goal goal,
                  struct err *err)
{
    const struct job_params params = {
        .renderer = {.gpu = gpu, .wave = 1024}, .scene = scene, .goal = goal};
    return job_start(&params, job, err);
}

// --- checkpoints ---------------------------------------------------------------------------------

TEST(checkpoints_of_other_builds_are_named_so)
{
    static const char own[] = "version=1\n--mis=power\n--normals=visible\n";
    static const struct {
        const char *identity, *expected; // NULL: the job is accepted
    } cases[] = {
        {own, NULL},
        {"version=1\n--mis=none\n--normals=visible\n",
         "c: was made with --mis=none, but this run has power"},
        {"version=1\n--mis=power\n--exponent=2\n--normals=visible\n",
         "c: was made by another build of lampyris, which records \"--exponent\" where this one "
         "records \"--normals\"; expected a checkpoint of this build"},
        {"version=1\n--mis=power\n",
         "c: was made by another build of lampyris, which records \"\" where this one records "
         "\"--normals\"; expected a checkpoint of this build"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct err err = {0};
        const struct checkpoint c = {.path = "c", .identity = cases[i].identity};
        bool ok = checkpoint_check(&c, own, &err);
        CHECK(ok == !cases[i].expected && (ok || strcmp(err.msg, cases[i].expected) == 0),
              "%zu: %s", i, err.msg);
    }
}

// --- goals ---------------------------------------------------------------------------------------

static enum err_code refusal(struct scene *scene, struct job_goal goal)
{
    struct err err = {0};
    struct job job;
    const struct job_params params = {.scene = scene, .goal = goal};
    return job_init(&params, &job, &err) ? ERR_NONE : err.code;
}

TEST(one_answer_tells_what_plans_on_the_number_of_samples)
{
    static const struct {
        uint32_t sampler, halves;
        enum sample_planning planning;
        const char *option;
    } cases[] = {
        {SAMPLER_SOBOL, HALVES_INDEPENDENT, PLANNING_NONE, NULL},
        {SAMPLER_PCG, HALVES_INDEPENDENT, PLANNING_NONE, NULL},
        {SAMPLER_LCG, HALVES_INDEPENDENT, PLANNING_NONE, NULL},
        {SAMPLER_BLUE_NOISE, HALVES_INDEPENDENT, PLANNING_OPTIONAL, "--sampler blue-noise"},
        {SAMPLER_STRATIFIED, HALVES_INDEPENDENT, PLANNING_NEEDED, "--sampler stratified"},
        {SAMPLER_GRID, HALVES_INDEPENDENT, PLANNING_NEEDED, "--sampler grid"},
        {SAMPLER_SOBOL, HALVES_CONTIGUOUS, PLANNING_NEEDED, "--halves contiguous"},
        {SAMPLER_BLUE_NOISE, HALVES_CONTIGUOUS, PLANNING_NEEDED, "--halves contiguous"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct settings settings = {.sampler = cases[i].sampler, .halves = cases[i].halves};
        const char *option;
        CHECK(sample_planning(&settings, &option) == cases[i].planning, "case %zu", i);
        bool same = option && cases[i].option ? strcmp(option, cases[i].option) == 0
                                              : option == cases[i].option;
        CHECK(same, "case %zu: %s", i, option ? option : "none");
    }
}

TEST(methods_and_goals_exclude_each_other)
{
    struct scene scene;
    struct err err = {0};
    REQUIRE_OK(load(&scene, "blue-noise", &err));
    const struct job_goal error = {.error = 0.1}, timed = {.error = 0.1, .seconds = 1},
                          adaptive = {.samples = 32, .adaptive = true};
    CHECK(refusal(&scene, (struct job_goal){.samples = 4}) == ERR_NONE);
    CHECK(refusal(&scene, error) == ERR_USAGE, "blue noise is shared out by the number");
    CHECK(refusal(&scene, timed) == ERR_NONE, "without a number it is not");
    CHECK(refusal(&scene, adaptive) == ERR_NONE);
    scene.settings.sampler = SAMPLER_GRID;
    CHECK(refusal(&scene, error) == ERR_USAGE && refusal(&scene, timed) == ERR_USAGE &&
          refusal(&scene, adaptive) == ERR_USAGE);
    scene.settings.sampler = SAMPLER_SOBOL;
    CHECK(refusal(&scene, error) == ERR_NONE && refusal(&scene, adaptive) == ERR_NONE);
    CHECK(refusal(&scene, (struct job_goal){.samples = 1, .adaptive = true}) == ERR_USAGE);
    scene.settings.roulette = ROULETTE_FRAME;
    CHECK(refusal(&scene, error) == ERR_USAGE);
    scene_finish(&scene);
}

// --- the device ----------------------------------------------------------------------------------

TEST(preparing_takes_no_memory_of_the_device)
{
    struct scene scene;
    struct gpu gpu;
    struct renderer prepared, created;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_scene("scenes/many_lights.json", NULL, &scene, &err));
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
    uint64_t before = gpu.allocated_bytes;
    REQUIRE_OK(renderer_prepare(&params, &prepared, &err));
    CHECK(gpu.allocated_bytes == before && gpu.peak_bytes == before);
    REQUIRE_OK(renderer_create(&params, &created, &err));
    for (uint32_t b = 0; b < BINDING_COUNT; b++)
        CHECK(prepared.plan.buffers[b].bytes == created.plan.buffers[b].bytes, "%s",
              created.plan.buffers[b].name);
    CHECK(memcmp(&prepared.specialization, &created.specialization,
                 sizeof prepared.specialization) == 0);
    renderer_finish(&prepared);
    renderer_finish(&created);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// --- rendering -----------------------------------------------------------------------------------

// One job goes straight to the goal. The other one takes steps, after samples with another seed and
// plan.
TEST(steps_make_what_a_run_makes)
{
    static const char *const samplers[] = {"sobol", "stratified", "grid", "blue-noise"};
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    for (size_t i = 0; i < sizeof samplers / sizeof *samplers; i++) {
        struct scene scenes[2];
        struct job whole, steps;
        REQUIRE_OK(load(&scenes[0], samplers[i], &err) && load(&scenes[1], samplers[i], &err));
        REQUIRE_OK(start(&whole, &gpu, &scenes[0], (struct job_goal){.samples = 9}, &err) &&
                   job_run(&whole, &err) && job_read_film(&whole, &err));
        REQUIRE_OK(start(&steps, &gpu, &scenes[1], (struct job_goal){.samples = 3}, &err) &&
                   job_begin(&steps, job_reference_seed(scenes[1].settings.seed), 5, &err) &&
                   job_advance(&steps, &(struct job_step){.samples = 5}, &err) &&
                   job_begin(&steps, scenes[1].settings.seed, 9, &err));
        for (uint64_t samples = 2; samples <= 9; samples += samples == 8 ? 1 : 3)
            REQUIRE_OK(job_advance(&steps, &(struct job_step){.samples = samples}, &err));
        REQUIRE_OK(job_read_film(&steps, &err));
        CHECK(steps.film.least_samples == 9 && whole.film.least_samples == 9);
        CHECK(steps.image_hash == whole.image_hash, "%s", samplers[i]);
        job_finish(&whole);
        job_finish(&steps);
        scene_finish(&scenes[0]);
        scene_finish(&scenes[1]);
    }
    gpu_close(&gpu);
}

// Another goal can be set after the first one: the film, the plan of the samples and checkpoints
// continue.
TEST(goals_follow_each_other)
{
    static const char *const samplers[] = {"sobol", "grid", "blue-noise"};
    static const char path[] = "goals.ck";
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    for (size_t i = 0; i < sizeof samplers / sizeof *samplers; i++) {
        struct scene scenes[3];
        struct job whole, parts, resumed;
        const struct job_goal all = {.samples = 9};
        for (int k = 0; k < 3; k++)
            REQUIRE_OK(load(&scenes[k], samplers[i], &err));
        REQUIRE_OK(start(&whole, &gpu, &scenes[0], all, &err) && job_run(&whole, &err) &&
                   job_read_film(&whole, &err));
        REQUIRE_OK(start(&parts, &gpu, &scenes[1], all, &err) &&
                   job_set_goal(&parts, &(struct job_goal){.samples = 4}, &err) &&
                   job_run(&parts, &err) && job_checkpoint_write(&parts, path, &err) &&
                   job_read_film(&parts, &err));
        CHECK(parts.film.most_samples == 4 && parts.image_hash != whole.image_hash);
        const struct job_params params = {.renderer = {.gpu = &gpu, .wave = 1024},
                                          .scene = &scenes[2],
                                          .goal = all,
                                          .checkpoint = {path, INFINITY, true}};
        REQUIRE_OK(job_set_goal(&parts, &all, &err) && job_run(&parts, &err) &&
                   job_read_film(&parts, &err));
        REQUIRE_OK(job_start(&params, &resumed, &err) && job_run(&resumed, &err) &&
                   job_read_film(&resumed, &err));
        CHECK(parts.image_hash == whole.image_hash, "%s", samplers[i]);
        CHECK(resumed.image_hash == whole.image_hash, "%s", samplers[i]);
        job_finish(&whole);
        job_finish(&parts);
        job_finish(&resumed);
        for (int k = 0; k < 3; k++)
            scene_finish(&scenes[k]);
        remove(path);
    }
    gpu_close(&gpu);
}

TEST(goals_that_exclude_a_method_leave_the_former)
{
    struct scene scene;
    struct gpu gpu;
    struct job job;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load(&scene, "grid", &err));
    REQUIRE_OK(start(&job, &gpu, &scene, (struct job_goal){.samples = 4}, &err));
    CHECK(!job_set_goal(&job, &(struct job_goal){.error = 1e-3}, &err) && err.code == ERR_USAGE);
    CHECK(!job_set_goal(&job, &(struct job_goal){.adaptive = true}, &err) && err.code == ERR_USAGE);
    CHECK(job.params.goal.samples == 4 && job.params.goal.error == 0 && job.samples_most == 4);
    job_finish(&job);
    scene_finish(&scene);
    REQUIRE_OK(
        load_scene("scenes/cornell.json", (const struct scene_override[]){{0}}, &scene, &err));
    const struct job_goal adaptive = {.samples = 32, .adaptive = true};
    REQUIRE_OK(start(&job, &gpu, &scene, adaptive, &err));
    CHECK(!job_checkpoint_write(&job, "none.ck", &err) && err.code == ERR_USAGE);
    CHECK(job_set_goal(&job, &adaptive, &err), "%s", err.msg);
    CHECK(!job_set_goal(&job, &(struct job_goal){.samples = 64, .adaptive = true}, &err));
    job_finish(&job);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST(whatever_comes_first_ends_it)
{
    struct scene scene;
    struct gpu gpu;
    struct job job;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    static const struct {
        struct job_goal goal;
        enum job_end end;
    } cases[] = {
        {{.samples = 3}, ENDED_BY_SAMPLES},
        {{.samples = 3, .seconds = 1e6}, ENDED_BY_SAMPLES},
        {{.seconds = 0.01}, ENDED_BY_TIME},
        {{.error = 1e3}, ENDED_BY_ERROR},
        {{.samples = 5, .error = 1e-12}, ENDED_BY_SAMPLES},
        {{.error = 1e-12, .seconds = 0.01}, ENDED_BY_TIME},
        {{.samples = 32, .adaptive = true}, ENDED_BY_SAMPLES},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        REQUIRE_OK(load(&scene, "sobol", &err));
        REQUIRE_OK(start(&job, &gpu, &scene, cases[i].goal, &err) && job_run(&job, &err) &&
                   job_judge_end(&job, &err));
        CHECK(job.ended_by == cases[i].end, "case %zu: by %s", i, job_ended_by(&job));
        CHECK(job.film.least_samples > 0, "case %zu", i);
        CHECK(job.look_count == 0 || cases[i].goal.error > 0.0, "case %zu", i);
        job_finish(&job);
        scene_finish(&scene);
    }
    gpu_close(&gpu);
}

// --- listeners -----------------------------------------------------------------------------------

struct heard {
    const struct job *job;
    uint32_t waves, rows, frames[8], frame_count;
    bool fails;
};

static bool hear_wave(void *context, struct err *err)
{
    struct heard *heard = context;
    heard->waves++;
    return !heard->fails || err_set(err, ERR_OUTPUT, "no more");
}

static bool hear_frame(void *context, uint32_t frame, struct err *err)
{
    struct heard *heard = context;
    (void)err;
    heard->frames[heard->frame_count++ % 8] = frame;
    return true;
}

static bool hear_row(void *context, struct err *err)
{
    struct heard *heard = context;
    (void)err;
    heard->rows += heard->job->trace.count == heard->rows + 1;
    return true;
}

TEST(listeners_hear_of_waves_frames_and_rows)
{
    struct scene scene;
    struct gpu gpu;
    struct job job;
    struct err err = {0};
    struct heard heard = {.job = &job};
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load(&scene, "sobol", &err));
    struct job_params params = {
        .renderer = {.gpu = &gpu, .wave = 1024},
        .scene = &scene,
        .goal = {.frames = 4, .samples_per_frame = 2, .accumulate = true},
        .keeps_trace = true,
        .listener = {hear_wave, hear_frame, hear_row, &heard},
    };
    REQUIRE_OK(job_start(&params, &job, &err) && job_run(&job, &err) && job_judge_end(&job, &err));
    job_end_trace(&job);
    CHECK(scene.settings.spp == 8, "planned");
    CHECK(heard.waves >= 4 && heard.frame_count == 4 && job.frame_count == 4);
    for (uint32_t i = 0; i < 4; i++)
        CHECK(heard.frames[i] == i + 1);
    CHECK(heard.rows == 2 && job.trace.count == 3, "after frames 1, 2 and 4");
    CHECK(job.trace.rows[2].spp == 8 && job.trace.rows[2].frames == 4);
    job_finish(&job);
    heard = (struct heard){.job = &job, .fails = true};
    params.goal = (struct job_goal){.samples = 64};
    REQUIRE_OK(job_start(&params, &job, &err));
    CHECK(!job_run(&job, &err) && err.code == ERR_OUTPUT && heard.waves == 1, "%u waves",
          heard.waves);
    job_finish(&job);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(checkpoints_of_other_builds_are_named_so),
          TEST_CASE(one_answer_tells_what_plans_on_the_number_of_samples),
          TEST_CASE(methods_and_goals_exclude_each_other),
          TEST_CASE(preparing_takes_no_memory_of_the_device),
          TEST_CASE(steps_make_what_a_run_makes), TEST_CASE(goals_follow_each_other),
          TEST_CASE(goals_that_exclude_a_method_leave_the_former),
          TEST_CASE(whatever_comes_first_ends_it),
          TEST_CASE(listeners_hear_of_waves_frames_and_rows))
