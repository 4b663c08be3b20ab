// Tests the steps that traversal kernels count, against walks through the same nodes on the CPU in
// double precision. A ray that hits nothing must enter every box that it meets, in any order, so
// the counts are equal, except for boxes that it only just meets, which are known in advance. A ray
// that hits must enter the boxes that begin before the hit, and may enter all.
#include "bvh/bvh_node.h"
#include "render/wave.h"
#include "traversal_judge.h"
#include "traversal_scenes.h"

enum { RAYS = 8000 };

// The margin of all planes, in units of the greatest distance to one. It exceeds the amount by
// which the kernel enlarges boxes: about 16 rounding errors of 2^-24 of two such distances.
#define MARGIN 1e-5

struct counts {
    uint64_t nodes, primitives;
};

// --- on the CPU ----------------------------------------------------------------------------------

// Returns whether the ray enters the box, enlarged by a fraction of its reach.
static bool enters(const struct probe_ray *ray, const double min[3], const double max[3],
                   double widen, double t_end)
{
    double reach = 0, first = 0, last = t_end;
    for (int c = 0; c < 3; c++)
        reach = fmax(reach, fmax(fabs(min[c] - (double)ray->origin[c]),
                                 fabs(max[c] - (double)ray->origin[c])));
    for (int c = 0; c < 3; c++) {
        double origin = (double)ray->origin[c], inverse = 1 / (double)ray->direction[c];
        double a = (min[c] - widen * reach - origin) * inverse;
        double b = (max[c] + widen * reach - origin) * inverse;
        first = fmax(first, fmin(a, b));
        last = fmin(last, fmax(a, b));
    }
    return first <= last;
}

static void add_counts(struct counts *sum, struct counts more)
{
    sum->nodes += more.nodes;
    sum->primitives += more.primitives;
}

// Counts everything that a ray enters up to t_end.
static struct counts walk(const struct bvh *bvh, const struct probe_ray *ray, double widen,
                          double t_end)
{
    struct counts counts = {0};
    uint32_t stack[4 * BVH_STACK_ENTRIES_MAX] = {0}, size = 1;
    while (size > 0) {
        uint32_t node = stack[--size];
        const uint32_t *child = bvh_children(bvh, node);
        counts.nodes++;
        for (uint32_t i = 0; i < bvh_child_count(child); i++) {
            double min[3], max[3];
            bvh_child_box(bvh, node, i, min, max);
            if (!enters(ray, min, max, widen, t_end))
                continue;
            if (bvh_child_is_leaf(child[i]))
                counts.primitives += bvh_leaf_count(bvh, child[i]);
            else
                stack[size++] = child[i];
        }
    }
    return counts;
}

// --- on the device -------------------------------------------------------------------------------

static struct counts counted(const struct renderer *r, enum kernel_id kernel)
{
    const uint32_t which = kernel == KERNEL_intersect_shadow ? STEPS_SHADOW : STEPS_CLOSEST;
    const uint32_t *nodes = r->counters->steps[which];
    const uint32_t *primitives = r->counters->steps[which + 1];
    return (struct counts){(uint64_t)nodes[1] << 32 | nodes[0],
                           (uint64_t)primitives[1] << 32 | primitives[0]};
}

static struct counts trace(struct renderer *r, enum kernel_id kernel, const struct probe_ray *rays,
                           uint32_t count)
{
    struct err err = {0};
    bool complete = true;
    double ms;
    bool ok = count == 0 || ray_probe_trace(r, kernel, rays, count, NULL, &ms, &complete, &err);
    CHECK(ok && complete, "%s", err.msg);
    return count > 0 ? counted(r, kernel) : (struct counts){0};
}

// --- both ----------------------------------------------------------------------------------------

// The rays, by what is known about their counts.
struct rays {
    struct probe_ray sure[RAYS], other[RAYS];
    uint32_t sure_count, other_count;
    struct counts exact;       // counts of rays whose counts are certain
    struct counts least, most; // bounds for the counts of the other rays
    struct counts reference;   // counts of the other rays by the CPU's own traversal
};

static void sort_ray(const struct renderer *r, const struct reference *reference, bool shadow,
                     const struct probe_ray *ray, struct rays *out)
{
    double end = shadow ? 1 : INFINITY;
    const struct bvh_ray exact = reference_ray(ray, end);
    struct bvh_hit hit;
    bvh_trace_closest(&reference->scene, &exact, &hit);
    struct counts least = walk(&r->bvh, ray, 0, end * (1 - MARGIN));
    struct counts most = walk(&r->bvh, ray, MARGIN, end * (1 + MARGIN));
    if (hit.primitive == UINT32_MAX && least.nodes == most.nodes &&
        least.primitives == most.primitives) {
        out->sure[out->sure_count++] = *ray;
        add_counts(&out->exact, most);
        return;
    }
    out->other[out->other_count++] = *ray;
    add_counts(&out->most, most);
    add_counts(&out->reference, (struct counts){hit.nodes_visited, hit.primitives_tested});
    if (shadow) // any hit ends a shadow ray
        least = (struct counts){1, hit.primitive != UINT32_MAX};
    else
        least = walk(&r->bvh, ray, 0, hit.t * (1 - MARGIN));
    add_counts(&out->least, least);
}

