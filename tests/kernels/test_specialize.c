// What a scene does not need is left out: pairs of tiny scenes, with and without one need. Of the
// first, the Vulkan objects must be there; of the second they must be gone, and nothing else.
#include "kernel_fixture.h"
#include "replay.h"

#define BIT(n) (1u << (n))

// What a tiny scene has.
enum {
    QUAD = BIT(0),
    SPHERE = BIT(1),
    DISC = BIT(2),
    SMOOTH = BIT(3),        // the quad has normals
    MIRROR_QUAD = BIT(4),   // the quad is a mirror, not diffuse
    MIRROR_SPHERE = BIT(5), // the sphere likewise
    BRIGHT_QUAD = BIT(6),   // the quad emits
    BRIGHT_SPHERE = BIT(7), // the sphere emits
    BRIGHT_DISC = BIT(8),   // the disc emits
    SKY = BIT(9),           // a constant environment
    SKY_IMAGE = BIT(10),    // an image of one
    JITTER = BIT(11),
    ROULETTE = BIT(12),
    ONLY_BSDF = BIT(13),
    ONLY_NEE = BIT(14),
    NO_BOUNCE = BIT(15),
    SPARE_MIRROR = BIT(16), // a material that nothing is made of
};

static void make_scene(uint32_t has, struct scene *scene)
{
    static const float quad[2][3][3] = {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}},
                                        {{-1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}};
    static const float normals[2][3][3] = {{{-0.6f, 0, 0.8f}, {0.6f, 0, 0.8f}, {0.6f, 0, 0.8f}},
                                           {{-0.6f, 0, 0.8f}, {0.6f, 0, 0.8f}, {-0.6f, 0, 0.8f}}};
    static const struct {
        uint32_t bit, mirror, bright;
    } parts[] = {{QUAD, MIRROR_QUAD, BRIGHT_QUAD},
                 {SPHERE, MIRROR_SPHERE, BRIGHT_SPHERE},
                 {DISC, 0, BRIGHT_DISC}};
    scene_start(scene, 16, 16);
    for (int i = 0; i < 3; i++) {
        if (!(has & parts[i].bit))
            continue;
        struct material material = {
            .name = "part",
            .model = has & parts[i].mirror ? MATERIAL_MIRROR : MATERIAL_LAMBERT,
            .base_color = {0.5f, 0.6f, 0.7f},
        };
        for (int c = 0; c < 3 && (has & parts[i].bright); c++)
            material.emission[c] = 2;
        uint32_t index = add_material(scene, &material);
        if (parts[i].bit == QUAD)
            add_smooth_triangles(scene, quad, has & SMOOTH ? normals : NULL, 2, index);
        else if (parts[i].bit == SPHERE)
            add_sphere(scene, (double[3]){0.3, 0.2, 1}, 0.4, index);
        else
            add_disc(scene, (double[3]){-0.5, 0.8, 1}, (double[3]){1, -1, 1}, 0.3, index);
    }
    if (has & SPARE_MIRROR)
        add_material(scene, &(struct material){.name = "spare", .model = MATERIAL_MIRROR});
    if (has & SKY)
        scene->environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    if (has & SKY_IMAGE)
        add_environment_image(scene, 4, 2);
    struct settings *settings = &scene->settings;
    settings->pixel_jitter = has & JITTER;
    settings->roulette_min_bounces = has & ROULETTE ? 1 : UINT32_MAX;
    settings->max_bounces = has & NO_BOUNCE ? 0 : 4;
    settings->estimator = has & ONLY_BSDF  ? ESTIMATOR_BSDF
                          : has & ONLY_NEE ? ESTIMATOR_NEE
                                           : ESTIMATOR_MIS;
}

// What was made for a scene.
struct inventory {
    uint32_t features; // of the scene
    uint32_t kernels;  // bits by enum kernel_id: pipelines
    uint32_t buffers;  // bits by binding: VkBuffers
    uint32_t planned;  // bits by binding: in the memory plan
    uint64_t queue_rows, plan_bytes;
};

static struct inventory take_inventory(const struct renderer *r)
{
    struct inventory out = {.plan_bytes = r->plan.total_bytes};
    for (uint32_t bit = 0; bit < 32; bit++)
        if (feature_name(BIT(bit)))
            out.features |= r->specialization.features & BIT(bit);
    for (int id = 0; id < KERNEL_COUNT; id++)
        out.kernels |= r->kernels[id].pipeline ? BIT(id) : 0;
    for (uint32_t b = 0; b < BINDING_COUNT; b++) {
        bool created = b == BINDING_FILM ? r->film[0].handle : r->buffers[b].handle;
        out.buffers |= created ? BIT(b) : 0;
        out.planned |= r->plan.buffers[b].name ? BIT(b) : 0;
    }
    out.queue_rows = r->buffers[BINDING_QUEUES].bytes / (4 * (uint64_t)r->plan.wave_slots);
    return out;
}

