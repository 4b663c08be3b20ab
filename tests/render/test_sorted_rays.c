// Tests rays sorted by octant and cell: each ray is traced once, at the place of its key. `render
// same bits` tests that no bit of a picture changes.
#include "render/counters.h"
#include "render/wave.h"
#include "render_fixture.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SAMPLES 4u

struct setup {
    struct gpu gpu;
    struct scene scene;
    struct renderer r;
    struct arena arena;
    // Used while a queue is sorted.
    uint32_t *slots; // slots of its rays, before
    uint32_t ray_count, sorted_queue;
    // Counts so far.
    uint32_t sorted_queues, near_borders, compared;
    uint64_t sorted_rays;
    bool keys_used[SORT_KEYS];
};

static bool setup_create(struct setup *s, const char *path, struct err *err)
{
    const struct scene_override small[] = {{"film.width", "40"}, {"film.height", "32"}, {0}};
    s->gpu.params.limits.sort_rays = true;
    return load_scene(path, small, &s->scene, err) &&
           renderer_create(
               &(struct renderer_params){.gpu = &s->gpu, .scene = &s->scene, .wave = 2048}, &s->r,
               err);
}

static void setup_finish(struct setup *s)
{
    scene_finish(&s->scene);
    arena_finish(&s->arena);
    gpu_close(&s->gpu);
}

static bool read_queue(struct setup *s, uint32_t queue, uint32_t **slots, struct err *err)
{
    struct renderer *r = &s->r;
    uint64_t bytes = s->ray_count * sizeof **slots;
    *slots = ARENA_NEW(&s->arena, uint32_t, s->ray_count + 1);
    return *slots ? gpu_download(r->gpu, &r->buffers[BINDING_QUEUES], queue_offset(r, queue),
                                 *slots, bytes, err)
                  : err_memory(err, "queue", bytes);
}

