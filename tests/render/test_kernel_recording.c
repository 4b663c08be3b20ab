// Tests kernels alone on the input that they get in a render: they process the same number of items
// with the same results, and the renderer can continue afterwards.
#include "render/probe/kernel_recording.h"
#include "render_fixture.h"

#define SAMPLES 4u
#define BOUNCES 4u

struct setup {
    struct gpu gpu;
    struct scene scene;
    struct renderer r;
};

// Makes a renderer for a picture of one wave.
static bool create(struct setup *s, const char *path, struct err *err)
{
    if (!load_scene(path, NULL, &s->scene, err))
        return false;
    s->scene.settings.width = 24;
    s->scene.settings.height = 20;
    s->scene.settings.max_bounces = BOUNCES;
    s->scene.settings.roulette_min_bounces = 1;
    return renderer_create(
        &(struct renderer_params){.gpu = &s->gpu, .scene = &s->scene, .wave = 2048}, &s->r, err);
}

static void finish(struct setup *s)
{
    renderer_finish(&s->r);
    gpu_close(&s->gpu);
    scene_finish(&s->scene);
}

static bool render(struct renderer *r, struct arena *arena, struct film_image *film,
                   struct err *err)
{
    return renderer_restart(r, r->scene->settings.seed, err) &&
           renderer_render(r, &(struct render_call){.samples = SAMPLES}, err) &&
           renderer_read(r, arena, film, err);
}

// Records the kernel after `depth` bounces and runs it. Returns the number of items.
static uint64_t try_kernel(struct setup *s, enum kernel_id kernel, uint32_t depth)
{
    struct err err = {0};
    struct kernel_recording recorded;
    const char *name = s->r.kernels[kernel].name;
    const struct kernel_recording_params params = {kernel, depth, SAMPLES};
    bool ok = kernel_recording_create(&s->r, &params, &recorded, &err);
    CHECK(ok, "%s, depth %u: %s", name, depth, err.msg);
    for (int run = 0; run < 2 && ok && recorded.items > 0; run++) {
        double ms = -1.0;
        ok = kernel_recording_run(&recorded, &ms, &err);
        CHECK(ok && ms > 0.0, "%s, depth %u, %g ms: %s", name, depth, ms, err.msg);
    }
    uint64_t items = recorded.items;
    CHECK(kernel_recording_finish(&recorded, &err), "%s: %s", name, err.msg);
    return items;
}

// The same, but returns the number of slots, each of which may have several shadow rays.
static uint64_t try_slots(struct setup *s, enum kernel_id kernel, uint32_t depth)
{
    uint64_t items = try_kernel(s, kernel, depth);
    uint32_t rays = kernel == KERNEL_intersect_shadow ? wave_shadow_launches(&s->r, depth + 1) : 1;
    CHECK(items % rays == 0, "depth %u: %llu items, %u rays each", depth, (unsigned long long)items,
          rays);
    return items / rays;
}

// Tests all depths.
static uint64_t try_depths(struct setup *s, enum kernel_id kernel)
{
    bool once = kernel == KERNEL_generate_rays || kernel == KERNEL_accumulate ||
                kernel == KERNEL_resolve || kernel == KERNEL_prepare_dispatch;
    uint64_t items = try_slots(s, kernel, 0);
    // Whitted's integrator continues as long as a ray of the tree is left.
    bool tree = s->r.specialization.pending_rays > 0;
    for (uint32_t depth = 1; depth <= (tree ? 40 : BOUNCES) && !once; depth++)
        items += try_slots(s, kernel, depth);
    return items;
}