static bool make(struct gpu *gpu, uint32_t has, bool everything, struct inventory *out)
{
    struct scene scene;
    struct renderer r;
    struct err err = {0};
    make_scene(has, &scene);
    const struct renderer_params params = {
        .gpu = gpu, .scene = &scene, .wave = 1024, .everything = everything};
    bool ok = renderer_create(&params, &r, &err);
    CHECK(ok, "%s", err.msg);
    if (ok)
        *out = take_inventory(&r);
    renderer_finish(&r);
    scene_finish(&scene);
    return ok;
}

struct pair {
    const char *name;
    uint32_t with, without;
    // What goes with the need, and nothing else.
    uint32_t features, kernels, buffers;
    uint32_t queue_rows;
};

#define SHADOW_KERNELS BIT(KERNEL_intersect_shadow)
#define SHADOW_BUFFERS (BIT(BINDING_EMITTERS) | BIT(BINDING_SHADOW_RAYS))

static const struct pair pairs[] = {
    {"triangles", QUAD | SPHERE, SPHERE, FEATURE_TRIANGLES, 0, BIT(BINDING_TRIANGLES), 0},
    {"spheres", QUAD | SPHERE, QUAD, FEATURE_SPHERES, 0, BIT(BINDING_SHAPES), 0},
    {"discs", QUAD | DISC, QUAD, FEATURE_DISCS, 0, BIT(BINDING_SHAPES), 0},
    {"spheres beside discs", DISC | SPHERE, DISC, FEATURE_SPHERES, 0, 0, 0},
    {"normals", QUAD | SMOOTH, QUAD, FEATURE_NORMALS, 0, BIT(BINDING_ATTRIBUTES), 0},
    {"diffuse", QUAD | SPHERE | MIRROR_SPHERE, QUAD | MIRROR_QUAD | SPHERE | MIRROR_SPHERE,
     0, 0, 0, 0},
    {"diffuse to connect with", QUAD | SPHERE | BRIGHT_SPHERE | MIRROR_SPHERE,
     QUAD | MIRROR_QUAD | SPHERE | BRIGHT_SPHERE | MIRROR_SPHERE, FEATURE_NEE,
     SHADOW_KERNELS, SHADOW_BUFFERS, 1},
    {"mirror", QUAD | SPHERE | MIRROR_SPHERE, QUAD | SPHERE | SPARE_MIRROR, 0, 0, 0,
     0},
    {"emissive triangles", QUAD | BRIGHT_QUAD, QUAD,
     FEATURE_EMISSION | FEATURE_EMISSIVE_TRIANGLES | FEATURE_NEE, SHADOW_KERNELS, SHADOW_BUFFERS,
     1},
    {"emissive spheres", QUAD | SPHERE | BRIGHT_SPHERE, QUAD | SPHERE,
     FEATURE_EMISSION | FEATURE_EMISSIVE_SPHERES | FEATURE_NEE, SHADOW_KERNELS, SHADOW_BUFFERS, 1},
    {"emissive discs", QUAD | DISC | BRIGHT_DISC, QUAD | DISC,
     FEATURE_EMISSION | FEATURE_EMISSIVE_DISCS | FEATURE_NEE, SHADOW_KERNELS, SHADOW_BUFFERS, 1},
    {"emissive triangles beside spheres", QUAD | BRIGHT_QUAD | SPHERE | BRIGHT_SPHERE,
     QUAD | SPHERE | BRIGHT_SPHERE, FEATURE_EMISSIVE_TRIANGLES, 0, 0, 0},
    {"emissive spheres beside triangles", QUAD | BRIGHT_QUAD | SPHERE | BRIGHT_SPHERE,
     QUAD | BRIGHT_QUAD | SPHERE, FEATURE_EMISSIVE_SPHERES, 0, 0, 0},
    {"emissive discs beside triangles", QUAD | BRIGHT_QUAD | DISC | BRIGHT_DISC,
     QUAD | BRIGHT_QUAD | DISC, FEATURE_EMISSIVE_DISCS, 0, 0, 0},
    {"next-event estimation", QUAD | BRIGHT_QUAD, QUAD | BRIGHT_QUAD | ONLY_BSDF, FEATURE_NEE,
     SHADOW_KERNELS, SHADOW_BUFFERS, 1},
    {"a bounce to connect from", QUAD | BRIGHT_QUAD, QUAD | BRIGHT_QUAD | NO_BOUNCE, FEATURE_NEE,
     SHADOW_KERNELS, SHADOW_BUFFERS, 1},
    {"emitters hit by the BSDF", QUAD | BRIGHT_QUAD, QUAD | BRIGHT_QUAD | ONLY_NEE,
     FEATURE_BSDF_HITS_EMITTERS, 0, 0, 0},
    {"environment", QUAD | SKY, QUAD, FEATURE_ENVIRONMENT, BIT(KERNEL_shade_miss), 0, 1},
    {"environment image", QUAD | SKY_IMAGE, QUAD | SKY, FEATURE_ENVIRONMENT_IMAGE, 0,
     BIT(BINDING_ENVIRONMENT), 0},
    {"roulette", QUAD | ROULETTE, QUAD, FEATURE_ROULETTE, 0, 0, 0},
    {"jitter", QUAD | JITTER, QUAD, FEATURE_JITTER, 0, 0, 0},
    {"surfaces", QUAD | SKY, SKY, FEATURE_TRIANGLES, BIT(KERNEL_shade_surface),
     BIT(BINDING_TRIANGLES) | BIT(BINDING_MATERIALS), 0},
    {"anything to see", SKY, 0, FEATURE_ENVIRONMENT,
     BIT(KERNEL_shade_miss) | BIT(KERNEL_intersect_closest), 0, 1},
};