static struct rays rays;

static void make_rays(const struct renderer *r, bool shadow)
{
    struct random random = {11};
    struct arena arena = {0};
    struct reference reference;
    const struct flat_scene *flat = &r->flat;
    memset(&rays, 0, sizeof rays);
    REQUIRE(reference_create(r, &arena, &reference), "out of memory");
    for (uint32_t i = 0; i < RAYS; i++) {
        struct probe_ray ray;
        random_direction(&random, ray.direction);
        for (int c = 0; c < 3; c++) {
            double extent = (double)flat->bounds_max[c] - (double)flat->bounds_min[c];
            double at = random_between(&random, -0.3, 1.3);
            ray.origin[c] = (float)((double)flat->bounds_min[c] + at * extent);
            ray.direction[c] *= shadow ? 0.4f * (float)extent : 1.0f;
        }
        sort_ray(r, &reference, shadow, &ray, &rays);
    }
    arena_finish(&arena);
}

static void check_kernel(const char *name, struct renderer *r, enum kernel_id kernel)
{
    bool shadow = kernel == KERNEL_intersect_shadow;
    make_rays(r, shadow);
    struct counts sure = trace(r, kernel, rays.sure, rays.sure_count);
    struct counts other = trace(r, kernel, rays.other, rays.other_count);
    printf("  %-38s %-7s %5u rays: %8llu nodes, %8llu primitives; others %8llu nodes (at least "
           "%llu, at "
           "most %llu, on the CPU %llu)\n",
           name, shadow ? "shadow" : "closest", rays.sure_count, (unsigned long long)sure.nodes,
           (unsigned long long)sure.primitives, (unsigned long long)other.nodes,
           (unsigned long long)rays.least.nodes, (unsigned long long)rays.most.nodes,
           (unsigned long long)rays.reference.nodes);
    CHECK(rays.sure_count > RAYS / 8 && rays.other_count > RAYS / 32, "%s: %u and %u rays", name,
          rays.sure_count, rays.other_count);
    CHECK(sure.nodes == rays.exact.nodes, "%s: %llu nodes, not %llu", name,
          (unsigned long long)sure.nodes, (unsigned long long)rays.exact.nodes);
    CHECK(sure.primitives == rays.exact.primitives, "%s: %llu primitives, not %llu", name,
          (unsigned long long)sure.primitives, (unsigned long long)rays.exact.primitives);
    CHECK(other.nodes >= rays.least.nodes && other.nodes <= rays.most.nodes, "%s", name);
    CHECK(other.primitives >= rays.least.primitives && other.primitives <= rays.most.primitives,
          "%s: %llu primitives of others, %llu to %llu", name, (unsigned long long)other.primitives,
          (unsigned long long)rays.least.primitives, (unsigned long long)rays.most.primitives);
    // The CPU also skips nodes behind a hit found in the meantime, but visits them in the same
    // order, so it visits nearly as many.
    CHECK(shadow || ((double)other.nodes > 0.99 * (double)rays.reference.nodes &&
                     (double)other.nodes < 1.5 * (double)rays.reference.nodes),
          "%s: %llu nodes, on the CPU %llu", name, (unsigned long long)other.nodes,
          (unsigned long long)rays.reference.nodes);
}

static const struct variant {
    const char *name;
    bool no_texel, no_ballot;
    struct bvh_method bvh;
} variants[] = {
    {"", false, false, {0}},
    {", storage reads, no ballot", true, true, {0}},
    {", float nodes", false, false, {BVH_SPLIT_SAH, BVH_FLOAT}},
    {", leaves of 8", false, false, {.traversal_cost = 8, .max_leaf = 8}},
};

static bool open(struct setup *s, const struct variant *variant, struct err *err)
{
    const struct renderer_params params = {
        .gpu = &s->gpu, .scene = &s->scene, .wave = RAYS + 128, .bvh = variant->bvh};
    return renderer_create(&params, &s->r, err) && wave_count_steps(&s->r, true, err);
}

static void check_scene(const char *name, struct setup *s)
{
    // Without emitters there would be no shadow rays.
    s->scene.materials[0].emission[0] = 1;
    for (size_t v = 0; v < sizeof variants / sizeof variants[0]; v++) {
        char label[64];
        struct err err = {0};
        OPEN_GPU(&s->gpu,
                 .limits = {.no_texel = variants[v].no_texel, .no_ballot = variants[v].no_ballot});
        REQUIRE(open(s, &variants[v], &err), "%s", err.msg);
        snprintf(label, sizeof label, "%s%s", name, variants[v].name);
        check_kernel(label, &s->r, KERNEL_intersect_closest);
        check_kernel(label, &s->r, KERNEL_intersect_shadow);
        renderer_finish(&s->r);
        gpu_close(&s->gpu);
    }
    scene_finish(&s->scene);
}

