// Tests two waves in flight: the last bounces of one run together with the first ones of the next.
// By explicit request, any device shows that both run at once, and that no bit of a picture
// changes.
#include "base/log.h"
#include "check/bits.h"
#include "render/probe/replay.h"
#include "render_fixture.h"

#define WAVE 352u // neither a power of two nor a divisor of the number of pixels
#define SAMPLES 5u

struct setup {
    struct gpu gpu;
    struct scene scene;
    struct arena arena;
    struct film_image expected; // rendered with one wave at a time
};

struct method {
    const char *path;
    uint32_t max_bounces, light_choice;
};

static const struct method usual = {"scenes/cornell.json", 9, LIGHT_CHOICE_UNIFORM};

static bool setup_create(struct setup *s, const struct method *method, struct err *err)
{
    const struct scene_override small[] = {{"film.width", "48"}, {"film.height", "32"}, {0}};
    const struct renderer_params params = {.gpu = &s->gpu, .scene = &s->scene};
    struct render_stats stats;
    if (!load_scene(method->path, small, &s->scene, err))
        return false;
    s->scene.settings.max_bounces = method->max_bounces;
    s->scene.settings.light_choice = method->light_choice;
    s->gpu.params.limits.waves = 1;
    if (!render_film(&params, SAMPLES, &s->arena, &s->expected, &stats, err))
        return false;
    CHECK(stats.waves_ahead == 0, "%s: two waves where one was asked for", method->path);
    s->gpu.params.limits.waves = 2;
    return true;
}

// Makes a renderer for the usual scene with two small waves.
static bool create_usual(struct setup *s, struct renderer *r, struct err *err)
{
    const struct renderer_params params = {.gpu = &s->gpu, .scene = &s->scene, .wave = WAVE};
    return setup_create(s, &usual, err) && renderer_create(&params, r, err);
}

static void setup_finish(struct setup *s)
{
    scene_finish(&s->scene);
    arena_finish(&s->arena);
    gpu_close(&s->gpu);
}

static void check_film(struct setup *s, struct renderer *r, const char *what)
{
    struct film_image film;
    struct err err = {0};
    CHECK(!r->ahead.is_begun, "%s: a wave is in flight after the call", what);
    REQUIRE_OK(renderer_read(r, &s->arena, &film, &err));
    CHECK(bits_are_same(&film, &s->expected), "%s: different", what);
}

// Scenes that end within the bounces of one submission, and that need several; with one queue of
// hits and with many; with several shadow rays per vertex, which are traced one after the other.
TEST(same_bits)
{
    static const struct method rows[] = {
        {"scenes/cornell.json", 9, LIGHT_CHOICE_UNIFORM},
        {"scenes/cornell.json", 0, LIGHT_CHOICE_UNIFORM},
        {"scenes/glass.json", 40, LIGHT_CHOICE_UNIFORM},
        {"scenes/all_classes.json", 5, LIGHT_CHOICE_ALL},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        struct setup s = {0};
        struct renderer r;
        struct err err = {0};
        OPEN_GPU(&s.gpu, 0);
        REQUIRE_OK(setup_create(&s, &rows[i], &err));
        const struct renderer_params params = {.gpu = &s.gpu, .scene = &s.scene, .wave = WAVE};
        REQUIRE_OK(renderer_create(&params, &r, &err));
        REQUIRE_OK(renderer_render(&r, &(struct render_call){.samples = SAMPLES}, &err));
        // Without bounces, two waves begin and end together.
        CHECK(r.stats.waves_ahead * 2 >= r.stats.waves, "%s: %llu of %llu waves were begun ahead",
              rows[i].path, (unsigned long long)r.stats.waves_ahead,
              (unsigned long long)r.stats.waves);
        check_film(&s, &r, rows[i].path);
        renderer_finish(&r);
        setup_finish(&s);
    }
}

struct disturbance {
    struct renderer *r;
    uint32_t waves, ahead;
    bool replays, stopped;
};

// Uses the memory of the wave in flight, or stops while there is one.
static bool disturb(void *context, struct err *err)
{
    struct disturbance *d = context;
    d->waves++;
    d->ahead += d->r->ahead.is_begun;
    if (d->replays && d->waves % 3 == 0) {
        struct arena arena = {0};
        struct replay replay;
        bool ok = renderer_replay(d->r, 20, 20, 1, &arena, &replay, err);
        arena_finish(&arena);
        return ok;
    }
    d->stopped = !d->replays && d->waves % 3 == 0;
    return true;
}

static void check_disturbed(bool replays)
{
    struct setup s = {0};
    struct renderer r;
    struct err err = {0};
    OPEN_GPU(&s.gpu, 0);
    REQUIRE_OK(create_usual(&s, &r, &err));
    struct disturbance d = {.r = &r, .replays = replays};
    while (r.next_sample < SAMPLES) {
        const struct render_call call = {.samples = SAMPLES - r.next_sample,
                                         .stopped = &d.stopped,
                                         .after_wave = disturb,
                                         .context = &d};
        d.stopped = false;
        REQUIRE_OK(renderer_render(&r, &call, &err));
    }
    CHECK(d.ahead > 0, "nothing was in flight after any of %u waves", d.waves);
    check_film(&s, &r, replays ? "replays" : "stops");
    renderer_finish(&r);
    setup_finish(&s);
}

TEST(others_may_use_its_memory)
{
    check_disturbed(true);
}

TEST(stops_with_both_in_the_film)
{
    check_disturbed(false);
}