static int compare_slots(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static bool same_rays(const struct setup *s, const uint32_t *sorted)
{
    uint64_t bytes = s->ray_count * sizeof *sorted;
    uint32_t *a = malloc(bytes + 1), *b = malloc(bytes + 1);
    bool same = false;
    if (a && b) {
        memcpy(a, s->slots, bytes);
        memcpy(b, sorted, bytes);
        qsort(a, s->ray_count, sizeof *a, compare_slots);
        qsort(b, s->ray_count, sizeof *b, compare_slots);
        same = memcmp(a, b, bytes) == 0;
    }
    free(a);
    free(b);
    return same;
}

// Computes the key in double precision, bit by bit: the octant, then the bits of the cell, x last.
// Returns false if rounding may have put the ray into the neighbouring cell.
static bool find_key(const struct setup *s, const struct gpu_path *path, uint32_t *key)
{
    const struct flat_scene *flat = &s->r.flat;
    const double cells = 1u << SORT_CELL_BITS;
    bool is_sure = true;
    *key = 0;
    for (int c = 0; c < 3; c++) {
        double low = (double)flat->bounds_min[c];
        double extent = (double)flat->bounds_max[c] - low;
        double place = extent > 0.0 ? ((double)path->origin[c] - low) / extent * cells : 0.0;
        double cell = floor(fmin(fmax(place, 0.0), cells - 1.0));
        // 2^-20 of the scene is three times the rounding error of single precision. Places beyond
        // the outer borders belong to the outermost cells.
        double border = round(place);
        is_sure &= border < 1.0 || border >= cells || fabs(place - border) > cells * 0x1p-20;
        for (int bit = 0; bit < SORT_CELL_BITS; bit++)
            *key |= ((uint32_t)cell >> bit & 1u) << (3 * bit + c);
        *key |= (path->direction[c] < 0.0f ? 1u : 0u) << (3 * SORT_CELL_BITS + c);
    }
    return is_sure;
}

static bool check_order(struct setup *s, const uint32_t *sorted, struct err *err)
{
    struct renderer *r = &s->r;
    uint64_t words = 4 * PATH_WORDS_OF(r->specialization.geometry, r->specialization.integrator), slots = r->plan.wave_slots;
    uint32_t *paths = ARENA_NEW(&s->arena, uint32_t, slots * words);
    if (!paths)
        return err_memory(err, "paths", slots * words * 4);
    if (!gpu_download(r->gpu, &r->buffers[BINDING_PATHS], 0, paths, slots * words * 4, err))
        return false;
    uint32_t last = 0;
    for (uint32_t i = 0; i < s->ray_count; i++) {
        struct gpu_path path;
        uint32_t expected, key = paths[sorted[i] * words + 4 * PATH_HIT];
        memcpy(&path, &paths[sorted[i] * words], sizeof path);
        CHECK(key >= last && key < SORT_KEYS, "ray %u has key %u behind %u", i, key, last);
        last = key;
        s->keys_used[key % SORT_KEYS] = true;
        bool is_sure = find_key(s, &path, &expected);
        s->compared += is_sure;
        s->near_borders += !is_sure;
        CHECK(!is_sure || key == expected, "slot %u: key %u, expected %u", sorted[i], key,
              expected);
    }
    return true;
}

static bool look_before(void *context, const struct wave_step *step, struct err *err)
{
    struct setup *s = context;
    const struct gpu_dispatch *dispatches = s->r.counters->dispatch;
    if (step->kernel == KERNEL_intersect_closest && step->bounce >= SORT_FIRST_BOUNCE)
        CHECK(step->queue == s->sorted_queue &&
                  dispatches[step->queue * DISPATCH_PARTS].items == s->ray_count,
              "bounce %u: %u rays of queue %u are traced, and %u of queue %u were sorted",
              step->bounce, dispatches[step->queue * DISPATCH_PARTS].items, step->queue,
              s->ray_count, s->sorted_queue);
    if (step->kernel != KERNEL_sort_count)
        return true;
    CHECK(step->bounce >= SORT_FIRST_BOUNCE, "sorted at bounce %u", step->bounce);
    s->ray_count = dispatches[step->queue * DISPATCH_PARTS].items;
    s->sorted_queue = 2 * QUEUE_RAYS + 1 - step->queue;
    return read_queue(s, step->queue, &s->slots, err);
}

static bool look_after(void *context, const struct wave_step *step, struct err *err)
{
    struct setup *s = context;
    uint32_t *sorted;
    if (step->kernel != KERNEL_sort_scatter)
        return true;
    if (!read_queue(s, s->sorted_queue, &sorted, err))
        return false;
    CHECK(same_rays(s, sorted), "bounce %u: other rays than before", step->bounce);
    s->sorted_queues++;
    s->sorted_rays += s->ray_count;
    return check_order(s, sorted, err);
}

static void check_scene(const char *path, uint32_t least_keys)
{
    struct setup s = {0};
    struct err err = {0};
    OPEN_GPU(&s.gpu, .validation = false);
    REQUIRE_OK(setup_create(&s, path, &err));
    const struct wave_observer observer = {look_before, look_after, &s};
    const struct render_call call = {.samples = SAMPLES, .observer = &observer};
    REQUIRE_OK(renderer_render(&s.r, &call, &err));
    uint32_t keys = 0;
    for (uint32_t i = 0; i < SORT_KEYS; i++)
        keys += s.keys_used[i];
    printf("  %-24s %5llu rays of %u queues, %u keys, %u rays at borders of cells\n", path,
           (unsigned long long)s.sorted_rays, s.sorted_queues, keys, s.near_borders);
    CHECK(s.sorted_queues > 0 && s.compared > s.near_borders && keys >= least_keys,
          "%s: %u queues, %u of %llu rays compared, %u keys", path, s.sorted_queues, s.compared,
          (unsigned long long)s.sorted_rays, keys);
    renderer_finish(&s.r);
    setup_finish(&s);
}

// A room; a room of instances; objects on an infinite plane; a scene under the open sky.
TEST(each_ray_is_where_its_key_says)
{
    check_scene("scenes/cornell.json", 100);
    check_scene("scenes/forest.json", 100);
    check_scene("scenes/sdf_csg.json", 20);
    check_scene("scenes/all_classes.json", 100);
}

static void check_choice(struct setup *s, const char *what, uint32_t max_bounces, bool expected)
{
    struct renderer r;
    struct err err = {0};
    s->scene.settings.max_bounces = max_bounces;
    REQUIRE_OK(
        renderer_prepare(&(struct renderer_params){.gpu = &s->gpu, .scene = &s->scene}, &r, &err));
    CHECK(r.specialization.sort_rays == expected, "%s: %s", what,
          expected ? "not sorted" : "sorted");
    for (int id = KERNEL_sort_count; id <= KERNEL_sort_scatter; id++)
        CHECK(specialization_needs_kernel(&r.specialization, (enum kernel_id)id) == expected,
              "%s: kernel %d", what, id);
    uint64_t bytes = r.plan.buffers[BINDING_SORT].bytes;
    CHECK(bytes == (expected ? sizeof(struct gpu_sort) : 0), "%s: %llu bytes to sort with", what,
          (unsigned long long)bytes);
    renderer_finish(&r);
}

TEST(chosen_by_the_device)
{
    struct setup s = {0};
    struct err err = {0};
    OPEN_GPU(&s.gpu, .validation = false);
    REQUIRE_OK(load_scene("scenes/cornell.json", NULL, &s.scene, &err));
    const struct gpu gpu = s.gpu;
    s.gpu.params.limits.sort_rays = false;
    s.gpu.info.is_cpu = true;
    check_choice(&s, "CPU", 9, false);
    s.gpu.info.is_cpu = false;
    check_choice(&s, "GPU", 9, true);
    check_choice(&s, "GPU, two bounces", SORT_FIRST_BOUNCE, true);
    check_choice(&s, "GPU, one bounce", SORT_FIRST_BOUNCE - 1, false);
    s.scene.settings.integrator = INTEGRATOR_AO;
    check_choice(&s, "GPU, ambient occlusion", 9, false);
    s.gpu.params.limits.sort_rays = true;
    s.gpu.info.is_cpu = true;
    s.scene.settings.integrator = INTEGRATOR_PATH;
    check_choice(&s, "CPU that is asked to", 9, true);
    s.gpu = gpu;
    setup_finish(&s);
}

TEST_MAIN(TEST_CASE(each_ray_is_where_its_key_says), TEST_CASE(chosen_by_the_device))
