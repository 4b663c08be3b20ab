// Measures the time of building, the quality of the tree, and the number of traversal steps per
// ray, for each builder and kind of nodes: on a procedural mesh of a million triangles, and on
// scanned meshes if they are available.
#include "bvh_trace.h"
#include "meshes.h"

#include <math.h>
#include <stdio.h>
#include <time.h>

enum { REPEATS = 3, RAYS = 20000 };

// Makes a ray from a vertex to another one, with both ends outside.
static struct bvh_ray some_ray(const struct mesh *mesh, struct random *random)
{
    struct bvh_ray ray = {.t_max = INFINITY, .ignore = {UINT32_MAX, UINT32_MAX}};
    const float *from = mesh->vertices[random_u32(random) % mesh->count][0];
    const float *to = mesh->vertices[random_u32(random) % mesh->count][1];
    for (int axis = 0; axis < 3; axis++) {
        double direction = (double)to[axis] - (double)from[axis];
        ray.origin[axis] = (double)from[axis] - 2 * direction;
        ray.direction[axis] = direction;
    }
    ray.direction[0] += 1e-30; // the two vertices may be the same
    return ray;
}

static void count_steps(const struct bvh_trace_scene *scene, const struct mesh *mesh, double *nodes,
                        double *tests)
{
    struct random random = {1};
    uint64_t sums[2] = {0, 0};
    for (int i = 0; i < RAYS; i++) {
        struct bvh_ray ray = some_ray(mesh, &random);
        struct bvh_hit hit;
        bvh_trace_closest(scene, &ray, &hit);
        sums[0] += hit.nodes_visited;
        sums[1] += hit.primitives_tested;
    }
    *nodes = (double)sums[0] / RAYS;
    *tests = (double)sums[1] / RAYS;
}

static int measure(const char *name, const struct mesh *mesh, struct bvh_method method)
{
    static const char *const splits[] = {"SAH", "median", "mean", "spatial"};
    static const char *const efforts[] = {"", "off", "long"};
    static const char *const formats[] = {"quantised", "float"};
    double best = INFINITY, best_cpu = INFINITY, nodes = 0, tests = 0;
    double duplicates = 0;
    struct bvh_stats stats = {0};
    for (int i = 0; i < REPEATS; i++) {
        struct arena arena = {0};
        struct bvh bvh;
        struct err err;
        struct bvh_params params = mesh_params(mesh);
        params.method = method;
        clock_t start = clock(); // processor time of all threads, which on a busy machine is more
                                 // meaningful than elapsed time
        if (!bvh_build(&params, &arena, &bvh, &err)) {
            fprintf(stderr, "%s: %s\n", name, err.msg);
            return 1;
        }
        stats = bvh.stats;
        duplicates = 100.0 * (bvh.reference_count - bvh.triangle_count) / bvh.triangle_count;
        best = fmin(best, stats.build_seconds);
        best_cpu = fmin(best_cpu, (double)(clock() - start) / CLOCKS_PER_SEC);
        if (i == 0)
            count_steps(&(struct bvh_trace_scene){.bvh = &bvh, .geometry = &params}, mesh, &nodes,
                        &tests);
        arena_finish(&arena);
    }
    printf("%-18s %7u triangles  %-7s %-4s %-9s  %6.3f s, %6.3f of CPU time  SAH cost %7.3f  depth "
           "%2u  "
           "stack %2u  %7u nodes  %7u leaves  %6.1f MB  %6.2f nodes and %6.2f tests a ray  %5.1f "
           "%% duplicates\n",
           name, mesh->count, splits[method.split], efforts[method.optimize],
           formats[method.format], best, best_cpu, stats.sah_cost, stats.depth, stats.stack_entries,
           stats.node_count, stats.leaf_count, (double)stats.bytes * 1e-6, nodes, tests,
           duplicates);
    fflush(stdout);
    return 0;
}

static int measure_all(const char *name, const struct mesh *mesh)
{
    int status = 0;
    for (uint32_t split = BVH_SPLIT_SAH; split <= BVH_SPLIT_MEAN; split++)
        for (uint32_t format = BVH_QUANTISED; format <= BVH_FLOAT; format++)
            status |= measure(name, mesh, (struct bvh_method){split, format});
    for (uint32_t split = BVH_SPLIT_SAH; split <= BVH_SPLIT_SPATIAL; split += BVH_SPLIT_SPATIAL)
        for (uint32_t optimize = split == BVH_SPLIT_SAH ? BVH_OPTIMIZE_OFF : BVH_OPTIMIZE_NORMAL;
             optimize <= BVH_OPTIMIZE_LONG; optimize++)
            status |= measure(name, mesh, (struct bvh_method){split, BVH_QUANTISED, optimize});
    return status;
}

int main(void)
{
    static const char *const files[] = {"nefertiti.obj", "stanford-bunny.obj"};
    struct arena arena = {0};
    struct mesh mesh = mesh_grid(&arena, 707);
    int status = measure_all("grid", &mesh);
    mesh = mesh_soup(&arena, 100000, 0.05, 1);
    status |= measure_all("soup", &mesh);
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
        if (mesh_load(&arena, files[i], &mesh))
            status |= measure_all(files[i], &mesh);
    mesh = mesh_among_beams(&arena, 200, 300);
    status |= measure_all("sphere, beams", &mesh);
    mesh = mesh_strands(&arena, 3000, 20);
    status |= measure_all("strands", &mesh);
    arena_finish(&arena);
    return status;
}