// A wave that is discarded does not change the film, nor does the one that was begun ahead. Both
// are traced again, one at a time, because their rays may be suspended.
TEST(void_waves)
{
    struct setup s = {0};
    struct renderer r;
    struct err err = {0};
    OPEN_GPU(&s.gpu, 0);
    REQUIRE_OK(create_usual(&s, &r, &err));
    r.specialization.iteration_budget = 8;
    REQUIRE_OK(renderer_resize(&r, WAVE, r.specialization.workgroup, &err));
    REQUIRE_OK(renderer_render(&r, &(struct render_call){.samples = SAMPLES}, &err));
    CHECK(r.stats.voided_waves == 1 && r.stats.suspended > 0 && r.stats.waves_ahead == 1,
          "%llu void, %llu suspended, %llu begun ahead", (unsigned long long)r.stats.voided_waves,
          (unsigned long long)r.stats.suspended, (unsigned long long)r.stats.waves_ahead);
    CHECK(r.plan.waves == 1, "%u waves in flight with suspended rays", r.plan.waves);
    check_film(&s, &r, "void waves");
    renderer_finish(&r);
    setup_finish(&s);
}

// Checks how many waves in flight a renderer plans, without using the device.
static void check_choice(struct setup *s, const char *what, uint32_t wave, bool tiles,
                         uint32_t expected)
{
    struct renderer r;
    struct err err = {0};
    const struct renderer_params params = {
        .gpu = &s->gpu, .scene = &s->scene, .wave = wave, .tiles = tiles};
    REQUIRE_OK(renderer_prepare(&params, &r, &err));
    CHECK(r.plan.waves == expected, "%s: %u waves in flight, expected %u", what, r.plan.waves,
          expected);
    CHECK(r.plan.buffers[BINDING_PATHS].copies == expected, "%s: memory", what);
    renderer_finish(&r);
}

TEST(chosen_by_the_device)
{
    struct setup s = {0};
    struct err err = {0};
    OPEN_GPU(&s.gpu, 0);
    REQUIRE_OK(load_scene("scenes/cornell.json", NULL, &s.scene, &err));
    const struct gpu gpu = s.gpu;
    s.gpu.params.limits.waves = 0;
    s.gpu.info.is_cpu = true;
    check_choice(&s, "CPU", 0, false, 1);
    s.gpu.info.is_cpu = false;
    check_choice(&s, "GPU", 0, false, 2);
    check_choice(&s, "GPU, small waves", 1u << 14, false, 1);
    check_choice(&s, "GPU, tiles", 0, true, 1);
    s.gpu.params.limits.waves = 1;
    check_choice(&s, "GPU, one asked for", 0, false, 1);
    s.gpu.params.limits = (struct gpu_limit_overrides){.memory_budget = UINT64_C(300) << 20};
    check_choice(&s, "GPU, memory for one", 0, false, 1);
    s.gpu = gpu;
    setup_finish(&s);
}

static void make_buffers(const struct renderer_params *params, struct memory_plan *plan)
{
    struct renderer r;
    struct err err = {0};
    REQUIRE_OK(renderer_create(params, &r, &err));
    *plan = r.plan;
    renderer_finish(&r);
}

static char warned[512];

static void keep_warning(void *context, enum log_level level, const char *message)
{
    (void)context;
    (void)level;
    snprintf(warned, sizeof warned, "%s", message);
}

// If only an allocation shows that memory is too small for two waves, one wave of the requested
// size is tried before both are halved.
TEST(one_where_allocations_fail)
{
    struct setup s = {0};
    struct err err = {0};
    struct memory_plan one, two, had;
    struct gpu_limit_overrides *limits = &s.gpu.params.limits;
    OPEN_GPU(&s.gpu, 0);
    REQUIRE_OK(load_scene("scenes/cornell.json", NULL, &s.scene, &err));
    const struct renderer_params params = {.gpu = &s.gpu, .scene = &s.scene, .wave = 1u << 14};
    uint64_t before = s.gpu.allocated_bytes;
    limits->waves = 1;
    make_buffers(&params, &one);
    limits->waves = 2;
    make_buffers(&params, &two);
    CHECK(two.waves == 2, "%u waves", two.waves);
    log_configure(LOG_WARN, keep_warning, NULL);
    limits->memory = before + (one.total_bytes + two.total_bytes) / 2;
    make_buffers(&params, &had);
    CHECK(had.waves == 1 && had.wave_slots == one.wave_slots, "%u waves of %u paths", had.waves,
          had.wave_slots);
    CHECK(strstr(warned, "waves of 16384 paths in place of 16384, two in flight"), "\"%s\"",
          warned);
    limits->memory = before + one.total_bytes - 1;
    make_buffers(&params, &had);
    CHECK(had.waves == 1 && had.wave_slots == one.wave_slots / 2, "%u waves of %u paths", had.waves,
          had.wave_slots);
    log_configure(LOG_WARN, NULL, NULL);
    CHECK(s.gpu.allocated_bytes == before, "%llu bytes are left",
          (unsigned long long)(s.gpu.allocated_bytes - before));
    setup_finish(&s);
}

TEST_MAIN(TEST_CASE(same_bits), TEST_CASE(others_may_use_its_memory),
          TEST_CASE(stops_with_both_in_the_film), TEST_CASE(void_waves),
          TEST_CASE(chosen_by_the_device), TEST_CASE(one_where_allocations_fail))
