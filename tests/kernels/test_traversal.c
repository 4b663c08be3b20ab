// Tests intersect_closest and intersect_shadow on the device against the CPU reference in double
// precision: on scenes and rays of every kind, read from storage or texel buffers, with and without
// ballot, for any BVH.
//
// Two results agree if both are misses, or if both hit the same primitive at distances that differ
// by at most 1e-5 of the distance plus 1e-6 of the scene's extent: about 16 rounding errors of the
// largest coordinate relative to the ray's origin, the error for a triangle that is neither a
// sliver nor seen edge-on. If they do not agree, traversal_judge.h decides whether rounding in
// single precision explains it, which must always be so. How often this may happen is bounded for
// each scene.
#include "traversal_judge.h"
#include "traversal_scenes.h"

enum { RAYS = 12288 }; // rays per scene and kernel
enum { MOST_EXPLAINED = RAYS / 1024 };

// Reading through texel buffers, using ballot, the place of the stack, and the BVH must not change
// any bit.
struct variant {
    const char *name;
    struct gpu_limit_overrides limits;
    struct bvh_method bvh;
};
static const struct variant variants[] = {
    {"texel reads, ballot", {0}},
    {"texel reads, no ballot", {.no_ballot = true}},
    {"storage reads, ballot", {.no_texel = true}},
    {"storage reads, no ballot", {.no_texel = true, .no_ballot = true}},
    {"three entries of the stack in shared memory", {.shared_stack = true, .shared_memory = 2048}},
    {"float nodes by texel reads", .bvh = {BVH_SPLIT_MEDIAN, BVH_FLOAT}},
    {"float nodes by storage reads", {.no_texel = true}, {BVH_SPLIT_MEAN, BVH_FLOAT}},
    {"leaves of 8", .bvh = {BVH_SPLIT_MIDDLE, .max_leaf = 8}},
};
enum { READS = 5, VARIANTS = sizeof variants / sizeof variants[0] };

static struct probe_ray rays[RAYS];
static struct probe_hit hits[VARIANTS][RAYS];

static uint32_t same_hits(const struct probe_hit *a, const struct probe_hit *b)
{
    uint32_t same = 0;
    for (uint32_t i = 0; i < RAYS; i++)
        same += a[i].primitive == b[i].primitive &&
                (a[i].primitive == NO_PRIMITIVE || memcmp(&a[i], &b[i], sizeof a[i]) == 0);
    return same;
}

// --- one kernel against the reference ------------------------------------------------------------

struct comparison {
    uint32_t hits;
    uint32_t explained;   // explained by rounding
    uint32_t delicate;    // those of delicate rays
    uint32_t unexplained; // errors
};

static double scene_extent(const struct flat_scene *flat)
{
    double diagonal[3];
    subtract(flat->bounds_max, flat->bounds_min, diagonal);
    return vec3_norm(diagonal);
}

static void print_ray(const char *what, const struct probe_ray *ray)
{
    fprintf(stderr, "%s: origin %a %a %a, direction %a %a %a\n", what, (double)ray->origin[0],
            (double)ray->origin[1], (double)ray->origin[2], (double)ray->direction[0],
            (double)ray->direction[1], (double)ray->direction[2]);
}

static uint32_t *explained_count(struct comparison *c, uint32_t ray)
{
    return ray_is_delicate(ray) ? &c->delicate : &c->explained;
}

static struct comparison compare_closest(const struct reference *reference,
                                         const struct probe_hit *results)
{
    struct comparison out = {0};
    double extent = scene_extent(reference->flat);
    for (uint32_t i = 0; i < RAYS; i++) {
        const struct bvh_ray ray = reference_ray(&rays[i], INFINITY);
        struct bvh_hit hit;
        bvh_trace_closest(&reference->scene, &ray, &hit);
        uint32_t primitive = results[i].primitive;
        double difference = fabs((double)results[i].t - hit.t);
        out.hits += primitive != NO_PRIMITIVE;
        if (primitive == hit.primitive &&
            (primitive == NO_PRIMITIVE || difference <= 1e-5 * hit.t + 1e-6 * extent))
            continue;
        if (judge_closest(reference->flat, &rays[i], &results[i])) {
            *explained_count(&out, i) += 1;
        } else if (out.unexplained++ == 0) {
            print_ray("closest", &rays[i]);
            fprintf(stderr, "  primitive 0x%x at %.9g; reference 0x%x at %.9g\n",
                    results[i].primitive, (double)results[i].t, hit.primitive, hit.t);
        }
    }
    return out;
}

static struct comparison compare_shadow(const struct reference *reference,
                                        const struct probe_hit *results)
{
    struct comparison out = {0};
    for (uint32_t i = 0; i < RAYS; i++) {
        const struct bvh_ray ray = reference_ray(&rays[i], 1);
        bool occluded = results[i].primitive != NO_PRIMITIVE;
        out.hits += occluded;
        if (occluded == bvh_trace_any(&reference->scene, &ray))
            continue;
        if (judge_occluded(reference->flat, &rays[i], occluded))
            *explained_count(&out, i) += 1;
        else if (out.unexplained++ == 0)
            print_ray(occluded ? "shadow, occluded" : "shadow, free", &rays[i]);
    }
    return out;
}

// --- a scene -------------------------------------------------------------------------------------

static void trace(struct renderer *r, enum kernel_id kernel, struct probe_hit *out)
{
    struct err err = {0};
    bool complete = true;
    double ms;
    for (uint32_t first = 0; first < RAYS; first += r->plan.wave_slots) {
        uint32_t count = RAYS - first < r->plan.wave_slots ? RAYS - first : r->plan.wave_slots;
        bool ok =
            ray_probe_trace(r, kernel, rays + first, count, out + first, &ms, &complete, &err);
        REQUIRE(ok && complete, "%s", ok ? "a ray ran out of its budget" : err.msg);
    }
}