static void check_pair(struct gpu *gpu, const struct pair *pair)
{
    struct inventory with, without;
    if (!make(gpu, pair->with, false, &with) || !make(gpu, pair->without, false, &without))
        return;
    CHECK(with.features == (without.features | pair->features) &&
              !(without.features & pair->features),
          "%s: features 0x%x and 0x%x", pair->name, with.features, without.features);
    CHECK(with.kernels == (without.kernels | pair->kernels) && !(without.kernels & pair->kernels),
          "%s: kernels 0x%x and 0x%x", pair->name, with.kernels, without.kernels);
    CHECK(with.buffers == (without.buffers | pair->buffers) && !(without.buffers & pair->buffers),
          "%s: buffers 0x%x and 0x%x", pair->name, with.buffers, without.buffers);
    CHECK(with.planned == with.buffers && without.planned == without.buffers,
          "%s: plan 0x%x, 0x%x; buffers 0x%x, 0x%x", pair->name, with.planned, without.planned,
          with.buffers, without.buffers);
    CHECK(with.queue_rows == without.queue_rows + pair->queue_rows, "%s: %llu and %llu queues",
          pair->name, (unsigned long long)with.queue_rows, (unsigned long long)without.queue_rows);
    bool shrinks = pair->buffers || pair->queue_rows;
    CHECK(!shrinks || with.plan_bytes > without.plan_bytes, "%s: %llu bytes planned, not fewer",
          pair->name, (unsigned long long)without.plan_bytes);

    printf("  %-34s %d kernels, %8lld bytes fewer", pair->name, __builtin_popcount(pair->kernels),
           (long long)(with.plan_bytes - without.plan_bytes));
    for (uint32_t bit = 0; bit < 32; bit++)
        if (pair->features >> bit & 1u)
            printf(", %s", feature_name(BIT(bit)));
    putchar('\n');
}

TEST(each_need)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
        check_pair(&gpu, &pairs[i]);
    gpu_close(&gpu);
}

// Every feature with a name is removed by some pair.
TEST(no_feature_is_forgotten)
{
    uint32_t seen = 0, named = 0;
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
        seen |= pairs[i].features;
    for (uint32_t bit = 0; bit < 32; bit++)
        named |= feature_name(BIT(bit)) ? BIT(bit) : 0;
    CHECK(seen == named, "tested 0x%x, named 0x%x", seen, named);
}

TEST(everything_is_created_on_demand)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    struct inventory empty, all;
    if (make(&gpu, 0, false, &empty) && make(&gpu, JITTER, true, &all)) {
        CHECK(all.kernels == BIT(KERNEL_COUNT) - 1, "kernels 0x%x", all.kernels);
        CHECK(all.buffers == ((BIT(BINDING_COUNT) - 1) & ~BIT(BINDING_SUSPENDED)), "buffers 0x%x",
              all.buffers);
        for (uint32_t bit = 0; bit < 32; bit++)
            CHECK(!feature_name(BIT(bit)) || (all.features >> bit & 1u), "%s is left out",
                  feature_name(BIT(bit)));
        CHECK(all.queue_rows == 5 && empty.queue_rows == 3, "%llu and %llu queues",
              (unsigned long long)all.queue_rows, (unsigned long long)empty.queue_rows);
    }
    gpu_close(&gpu);
}