// Tests every kernel of the scene at every depth: the rays are those of a render, and afterwards
// the picture has the same bits as before.
static void check_scene(const char *path, bool validation)
{
    struct err err = {0};
    struct setup s = {0};
    struct arena arena = {0};
    struct film_image first, second;
    uint64_t items[KERNEL_COUNT] = {0};
    OPEN_GPU(&s.gpu, .validation = validation);
    REQUIRE_OK(create(&s, path, &err));
    REQUIRE_OK(render(&s.r, &arena, &first, &err));
    const struct render_stats stats = s.r.stats;
    for (int id = 0; id < KERNEL_COUNT; id++)
        if (s.r.kernels[id].pipeline)
            items[id] = try_depths(&s, (enum kernel_id)id);
    uint64_t pixels = (uint64_t)s.r.frame.width * s.r.frame.height;
    uint64_t shaded = 0, hits = 0;
    for (int id = KERNEL_shade_surface; id <= KERNEL_shade_whitted; id++)
        shaded += items[id];
    for (uint32_t c = 0; c < CLASS_COUNT; c++)
        hits += stats.surface_hits[c];
    printf("  %-28s %6llu rays, %6llu shadow rays, %6llu hits\n", path,
           (unsigned long long)items[KERNEL_intersect_closest],
           (unsigned long long)items[KERNEL_intersect_shadow], (unsigned long long)shaded);
    CHECK(items[KERNEL_intersect_closest] == stats.closest_rays, "%s: %llu of %llu rays", path,
          (unsigned long long)items[KERNEL_intersect_closest],
          (unsigned long long)stats.closest_rays);
    CHECK(items[KERNEL_intersect_shadow] == stats.shadow_rays, "%s: %llu of %llu shadow rays", path,
          (unsigned long long)items[KERNEL_intersect_shadow],
          (unsigned long long)stats.shadow_rays);
    CHECK(shaded == hits, "%s: %llu of %llu hits", path, (unsigned long long)shaded,
          (unsigned long long)hits);
    CHECK(items[KERNEL_generate_rays] == pixels * SAMPLES, "%s: camera rays", path);
    CHECK(items[KERNEL_accumulate] == pixels, "%s: pixels", path);
    CHECK(items[KERNEL_resolve] == pixels, "%s: pixels", path);
    REQUIRE_OK(render(&s.r, &arena, &second, &err));
    CHECK(memcmp(first.mean, second.mean, pixels * sizeof *first.mean) == 0, "%s: other bits",
          path);
    CHECK(s.gpu.validation_messages == 0, "%s: %u validation messages", path,
          s.gpu.validation_messages);
    arena_finish(&arena);
    finish(&s);
}

TEST(every_kernel)
{
    check_scene("scenes/all_classes.json", false);
    check_scene("scenes/cornell.json", false);
    check_scene("scenes/sky.json", false);
}

TEST(other_integrators)
{
    check_scene("scenes/whitted.json", false);
}

TEST(validation_is_silent)
{
    check_scene("scenes/cornell.json", true);
}

static bool record_closest(struct setup *s, uint32_t depth, struct kernel_recording *out,
                           struct err *err)
{
    const struct kernel_recording_params params = {KERNEL_intersect_closest, depth, SAMPLES};
    return kernel_recording_create(&s->r, &params, out, err);
}

// If a kernel gets other input than in the render, this is detected.
TEST(other_results_are_found)
{
    struct err err = {0};
    struct setup s = {0};
    struct kernel_recording recorded;
    struct gpu_path path;
    double ms;
    OPEN_GPU(&s.gpu, .validation = false);
    REQUIRE_OK(create(&s, "scenes/cornell.json", &err));
    REQUIRE_OK(record_closest(&s, 0, &recorded, &err));
    REQUIRE_OK(kernel_recording_run(&recorded, &ms, &err));
    struct gpu_buffer *kept = &recorded.kept[BINDING_PATHS];
    uint64_t at = 100 * sizeof path;
    REQUIRE_OK(gpu_download(&s.gpu, kept, at, &path, sizeof path, &err));
    path.direction[0] += 0.01f;
    REQUIRE_OK(gpu_upload(&s.gpu, kept, at, &path, sizeof path, &err));
    CHECK(!kernel_recording_run(&recorded, &ms, &err) && err.code == ERR_BUG, "%s", err.msg);
    CHECK(kernel_recording_finish(&recorded, &err), "%s", err.msg);
    finish(&s);
}

// Kernels that cannot be timed are refused, and the renderer can continue.
TEST(refusals)
{
    struct err err = {0};
    struct setup s = {0};
    struct kernel_recording recorded;
    struct kernel_recording_params params = {KERNEL_shade_classical, 0, SAMPLES};
    OPEN_GPU(&s.gpu, .validation = false);
    REQUIRE_OK(create(&s, "scenes/cornell.json", &err));
    CHECK(!kernel_recording_create(&s.r, &params, &recorded, &err) && err.code == ERR_USAGE,
          "left out");
    CHECK(kernel_recording_finish(&recorded, &err), "%s", err.msg);
    params = (struct kernel_recording_params){KERNEL_intersect_closest, 1000, SAMPLES};
    REQUIRE_OK(kernel_recording_create(&s.r, &params, &recorded, &err));
    CHECK(recorded.items == 0, "%llu items", (unsigned long long)recorded.items);
    CHECK(kernel_recording_finish(&recorded, &err), "%s", err.msg);

    // On such a device the render may have used up the memory.
    bool is_cpu = s.gpu.info.is_cpu;
    s.gpu.info.is_cpu = false;
    s.gpu.params.limits.memory_budget = s.gpu.allocated_bytes + 1000;
    CHECK(!record_closest(&s, 1, &recorded, &err) && strstr(err.msg, "1000 bytes left"), "%s",
          err.msg);
    CHECK(kernel_recording_finish(&recorded, &err), "%s", err.msg);
    s.gpu.info.is_cpu = is_cpu;
    s.gpu.params.limits.memory_budget = 0;
    CHECK(try_kernel(&s, KERNEL_intersect_closest, 1) > 0, "no rays");

    s.r.specialization.iteration_budget = 3;
    REQUIRE_OK(wave_compile(&s.r, &err));
    CHECK(!record_closest(&s, 0, &recorded, &err) && err.code == ERR_GPU &&
              strstr(err.msg, "more than 3 steps"),
          "%s", err.msg);
    CHECK(kernel_recording_finish(&recorded, &err), "%s", err.msg);
    specialization_suspend(&s.r.specialization);
    CHECK(!record_closest(&s, 0, &recorded, &err) && err.code == ERR_GPU, "%s", err.msg);
    CHECK(kernel_recording_finish(&recorded, &err), "%s", err.msg);
    finish(&s);
}