static void report(const char *name, const char *kernel, const struct comparison *c)
{
    printf("  %-18s %-8s %5u hits; %u differ by rounding, and %u delicate ones\n", name, kernel,
           c->hits, c->explained, c->delicate);
    CHECK(c->unexplained == 0, "%s, %s: %u wrong results", name, kernel, c->unexplained);
    CHECK(c->explained <= MOST_EXPLAINED, "%s, %s: %u of %u", name, kernel, c->explained, RAYS);
    CHECK(c->hits > RAYS / 64 && c->hits < RAYS, "%s, %s: %u hits test little", name, kernel,
          c->hits);
}

// Traces the scene with the first `count` variants, and compares the first one with the reference.
static void check_variants(const char *name, struct scene *scene, enum kernel_id kernel, int count)
{
    bool shadow = kernel == KERNEL_intersect_shadow;
    for (int v = 0; v < count; v++) {
        struct gpu gpu;
        struct renderer r;
        struct err err = {0};
        OPEN_GPU(&gpu, .limits = variants[v].limits);
        const struct renderer_params params = {
            .gpu = &gpu, .scene = scene, .wave = RAYS, .bvh = variants[v].bvh};
        bool ok = renderer_create(&params, &r, &err);
        CHECK(ok, "%s", err.msg);
        if (ok && v == 0) {
            if (shadow)
                random_shadow_rays(&r.flat, RAYS, 7, rays);
            else
                random_closest_rays(&r.flat, RAYS, 5, rays);
        }
        if (ok)
            trace(&r, kernel, hits[v]);
        if (ok && v == 0) {
            struct arena arena = {0};
            struct reference reference;
            REQUIRE(reference_create(&r, &arena, &reference), "out of memory");
            struct comparison c =
                shadow ? compare_shadow(&reference, hits[v]) : compare_closest(&reference, hits[v]);
            report(name, shadow ? "shadow" : "closest", &c);
            arena_finish(&arena);
        }
        CHECK(!ok || same_hits(hits[0], hits[v]) == RAYS, "%s, %s: %u of %u results differ", name,
              variants[v].name, RAYS - same_hits(hits[0], hits[v]), RAYS);
        renderer_finish(&r);
        gpu_close(&gpu);
    }
}

static void check_scene(const char *name, struct scene *scene, int count)
{
    check_variants(name, scene, KERNEL_intersect_closest, count);
    // Without emitters there would be no shadow rays.
    for (uint32_t i = 0; i < scene->material_count; i++)
        scene->materials[i].emission[0] = 1;
    check_variants(name, scene, KERNEL_intersect_shadow, count);
}

static const double zero[3] = {0, 0, 0};

TEST(soup)
{
    struct scene scene;
    scene_start(&scene, 8, 8);
    add_soup(&scene, 2000, 1, 0.2, zero, 1);
    check_scene("soup", &scene, READS);
    scene_finish(&scene);
}

TEST(one_triangle)
{
    struct scene scene;
    scene_start(&scene, 8, 8);
    add_soup(&scene, 1, 1, 1, zero, 2);
    check_scene("one triangle", &scene, READS);
    scene_finish(&scene);
}

TEST(blob)
{
    struct scene scene;
    scene_start(&scene, 8, 8);
    REQUIRE(add_blob(&scene, 20000, 1, zero), "out of memory");
    check_scene("blob", &scene, READS);
    scene_finish(&scene);
}

TEST(shapes)
{
    struct scene scene;
    scene_start(&scene, 8, 8);
    add_spheres_and_discs(&scene, 300, 3);
    check_scene("shapes", &scene, READS);
    scene_finish(&scene);
}

TEST(mixed)
{
    struct scene scene;
    scene_start(&scene, 8, 8);
    add_soup(&scene, 500, 1, 0.2, zero, 4);
    add_spheres_and_discs(&scene, 200, 5);
    check_scene("mixed", &scene, VARIANTS);
    scene_finish(&scene);
}

TEST(slivers)
{
    struct scene scene;
    scene_start(&scene, 8, 8);
    add_slivers(&scene, 2000, 1e4, 6);
    check_scene("slivers", &scene, VARIANTS);
    scene_finish(&scene);
}

TEST(scales)
{
    static const struct {
        const char *name;
        double extent, center;
    } scales[] = {{"size 1e-3", 1e-3, 0}, {"size 1e5", 1e5, 0}, {"off centre", 10, 120}};
    for (int i = 0; i < 3; i++) {
        struct scene scene;
        double c = scales[i].center, e = scales[i].extent;
        scene_start(&scene, 8, 8);
        add_soup(&scene, 1000, e, 0.2 * e, (double[3]){c, -c, c / 2}, 7);
        check_scene(scales[i].name, &scene, READS);
        scene_finish(&scene);
    }
}

static void check_file(const char *name)
{
    struct scene scene;
    struct err err = {0};
    if (!load_mesh_file(name, &scene, &err))
        SKIP("%s (LAMPYRIS_DATA says where data is)", err.msg);
    check_scene(name, &scene, READS);
    scene_finish(&scene);
}

TEST(nefertiti)
{
    check_file("nefertiti.obj");
}

TEST(bunny)
{
    check_file("stanford-bunny.obj");
}

TEST_MAIN(TEST_CASE(soup), TEST_CASE(one_triangle), TEST_CASE(blob), TEST_CASE(shapes),
          TEST_CASE(mixed), TEST_CASE(slivers), TEST_CASE(scales), TEST_CASE(nefertiti),
          TEST_CASE(bunny))