// --- the same picture ----------------------------------------------------------------------------

static bool render(struct gpu *gpu, const struct scene *scene, bool everything, struct arena *arena,
                   struct film_image *image)
{
    struct renderer r;
    struct err err = {0};
    const struct renderer_params params = {
        .gpu = gpu, .scene = scene, .wave = 1024, .everything = everything};
    bool ok = renderer_create(&params, &r, &err) &&
              renderer_render(&r, &(struct render_call){.samples = 8}, &err) &&
              renderer_read(&r, arena, image, &err);
    CHECK(ok, "%s", err.msg);
    renderer_finish(&r);
    return ok;
}

// Compiled in or left out changes no bit, where the driver compiles the rest alike (lavapipe).
TEST(everything_changes_no_bit)
{
    static const uint32_t scenes[] = {QUAD | SKY, QUAD | BRIGHT_QUAD | JITTER,
                                      QUAD | SMOOTH | SPHERE | BRIGHT_SPHERE | ROULETTE,
                                      SPHERE | DISC | BRIGHT_DISC | MIRROR_SPHERE | SKY_IMAGE};
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0] && gpu.info.is_cpu; i++) {
        struct scene scene;
        struct arena arena = {0};
        struct film_image lean, full;
        make_scene(scenes[i], &scene);
        if (render(&gpu, &scene, false, &arena, &lean) &&
            render(&gpu, &scene, true, &arena, &full)) {
            size_t size = 16 * 16 * sizeof *lean.half_a;
            CHECK(memcmp(lean.half_a, full.half_a, size) == 0 &&
                      memcmp(lean.half_b, full.half_b, size) == 0,
                  "scene 0x%x", scenes[i]);
        }
        arena_finish(&arena);
        scene_finish(&scene);
    }
    gpu_close(&gpu);
}

// --- suspended traversals ------------------------------------------------------------------------

// More identical triangles than a ray's budget: only then are there a buffer and two queues for
// traversals that go on later.
TEST(suspended_traversals_are_made_when_needed)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    static const float triangle[3][3] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    struct scene scene;
    struct renderer r;
    struct err err = {0};
    scene_start(&scene, 1, 1);
    scene.settings.pixel_jitter = false;
    scene.environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    bool ok = renderer_create(&(struct renderer_params){.gpu = &gpu, .scene = &scene}, &r, &err);
    uint32_t count = ok ? r.specialization.iteration_budget + 1000 : 1;
    renderer_finish(&r);
    float(*triangles)[3][3] = malloc(count * sizeof *triangles);
    for (uint32_t i = 0; triangles && i < count; i++)
        memcpy(triangles[i], triangle, sizeof triangle);
    if (triangles)
        add_triangles(&scene, (const float(*)[3][3])triangles, count, 0);
    ok = ok && triangles &&
         renderer_create(&(struct renderer_params){.gpu = &gpu, .scene = &scene}, &r, &err);
    if (ok) {
        struct inventory before = take_inventory(&r);
        CHECK(!(before.buffers & BIT(BINDING_SUSPENDED)), "created too soon");
        ok = renderer_render(&r, &(struct render_call){.samples = 1}, &err);
        struct inventory after = take_inventory(&r);
        CHECK(after.buffers == (before.buffers | BIT(BINDING_SUSPENDED)), "buffers 0x%x and 0x%x",
              before.buffers, after.buffers);
        CHECK(after.queue_rows == before.queue_rows + 2, "%llu and %llu queues",
              (unsigned long long)before.queue_rows, (unsigned long long)after.queue_rows);
        struct arena arena = {0};
        struct replay path = {0};
        bool followed = renderer_replay(&r, 0, 0, 0, &arena, &path, &err);
        CHECK(followed && path.vertex_count > 0 && path.vertices[0].primitive == 0,
              "not the lowest of the identical triangles");
        arena_finish(&arena);
        CHECK(r.stats.suspended > 0 && r.stats.voided_waves == 1, "%llu suspended",
              (unsigned long long)r.stats.suspended);
    }
    CHECK(ok, "%s", err.msg);
    free(triangles);
    renderer_finish(&r);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(each_need), TEST_CASE(no_feature_is_forgotten),
          TEST_CASE(everything_is_created_on_demand), TEST_CASE(everything_changes_no_bit),
          TEST_CASE(suspended_traversals_are_made_when_needed))
