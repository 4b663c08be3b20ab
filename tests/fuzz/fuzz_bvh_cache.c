// Fuzz target for the files of the BVH cache: the input as it is, and with sizes and checksums that
// pass the first checks. A tree that is accepted must be valid.
#include "bvh/bvh_cache.h"
#include "bvh_trace.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define TRIANGLES 12u

static void make_triangles(float vertices[TRIANGLES][3][3])
{
    for (uint32_t t = 0; t < TRIANGLES; t++)
        for (uint32_t corner = 0; corner < 3; corner++)
            for (uint32_t axis = 0; axis < 3; axis++)
                vertices[t][corner][axis] = (float)((t * 7 + corner * 5 + axis * 3) % 11);
}

static void load(const char *path, const struct bvh_params *params)
{
    struct arena arena = {0};
    struct bvh bvh;
    struct err err = {0};
    if (bvh_cache_load(path, params, &arena, &bvh, &err)) {
        const struct bvh_ray ray = {{-1, 3, 3}, {1, 0.1, 0.2}, 100, {UINT32_MAX, UINT32_MAX}};
        const struct bvh_trace_scene scene = {.bvh = &bvh, .geometry = params};
        struct bvh_hit hit, expected;
        bvh_trace_closest(&scene, &ray, &hit);
        bvh_trace_brute_force(&scene, &ray, &expected);
        if (hit.primitive != expected.primitive)
            abort();
    } else if (err.code == ERR_NONE || !err.msg[0]) {
        abort();
    }
    arena_finish(&arena);
}

// Writes a tree from the input: statistics, nodes, and the order of the triangles.
static bool save_tree(const char *path, const struct bvh_params *params, const uint8_t *data,
                      size_t size)
{
    struct bvh_node nodes[16] = {0};
    uint32_t order[64] = {0};
    struct bvh bvh = {.nodes = nodes, .triangle_order = order, .triangle_count = TRIANGLES};
    struct err err = {0};
    size_t head = sizeof bvh.stats + 2;
    if (size < head)
        return false;
    memcpy(&bvh.stats, data + 2, sizeof bvh.stats);
    bvh.node_count = data[0] % 17;
    bvh.reference_count = data[1] % 65;
    size_t left = size - head, tree = left < sizeof nodes ? left : sizeof nodes;
    memcpy(nodes, data + head, tree);
    memcpy(order, data + head + tree, left - tree < sizeof order ? left - tree : sizeof order);
    return bvh_cache_save(path, params, &bvh, &err);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    float vertices[TRIANGLES][3][3];
    char path[4096];
    const char *folder = getenv("TMPDIR");
    make_triangles(vertices);
    const struct bvh_params params = {.triangle_vertices = (const float(*)[3][3])vertices,
                                      .triangle_count = TRIANGLES};
    snprintf(path, sizeof path, "%s/lampyris-fuzz-%ld.bvh", folder ? folder : "/tmp",
             (long)getpid());
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file) != 0)
        abort();
    load(path, &params);
    if (save_tree(path, &params, data, size))
        load(path, &params);
    remove(path);
    return 0;
}