TEST(soup)
{
    struct setup s = {0};
    scene_start(&s.scene, 8, 8);
    add_soup(&s.scene, 1000, 1, 0.1, (double[3]){0, 0, 0}, 1);
    check_scene("triangles", &s);
}

TEST(shapes)
{
    struct setup s = {0};
    scene_start(&s.scene, 8, 8);
    add_spheres_and_discs(&s.scene, 100, 3);
    check_scene("spheres and discs", &s);
}

// --- what is known exactly -----------------------------------------------------------------------

// With one node, each ray visits it, even if it meets no box. Threads beyond the last ray visit
// nothing.
TEST(one_node)
{
    static const float triangle[1][3][3] = {{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}};
    static struct probe_ray towards[1000], away[1000];
    struct setup s = {0};
    struct err err = {0};
    scene_start(&s.scene, 8, 8);
    add_triangles(&s.scene, triangle, 1, 0);
    OPEN_GPU(&s.gpu, .validation = false);
    REQUIRE(open(&s, &variants[0], &err), "%s", err.msg);
    for (int i = 0; i < 1000; i++) {
        float x = 0.1f + (float)i * 1e-4f;
        towards[i] = (struct probe_ray){{x, 0.05f, 2}, {0, 0, -1}};
        away[i] = (struct probe_ray){{x, 0.05f, 2}, {0, 0, 1}};
    }
    for (uint32_t count = 1; count <= 1000; count += 111) {
        struct counts hit = trace(&s.r, KERNEL_intersect_closest, towards, count);
        struct counts missed = trace(&s.r, KERNEL_intersect_closest, away, count);
        CHECK(hit.nodes == count && hit.primitives == count, "%u rays: %llu, %llu", count,
              (unsigned long long)hit.nodes, (unsigned long long)hit.primitives);
        CHECK(missed.nodes == count && missed.primitives == 0, "%u rays: %llu, %llu", count,
              (unsigned long long)missed.nodes, (unsigned long long)missed.primitives);
    }
    setup_close(&s);
}

// The scene has only an environment, so the root is empty.
TEST(no_surface)
{
    static struct probe_ray ups[100];
    struct setup s = {0};
    struct err err = {0};
    scene_start(&s.scene, 8, 8);
    s.scene.environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    OPEN_GPU(&s.gpu, .validation = false);
    REQUIRE(open(&s, &variants[0], &err), "%s", err.msg);
    for (int i = 0; i < 100; i++)
        ups[i] = (struct probe_ray){{0, 0, 0}, {0, 1, 0}};
    struct counts c = trace(&s.r, KERNEL_intersect_closest, ups, 100);
    CHECK(c.nodes == 100 && c.primitives == 0, "%llu, %llu", (unsigned long long)c.nodes,
          (unsigned long long)c.primitives);
    setup_close(&s);
}

// Counts have 64 bits, whose halves the device adds separately.
TEST(carry)
{
    static struct probe_ray ups[100];
    struct setup s = {0};
    struct err err = {0};
    scene_start(&s.scene, 8, 8);
    s.scene.environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    OPEN_GPU(&s.gpu, .validation = false);
    REQUIRE(open(&s, &variants[0], &err), "%s", err.msg);
    for (int i = 0; i < 100; i++)
        ups[i] = (struct probe_ray){{0, 0, 0}, {0, 1, 0}};
    trace(&s.r, KERNEL_intersect_closest, ups, 100);
    struct gpu_buffer *counters = &s.r.buffers[BINDING_QUEUES];
    s.r.counters->steps[STEPS_CLOSEST][0] = UINT32_MAX - 30;
    s.r.counters->steps[STEPS_CLOSEST][1] = 6;
    bool ok = gpu_upload(&s.gpu, counters, 0, s.r.counters, sizeof *s.r.counters, &err) &&
              run_kernel(&s.r, &s.r.kernels[KERNEL_intersect_closest], 100, &err) &&
              gpu_download(&s.gpu, counters, 0, s.r.counters, sizeof *s.r.counters, &err);
    CHECK(ok, "%s", err.msg);
    struct counts c = counted(&s.r, KERNEL_intersect_closest);
    CHECK(c.nodes == (UINT64_C(6) << 32) + UINT32_MAX - 30 + 100, "%llx",
          (unsigned long long)c.nodes);
    setup_close(&s);
}

TEST_MAIN(TEST_CASE(soup), TEST_CASE(shapes), TEST_CASE(one_node), TEST_CASE(no_surface),
          TEST_CASE(carry))
