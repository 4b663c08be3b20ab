// How long building takes and how good the tree is, on a procedural mesh of a million triangles and
// on scanned ones where they are at hand.
#include "bvh.h"
#include "meshes.h"

#include <stdio.h>

enum { REPEATS = 3 };

static int measure(const char *name, const struct mesh *mesh)
{
    double best = 0;
    struct bvh_stats stats = {0};
    for (int i = 0; i < REPEATS; i++) {
        struct arena arena = {0};
        struct bvh bvh;
        struct err err;
        struct bvh_params params = mesh_params(mesh);
        if (!bvh_build(&params, &arena, &bvh, &err)) {
            fprintf(stderr, "%s: %s\n", name, err.msg);
            return 1;
        }
        stats = bvh.stats;
        best = i == 0 || stats.build_seconds < best ? stats.build_seconds : best;
        arena_finish(&arena);
    }
    printf("%-20s %8u triangles  %6.3f s  %5.2f Mtris/s  SAH cost %7.3f  depth %2u  stack %2u  "
           "%7u nodes  %7u leaves  %6.1f MB\n",
           name, mesh->count, best, mesh->count / best * 1e-6, stats.sah_cost, stats.depth,
           stats.stack_entries, stats.node_count, stats.leaf_count, (double)stats.bytes * 1e-6);
    return 0;
}

int main(void)
{
    static const char *const files[] = {"nefertiti.obj", "stanford-bunny.obj"};
    struct arena arena = {0};
    struct mesh mesh = mesh_grid(&arena, 707);
    int status = measure("grid", &mesh);
    mesh = mesh_soup(&arena, 100000, 0.05, 1);
    status |= measure("soup", &mesh);
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
        if (mesh_load(&arena, files[i], &mesh))
            status |= measure(files[i], &mesh);
    arena_finish(&arena);
    return status;
}