TEST(without_timestamps)
{
    struct err err = {0};
    struct setup s = {0};
    OPEN_GPU(&s.gpu, .validation = false);
    s.gpu.has_timestamps = false;
    REQUIRE_OK(create(&s, "scenes/cornell.json", &err));
    CHECK(try_kernel(&s, KERNEL_intersect_closest, 0) > 0, "no rays");
    finish(&s);
}

// There is a shadow ray for each light: as many launches, and as many items per slot.
TEST(all_lights)
{
    struct err err = {0};
    struct setup s = {0};
    OPEN_GPU(&s.gpu, .validation = false);
    REQUIRE_OK(create(&s, "scenes/whitted.json", &err));
    renderer_finish(&s.r);
    s.scene.settings.light_choice = LIGHT_CHOICE_ALL;
    s.scene.settings.integrator = INTEGRATOR_PATH;
    const struct renderer_params params = {.gpu = &s.gpu, .scene = &s.scene, .wave = 512};
    REQUIRE_OK(renderer_create(&params, &s.r, &err));
    uint32_t rays = s.r.specialization.light_rays;
    uint64_t items = try_kernel(&s, KERNEL_intersect_shadow, 0);
    CHECK(rays > 1 && items > 0 && items % rays == 0, "%llu items, %u rays each",
          (unsigned long long)items, rays);
    finish(&s);
}

// Counting does not change any bit, and the counts of a render are the sums over its depths.
TEST(steps)
{
    struct err err = {0};
    struct setup s = {0};
    struct arena arena = {0};
    struct film_image plain, counted;
    uint64_t sum[STEPS_COUNT] = {0};
    OPEN_GPU(&s.gpu, .validation = false);
    REQUIRE_OK(create(&s, "scenes/spheres.json", &err));
    REQUIRE_OK(render(&s.r, &arena, &plain, &err));
    CHECK(s.r.stats.steps[STEPS_CLOSEST] == 0, "counted without being asked to");
    for (uint32_t i = 0; i < 2 * (BOUNCES + 1); i++) {
        struct kernel_recording recorded;
        uint32_t which = i % 2 ? STEPS_SHADOW : STEPS_CLOSEST;
        uint64_t nodes, primitives;
        const struct kernel_recording_params params = {
            i % 2 ? KERNEL_intersect_shadow : KERNEL_intersect_closest, i / 2, SAMPLES};
        REQUIRE_OK(kernel_recording_create(&s.r, &params, &recorded, &err));
        if (recorded.items > 0) {
            REQUIRE_OK(kernel_recording_count_steps(&recorded, &nodes, &primitives, &err));
            CHECK(nodes >= recorded.items, "%llu nodes for %llu rays", (unsigned long long)nodes,
                  (unsigned long long)recorded.items);
            sum[which] += nodes;
            sum[which + 1] += primitives;
        }
        CHECK(kernel_recording_finish(&recorded, &err), "%s", err.msg);
    }
    REQUIRE_OK(wave_count_steps(&s.r, true, &err));
    REQUIRE_OK(render(&s.r, &arena, &counted, &err));
    CHECK(memcmp(plain.mean, counted.mean,
                 sizeof *plain.mean * s.r.frame.width * s.r.frame.height) == 0,
          "other bits");
    for (int i = 0; i < STEPS_COUNT; i++)
        CHECK(s.r.stats.steps[i] == sum[i] && sum[i] > 0, "%d: %llu in a render, %llu alone", i,
              (unsigned long long)s.r.stats.steps[i], (unsigned long long)sum[i]);
    arena_finish(&arena);
    finish(&s);
}

TEST_MAIN(TEST_CASE(every_kernel), TEST_CASE(other_integrators), TEST_CASE(validation_is_silent),
          TEST_CASE(other_results_are_found), TEST_CASE(refusals), TEST_CASE(without_timestamps),
          TEST_CASE(all_lights), TEST_CASE(steps))
