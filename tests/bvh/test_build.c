// Tests the builder: every tree is valid, its size is bounded, and it is the same for any number of
// threads. Also tests that the validation finds errors.
#include "bvh/bvh.h"
#include "meshes.h"
#include "test.h"

#include <float.h>

static const struct bvh_method ways[] = {
    {BVH_SPLIT_SAH, BVH_QUANTISED},
    {BVH_SPLIT_MEDIAN, BVH_QUANTISED},
    {BVH_SPLIT_MEAN, BVH_QUANTISED},
    {BVH_SPLIT_SAH, BVH_FLOAT},
    {BVH_SPLIT_MEDIAN, BVH_FLOAT},
    {BVH_SPLIT_MEAN, BVH_FLOAT},
    {BVH_SPLIT_SPATIAL, BVH_FLOAT},
    {BVH_SPLIT_SPATIAL, BVH_QUANTISED},
    {BVH_SPLIT_MIDDLE, BVH_FLOAT},
    {BVH_SPLIT_MIDDLE, BVH_QUANTISED},
    {.max_leaf = 8},
    {.split = BVH_SPLIT_MIDDLE, .max_leaf = 8},
    {.split = BVH_SPLIT_SPATIAL, .format = BVH_FLOAT, .max_leaf = 5},
    {.traversal_cost = 8},
    {.max_leaf = 8, .intersection_cost = 0.01},
};
enum { WAYS = sizeof ways / sizeof *ways };

// Builds and validates a tree. The test fails with the message of the function that fails.
static bool build(const struct bvh_params *params, struct arena *arena, struct bvh *bvh)
{
    struct err err = {0};
    bool built = bvh_build(params, arena, bvh, &err);
    CHECK(built, "%s", err.msg);
    if (!built)
        return false;
    bool valid = bvh_validate(bvh, params, &err);
    CHECK(valid, "%s", err.msg);
    CHECK(bvh->stats.stack_entries <= BVH_STACK_ENTRIES_MAX, "%u", bvh->stats.stack_entries);
    return valid;
}

static const uint32_t *children(const struct bvh *bvh, uint32_t node)
{
    return bvh->nodes_float ? bvh->nodes_float[node].child : bvh->nodes[node].child;
}

// Builds with all methods. The statistics are those of the default method.
static void build_mesh(const struct mesh *mesh, struct bvh_stats *stats)
{
    for (uint32_t way = 0; way < WAYS; way++) {
        struct arena arena = {0};
        struct bvh bvh;
        struct bvh_params params = mesh_params(mesh);
        params.method = ways[way];
        if (build(&params, &arena, &bvh) && stats && way == 0)
            *stats = bvh.stats;
        arena_finish(&arena);
    }
}

TEST(few_triangles)
{
    const uint32_t leaves = BVH_LEAF_MAX + 1;
    for (uint32_t i = 0; i <= 40 * leaves * WAYS; i++) {
        uint32_t count = i / (leaves * WAYS);
        struct arena arena = {0};
        struct mesh mesh = mesh_soup(&arena, count, 0.3, count);
        struct bvh_params params = mesh_params(&mesh);
        params.method = ways[i % WAYS];
        params.method.max_leaf = i / WAYS % leaves;
        struct bvh bvh;
        if (build(&params, &arena, &bvh) && count == 0)
            CHECK(bvh.node_count == 1 && children(&bvh, 0)[0] == BVH_EMPTY);
        arena_finish(&arena);
    }
}

TEST(soups)
{
    static const double sizes[] = {0, 0.001, 0.1, 1};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct arena arena = {0};
        struct mesh mesh = mesh_soup(&arena, 20000, sizes[i], i);
        build_mesh(&mesh, NULL);
        arena_finish(&arena);
    }
}

// Computes, from the definitions, the longest path and the greatest number of pending children for
// any order of traversal.
static void measure(const struct bvh *bvh, uint32_t index, uint32_t level, uint32_t pending,
                    uint32_t *depth, uint32_t *entries)
{
    const uint32_t *child = children(bvh, index);
    uint32_t count = 0;
    while (count < 4 && child[count] != BVH_EMPTY)
        count++;
    *depth = level > *depth ? level : *depth;
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t visited_before = 0; visited_before < count; visited_before++) {
            uint32_t left = pending + count - 1 - visited_before;
            *entries = left > *entries ? left : *entries;
            if (visited_before == 0 && !(child[i] & BVH_LEAF))
                measure(bvh, child[i], level + 1, left, depth, entries);
        }
    }
}

TEST(statistics)
{
    for (uint32_t way = 0; way < WAYS; way++) {
        struct arena arena = {0};
        struct mesh mesh = mesh_soup(&arena, 3000, 0.05, 5);
        struct bvh_params params = mesh_params(&mesh);
        params.method = ways[way];
        struct bvh bvh;
        if (build(&params, &arena, &bvh)) {
            uint32_t depth = 0, entries = 0;
            uint64_t node_bytes = ways[way].format == BVH_FLOAT ? 128 : 64;
            measure(&bvh, 0, 1, 0, &depth, &entries);
            CHECK(bvh.stats.depth == depth, "%u, not %u", bvh.stats.depth, depth);
            CHECK(bvh.stats.stack_entries == entries, "%u, not %u", bvh.stats.stack_entries,
                  entries);
            CHECK(bvh_nodes_bytes(&bvh) == bvh.node_count * node_bytes);
            CHECK(bvh.stats.bytes == bvh.node_count * node_bytes + bvh.reference_count * 4ull);
            CHECK(bvh.stats.build_seconds > 0);
        }
        arena_finish(&arena);
    }
}

// With one triangle, a ray visits the root and then the only leaf with certainty.
TEST(sah_cost_of_one_triangle)
{
    struct arena arena = {0};
    struct mesh mesh = mesh_identical(&arena, 1);
    struct bvh_stats stats = {0};
    build_mesh(&mesh, &stats);
    CHECK(stats.sah_cost == 2, "%g", stats.sah_cost);
    CHECK(stats.depth == 1 && stats.stack_entries == 0 && stats.leaf_count == 1);
    arena_finish(&arena);
}

// A room of twelve triangles contains a sphere of many. Splitting from the top leaves the walls
// together with the sphere's triangles, for a cost of 11.64. After moving them the cost is 10.16.
TEST(large_triangles_among_small_ones)
{
    static const float corners[8][3] = {{-2, -2, -2}, {3, -2, -2}, {-2, 2.5f, -2}, {3, 2.5f, -2},
                                        {-2, -2, 2},  {3, -2, 2},  {-2, 2.5f, 2},  {3, 2.5f, 2}};
    static const uint8_t walls[12][3] = {{0, 1, 2}, {1, 2, 3}, {4, 5, 6}, {5, 6, 7},
                                         {0, 1, 4}, {1, 4, 5}, {2, 3, 6}, {3, 6, 7},
                                         {0, 2, 4}, {2, 4, 6}, {1, 3, 5}, {3, 5, 7}};
    struct arena arena = {0};
    struct mesh sphere = mesh_sphere(&arena, 100, 200);
    struct mesh mesh = mesh_new(&arena, 12 + sphere.count);
    memcpy(mesh.vertices + 12, sphere.vertices, sphere.count * sizeof *sphere.vertices);
    for (int i = 0; i < 12; i++)
        for (int v = 0; v < 3; v++)
            memcpy(mesh.vertices[i][v], corners[walls[i][v]], sizeof(float[3]));
    struct bvh_stats stats = {0};
    build_mesh(&mesh, &stats);
    CHECK(stats.sah_cost < 10.2, "%g", stats.sah_cost);
    arena_finish(&arena);
}

static double cost_of(const struct mesh *mesh, enum bvh_split split, enum bvh_optimize optimize,
                      uint32_t *places)
{
    struct arena arena = {0};
    struct bvh bvh = {0};
    struct bvh_params params = mesh_params(mesh);
    params.method = (struct bvh_method){split, BVH_QUANTISED, optimize};
    bool built = build(&params, &arena, &bvh);
    double cost = built ? bvh.stats.sah_cost : INFINITY;
    if (places)
        *places = built ? bvh.reference_count : 0;
    arena_finish(&arena);
    return cost;
}

// Whole beams give a tree with the cost 10.5; divided into parts they give 9.4.
TEST(spatial_splits_pay_where_boxes_are_empty)
{
    struct arena arena = {0};
    struct mesh mesh = mesh_among_beams(&arena, 40, 40);
    uint32_t places;
    double sah = cost_of(&mesh, BVH_SPLIT_SAH, BVH_OPTIMIZE_NORMAL, NULL);
    double spatial = cost_of(&mesh, BVH_SPLIT_SPATIAL, BVH_OPTIMIZE_NORMAL, &places);
    CHECK(spatial < 0.93 * sah, "%g, not much less than %g", spatial, sah);
    CHECK(places > mesh.count && places <= mesh.count * (1 + BVH_DUPLICATES_MAX), "%u of %u",
          places, mesh.count);
    arena_finish(&arena);
}

TEST(optimizing_longer_costs_less)
{
    struct arena arena = {0};
    struct mesh mesh = mesh_soup(&arena, 20000, 0.1, 3);
    for (uint32_t split = BVH_SPLIT_SAH; split <= BVH_SPLIT_SPATIAL; split += BVH_SPLIT_SPATIAL) {
        double off = cost_of(&mesh, split, BVH_OPTIMIZE_OFF, NULL);
        double normal = cost_of(&mesh, split, BVH_OPTIMIZE_NORMAL, NULL);
        double longer = cost_of(&mesh, split, BVH_OPTIMIZE_LONG, NULL);
        CHECK(longer < normal && normal < off, "split %u: %g, %g, %g", split, off, normal, longer);
    }
    arena_finish(&arena);
}

TEST(identical_triangles)
{
    static const uint32_t counts[] = {17, 10000, 1000000};
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        // A million triangles take long, so only the default method is tested.
        enum bvh_split last = counts[i] > 10000 ? BVH_SPLIT_SAH : BVH_SPLIT_MIDDLE;
        for (uint32_t split = BVH_SPLIT_SAH; split <= last; split++) {
            struct arena arena = {0};
            struct mesh mesh = mesh_identical(&arena, counts[i]);
            struct bvh_params params = mesh_params(&mesh);
            params.method.split = split;
            struct bvh bvh;
            if (build(&params, &arena, &bvh))
                CHECK(bvh.stats.depth <= 20, "%u triangles: depth %u", counts[i], bvh.stats.depth);
            arena_finish(&arena);
        }
    }
}

// --- Ways to split ------------------------------------------------------------------------------

// Checks how a builder splits eight triangles that begin at these x, with one triangle per leaf:
// where each child of the root begins.
static void check_row(enum bvh_split split, const float row[8], const float (*begins)[4])
{
    struct arena arena = {0};
    struct mesh mesh = mesh_new(&arena, 8);
    for (int i = 0; i < 8; i++) // in another order than by position
        for (int v = 0; v < 3; v++)
            memcpy(mesh.vertices[3 * i % 8][v],
                   (float[3]){row[i] + (v == 1 ? 0.25f : 0), v == 2 ? 0.25f : 0, 0},
                   sizeof(float[3]));
    struct bvh_params params = mesh_params(&mesh);
    params.method = (struct bvh_method){split, BVH_FLOAT, .max_leaf = 1};
    struct bvh bvh;
    if (build(&params, &arena, &bvh))
        for (int i = 0; i < 4; i++) {
            bool empty = bvh.nodes_float[0].child[i] == BVH_EMPTY;
            CHECK(empty == ((*begins)[i] < 0), "split %d, child %d", split, i);
            CHECK(empty || bvh.nodes_float[0].min[0][i] == (*begins)[i], "split %d, child %d: %g",
                  split, i, (double)bvh.nodes_float[0].min[0][i]);
        }
    arena_finish(&arena);
}

// The root contains two levels of a binary tree. For seven triangles in a row and one far away:
// halves of four and then two; at the mean of 15.1, then of 3, which is the place of the fourth.
// For two groups and a single triangle: at the mean of 8.5, then of 2.1 and 19.1; in the middle of
// the boxes, at 16.1 and at 6.6.
TEST(median_mean_and_middle_split_where_they_say)
{
    static const float row[8] = {0, 1, 2, 3, 4, 5, 6, 100};
    static const float groups[8] = {0, 1, 2, 3, 4, 12, 13, 32};
    check_row(BVH_SPLIT_MEDIAN, row, &(const float[4]){0, 2, 4, 6});
    check_row(BVH_SPLIT_MEAN, row, &(const float[4]){0, 3, 100, -1});
    check_row(BVH_SPLIT_MEAN, groups, &(const float[4]){0, 2, 12, 32});
    check_row(BVH_SPLIT_MIDDLE, groups, &(const float[4]){0, 12, 32, -1});
}

// Finds the greatest and the mean number of triangles per leaf.
static void leaf_sizes(const struct mesh *mesh, struct bvh_method method, uint32_t *most,
                       double *mean)
{
    struct arena arena = {0};
    struct bvh bvh;
    struct bvh_params params = mesh_params(mesh);
    params.method = method;
    *most = 0;
    if (build(&params, &arena, &bvh)) {
        for (uint32_t n = 0; n < bvh.node_count; n++)
            for (uint32_t i = 0; i < 4; i++) {
                uint32_t word = children(&bvh, n)[i], bits = bvh_leaf_index_bits(method.max_leaf);
                uint32_t count = ((word & ~BVH_LEAF) >> bits) + 1;
                if (word != BVH_EMPTY && (word & BVH_LEAF) && count > *most)
                    *most = count;
            }
        *mean = (double)mesh->count / bvh.stats.leaf_count;
    }
    arena_finish(&arena);
}

// A large leaf size does not make leaves large: nodes must also cost more than triangles. Splitting
// in the middle makes a leaf of all triangles that fit.
TEST(room_and_costs_decide_on_leaves)
{
    struct arena arena = {0};
    struct mesh mesh = mesh_sphere(&arena, 40, 80);
    double usual, roomy, dear, plain;
    uint32_t most;
    leaf_sizes(&mesh, (struct bvh_method){0}, &most, &usual);
    CHECK(most == 2, "%u", most);
    leaf_sizes(&mesh, (struct bvh_method){.max_leaf = 8}, &most, &roomy);
    leaf_sizes(&mesh, (struct bvh_method){.max_leaf = 8, .traversal_cost = 10}, &most, &dear);
    CHECK(most == 8, "%u", most);
    CHECK(usual < 2 && roomy < 0.7 * dear && dear > 3, "%g, %g, %g", usual, roomy, dear);
    leaf_sizes(&mesh, (struct bvh_method){.max_leaf = 8, .intersection_cost = 10}, &most, &dear);
    CHECK(most < 8 && dear <= usual, "%u, %g", most, dear);
    for (uint32_t room = 1; room <= BVH_LEAF_MAX; room++) {
        leaf_sizes(&mesh, (struct bvh_method){BVH_SPLIT_MIDDLE, .max_leaf = room}, &most, &plain);
        CHECK(most == room, "%u of %u", most, room);
    }
    CHECK(plain > 3, "%g", plain);
    arena_finish(&arena);
}

// With larger leaves, fewer bits remain for the index of the first triangle.
TEST(long_leaves_bound_the_number_of_triangles)
{
    static const float vertices[3][3];
    struct bvh_params params = {
        .triangle_vertices = &vertices, .triangle_count = 1u << 27, .method = {.max_leaf = 3}};
    struct arena arena = {0};
    struct bvh bvh;
    struct err err = {0};
    CHECK(
        !bvh_build(&params, &arena, &bvh, &err) && err.code == ERR_INPUT &&
            strstr(err.msg, "134217728 triangles are too many for leaves of 3 (--bvh-leaf)"),
        "%s", err.msg);
    arena_finish(&arena);
}

// Splitting at the median or mean is bad for many triangles in little space with few around them.
// The tree of the SAH costs 0.63 of that by median and 0.77 of that by mean.
TEST(small_among_large)
{
    struct arena arena = {0};
    struct mesh sphere = mesh_sphere(&arena, 50, 100), far = mesh_soup(&arena, 2000, 0.1, 3);
    struct mesh mesh = mesh_new(&arena, sphere.count + far.count);
    memcpy(mesh.vertices, sphere.vertices, sphere.count * sizeof *sphere.vertices);
    for (uint32_t i = 0; i < far.count; i++)
        for (int v = 0; v < 3; v++)
            for (int axis = 0; axis < 3; axis++)
                mesh.vertices[sphere.count + i][v][axis] = 400 * far.vertices[i][v][axis] - 200;
    double cost[3] = {0};
    for (uint32_t split = BVH_SPLIT_SAH; split <= BVH_SPLIT_MEAN; split++) {
        struct bvh_params params = mesh_params(&mesh);
        params.method.split = split;
        struct bvh bvh;
        if (build(&params, &arena, &bvh))
            cost[split] = bvh.stats.sah_cost;
    }
    CHECK(cost[BVH_SPLIT_SAH] < 0.7 * cost[BVH_SPLIT_MEDIAN], "%g, %g", cost[0], cost[1]);
    CHECK(cost[BVH_SPLIT_SAH] < 0.85 * cost[BVH_SPLIT_MEAN], "%g, %g", cost[0], cost[2]);
    arena_finish(&arena);
}

TEST(slivers)
{
    struct arena arena = {0};
    struct mesh mesh = mesh_soup(&arena, 5000, 0.01, 8);
    for (uint32_t i = 0; i < mesh.count; i++) // aspect ratios of 1e6 : 1, along each axis in turn
        for (int v = 0; v < 3; v++)
            mesh.vertices[i][v][i % 3] = v == 0 ? -5000.0f : 5000.0f;
    build_mesh(&mesh, NULL);
    arena_finish(&arena);
}

TEST(extreme_coordinates)
{
    static const float scales[] = {0, 1e-45f, 1e-38f, 1e-30f, 1e-8f, 1e8f, 1e30f, FLT_MAX};
    static const float offsets[] = {0, 1e-8f, -1, 1e8f, -1e30f};
    for (size_t s = 0; s < sizeof scales / sizeof scales[0]; s++) {
        for (size_t o = 0; o < sizeof offsets / sizeof offsets[0]; o++) {
            struct arena arena = {0};
            struct mesh mesh = mesh_soup(&arena, 500, 0.1, s);
            for (uint32_t i = 0; i < mesh.count; i++)
                for (int v = 0; v < 3; v++)
                    for (int axis = 0; axis < 3; axis++) {
                        float *x = &mesh.vertices[i][v][axis];
                        // Distributes values over the whole range from -scale to scale, then clamps
                        // them to floats.
                        double value = (2.0 * *x - 1) * scales[s] + offsets[o];
                        *x = (float)fmax(-FLT_MAX, fmin(FLT_MAX, value));
                    }
            build_mesh(&mesh, NULL);
            arena_finish(&arena);
        }
    }
}

// One mesh contains all magnitudes from 1e-38 to 1e38.
TEST(all_magnitudes_together)
{
    struct arena arena = {0};
    struct mesh mesh = mesh_new(&arena, 20000);
    struct random random = {3};
    for (uint32_t i = 0; i < mesh.count; i++)
        for (int v = 0; v < 3; v++)
            for (int axis = 0; axis < 3; axis++) {
                double magnitude = pow(10, random_between(&random, -38, 38));
                mesh.vertices[i][v][axis] =
                    (float)(random_unit(&random) < 0.5 ? -magnitude : magnitude);
            }
    build_mesh(&mesh, NULL);
    arena_finish(&arena);
}

// Small triangles have exponentially growing distances. The SAH separates only a few at a time, so
// only the depth limit keeps the tree from degenerating into a list.
TEST(exponential_spacing_stays_shallow)
{
    static const uint32_t counts[] = {200, 3000, 50000};
    for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
        struct arena arena = {0};
        struct mesh mesh = mesh_new(&arena, counts[c]);
        for (uint32_t i = 0; i < mesh.count; i++) {
            float at = (float)pow(2, 240.0 * i / mesh.count - 120);
            for (int v = 0; v < 3; v++)
                for (int axis = 0; axis < 3; axis++)
                    mesh.vertices[i][v][axis] = at * (v == axis ? 1.001f : 1);
        }
        build_mesh(&mesh, NULL);
        arena_finish(&arena);
    }
}

// The limit of the depth must hold for any tree above: here 24 levels of a list, each of which is
// again a list.
TEST(nested_lists_stay_shallow)
{
    struct arena arena = {0};
    struct mesh mesh = mesh_new(&arena, 24 * 24 * 24);
    for (uint32_t i = 0; i < mesh.count; i++) {
        uint32_t digits[3] = {i / (24 * 24), i / 24 % 24, i % 24};
        for (int v = 0; v < 3; v++)
            for (int axis = 0; axis < 3; axis++) {
                float at = (float)pow(2, 5.0 * digits[axis] - 60);
                mesh.vertices[i][v][axis] = at * (v == axis ? 1.01f : 1);
            }
    }
    build_mesh(&mesh, NULL);
    arena_finish(&arena);
}

static void check_same_bits(const struct mesh *mesh, struct bvh_method method)
{
    static const unsigned threads[] = {1, 2, 5};
    struct arena arena = {0};
    struct bvh bvh[3];
    for (size_t i = 0; i < 3; i++) {
        struct bvh_params params = mesh_params(mesh);
        params.threads = threads[i];
        params.method = method;
        struct err err;
        REQUIRE(bvh_build(&params, &arena, &bvh[i], &err), "%s", err.msg);
        REQUIRE(bvh[i].node_count == bvh[0].node_count, "%u threads", threads[i]);
        CHECK(!memcmp(bvh_nodes_data(&bvh[i]), bvh_nodes_data(&bvh[0]), bvh_nodes_bytes(&bvh[0])),
              "%u threads", threads[i]);
        CHECK(!memcmp(bvh[i].triangle_order, bvh[0].triangle_order,
                      bvh[0].reference_count * sizeof *bvh[0].triangle_order),
              "%u threads", threads[i]);
    }
    arena_finish(&arena);
}

TEST(same_bits_for_any_threads)
{
    struct arena arena = {0};
    struct mesh grid = mesh_grid(&arena, 200), soup = mesh_soup(&arena, 80000, 0.02, 4);
    for (uint32_t i = 0; i < soup.count; i++) // zeros of both signs, whose order must not matter
        soup.vertices[i][0][0] = i % 3 == 0 ? 0.0f : i % 3 == 1 ? -0.0f : soup.vertices[i][0][0];
    struct mesh same = mesh_identical(&arena, 50000);
    check_same_bits(&grid, ways[0]);
    check_same_bits(&soup, ways[0]);
    check_same_bits(&same, ways[0]);
    soup.count = 40000; // more than one thread's part
    check_same_bits(&soup, (struct bvh_method){BVH_SPLIT_SPATIAL, BVH_QUANTISED});
    soup.count = grid.count = 20000;
    for (uint32_t way = 1; way < WAYS; way++)
        check_same_bits(ways[way].format == BVH_FLOAT ? &grid : &soup, ways[way]);
    arena_finish(&arena);
}

TEST(stride_and_shapes)
{
    enum { TRIANGLES = 100, SHAPES = 57 };
    struct arena arena = {0};
    struct mesh soup = mesh_soup(&arena, TRIANGLES, 0.2, 6);
    struct wide_triangle {
        float vertices[3][3];
        uint32_t material, spare[2];
    } *wide = ARENA_NEW(&arena, struct wide_triangle, TRIANGLES);
    struct bvh_box boxes[SHAPES];
    for (uint32_t i = 0; i < TRIANGLES; i++) {
        memcpy(wide[i].vertices, soup.vertices[i], sizeof wide[i].vertices);
        wide[i].material = 0x7fc00000; // a NaN if it were interpreted as a coordinate
    }
    for (uint32_t i = 0; i < SHAPES; i++)
        for (int axis = 0; axis < 3; axis++) {
            boxes[i].min[axis] = (float)(i * 7 % 13) / 13;
            boxes[i].max[axis] = boxes[i].min[axis] + (float)(i * 5 % 3) * 0.1f;
        }
    struct bvh_params params = {
        .triangle_vertices = (const float(*)[3][3])wide,
        .triangle_stride = sizeof *wide,
        .triangle_count = TRIANGLES,
        .shape_boxes = boxes,
        .shape_count = SHAPES,
    };
    struct bvh bvh;
    build(&params, &arena, &bvh);
    params.triangle_count = 0;
    build(&params, &arena, &bvh);
    params.shape_count = 1;
    build(&params, &arena, &bvh);
    arena_finish(&arena);
}

// Beside the box of a plane, the rest of the scene is one child, because the grid of a node could
// not separate its parts.
TEST(small_beside_the_boundless)
{
    struct arena arena = {0};
    struct mesh soup = mesh_soup(&arena, 5000, 0.1, 7);
    struct bvh_params params = mesh_params(&soup);
    const struct bvh_box planes[2] = {{{-1e18f, -2, -1e18f}, {0.75e18f, -2, 0.75e18f}},
                                      {{-1e18f, -1e18f, -1e18f}, {0.75e18f, 0.75e18f, 0.75e18f}}};
    for (uint32_t i = 0; i < 2; i++) {
        struct bvh bvh;
        params.shape_boxes = &planes[i];
        params.shape_count = 1;
        if (!build(&params, &arena, &bvh))
            continue;
        uint32_t inner = 0, leaves = 0;
        for (uint32_t c = 0; c < 4; c++) {
            inner += children(&bvh, 0)[c] < BVH_LEAF;
            leaves += children(&bvh, 0)[c] == (BVH_LEAF | BVH_LEAF_SHAPE);
        }
        CHECK(inner == 1 && leaves == 1, "%u inner children, %u planes", inner, leaves);
    }
    arena_finish(&arena);
}

// --- Errors -------------------------------------------------------------------------------------

static void check_refused(const struct bvh_params *params, const char *expected)
{
    struct arena arena = {0};
    struct bvh bvh;
    struct err err = {0};
    CHECK(!bvh_build(params, &arena, &bvh, &err));
    CHECK(err.code == ERR_BUG && strstr(err.msg, expected), "%s", err.msg);
    arena_finish(&arena);
}

TEST(bad_input)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    struct arena arena = {0};
    struct mesh mesh = mesh_soup(&arena, 100, 0.1, 1);
    for (size_t i = 0; i < 3; i++) {
        float good = mesh.vertices[42][1][2];
        mesh.vertices[42][1][2] = mesh.vertices[77][0][0] = bad[i];
        struct bvh_params params = mesh_params(&mesh);
        check_refused(&params, "triangle 42");
        mesh.vertices[42][1][2] = mesh.vertices[77][0][0] = good;
    }
    struct bvh_params params = mesh_params(&mesh);
    params.triangle_stride = 35;
    check_refused(&params, "triangle_stride: 35");
    params = mesh_params(&mesh);
    params.method.max_leaf = 9;
    check_refused(&params, "max_leaf: 9");
    params = mesh_params(&mesh);
    params.method.intersection_cost = 1e4;
    check_refused(&params, "intersection_cost: 10000 is outside [0.001, 1000]");
    struct bvh_box boxes[2] = {{{0, 0, 0}, {1, 1, 1}}, {{0, 0, 2}, {1, 1, 1}}};
    params = (struct bvh_params){.shape_boxes = boxes, .shape_count = 2};
    check_refused(&params, "shape 1");
    params = (struct bvh_params){.triangle_count = BVH_LEAF_INDEX + 1};
    check_refused(&params, "at most");
    params = (struct bvh_params){.triangle_count = 1};
    check_refused(&params, "vertices or boxes are missing");
    arena_finish(&arena);
}

TEST(every_allocation_may_fail)
{
    struct arena data = {0};
    struct mesh mesh = mesh_soup(&data, 3000, 0.1, 1);
    struct bvh_params params = mesh_params(&mesh);
    for (uint64_t n = 1; n < 50; n++) {
        struct arena arena = {0};
        struct bvh bvh;
        struct err err = {0};
        arena_fail_at(n);
        bool built = bvh_build(&params, &arena, &bvh, &err);
        arena_fail_at(0);
        CHECK(built || err.code == ERR_SYSTEM, "allocation %d: %s", (int)n, err.msg);
        arena_finish(&arena);
        if (built) {
            CHECK(n > 5, "only %d allocations failed", (int)n - 1);
            break;
        }
    }
    arena_finish(&data);
}

struct listener {
    double last;
    int reports, stop_after;
    bool in_order;
};

static void listen(void *context, const char *phase, double fraction)
{
    struct listener *listener = context;
    CHECK(!strcmp(phase, "Building BVH"));
    listener->in_order = listener->in_order && fraction >= listener->last && fraction <= 1;
    listener->last = fraction;
    listener->reports++;
}

static bool wants_stop(void *context)
{
    const struct listener *listener = context;
    return listener->reports >= listener->stop_after;
}

TEST(progress_and_stopping)
{
    struct arena arena = {0};
    struct mesh mesh = mesh_grid(&arena, 300);
    struct listener listener = {.in_order = true, .stop_after = 1000000};
    struct progress progress = {listen, wants_stop, &listener};
    struct bvh_params params = mesh_params(&mesh);
    params.progress = &progress;
    struct bvh bvh;
    struct err err = {0};
    CHECK(bvh_build(&params, &arena, &bvh, &err), "%s", err.msg);
    CHECK(listener.in_order && listener.last == 1 && listener.reports > 5, "%d reports, last %g",
          listener.reports, listener.last);
    listener = (struct listener){.in_order = true, .stop_after = 3};
    CHECK(!bvh_build(&params, &arena, &bvh, &err));
    CHECK(err.code == ERR_STOPPED && strstr(err.msg, "stopped"), "%s", err.msg);
    arena_finish(&arena);
}

// --- Validation ---------------------------------------------------------------------------------

static void check_flips(const struct bvh *bvh, const struct bvh_params *params, uint32_t *word,
                        const char *what, uint32_t index)
{
    for (int bit = 0; bit < 32; bit++) {
        *word ^= 1u << bit;
        struct err err = {0};
        CHECK(!bvh_validate(bvh, params, &err), "%s %u, bit %d", what, index, bit);
        CHECK(err.code == ERR_INPUT && err.msg[0], "%s %u, bit %d", what, index, bit);
        *word ^= 1u << bit;
    }
}

// Builds a tree with a few triangles and shapes, in which bits are flipped.
static bool build_for_flips(enum bvh_format format, struct arena *arena, struct bvh_params *params,
                            struct bvh *bvh)
{
    static const struct bvh_box boxes[3] = {{{0.1f, 0.1f, 0.1f}, {1, 1, 1}},
                                            {{0.1f, 0.5f, 0.1f}, {0.2f, 1, 1}},
                                            {{0.5f, 0.1f, 0.1f}, {1, 0.2f, 1}}};
    static struct mesh mesh;
    mesh = mesh_soup(arena, 60, 0.2, 2);
    *params = mesh_params(&mesh);
    params->shape_boxes = boxes;
    params->shape_count = 3;
    params->method.format = format;
    return build(params, arena, bvh);
}

// Every bit matters except those of the origins, for which the box may still be large enough.
TEST(validate_finds_every_flipped_bit)
{
    struct arena arena = {0};
    struct bvh_params params;
    struct bvh bvh;
    REQUIRE(build_for_flips(BVH_QUANTISED, &arena, &params, &bvh));
    for (uint32_t n = 0; n < bvh.node_count; n++) {
        struct bvh_node *node = &bvh.nodes[n];
        check_flips(&bvh, &params, &node->exponents, "exponents of node", n);
        for (int i = 0; i < 4; i++)
            check_flips(&bvh, &params, &node->child[i], "child of node", n);
        for (int i = 0; i < 3; i++) {
            check_flips(&bvh, &params, &node->lo[i], "lo of node", n);
            check_flips(&bvh, &params, &node->hi[i], "hi of node", n);
        }
        for (int i = 0; i < 2; i++)
            check_flips(&bvh, &params, &node->spare[i], "spare of node", n);
    }
    for (uint32_t i = 0; i < params.triangle_count; i++)
        check_flips(&bvh, &params, &bvh.triangle_order[i], "triangle_order", i);
    check_flips(&bvh, &params, &bvh.stats.depth, "depth", 0);
    check_flips(&bvh, &params, &bvh.stats.stack_entries, "stack_entries", 0);
    check_flips(&bvh, &params, &bvh.stats.node_count, "node_count", 0);
    check_flips(&bvh, &params, &bvh.stats.leaf_count, "leaf_count", 0);
    arena_finish(&arena);
}

TEST(validate_finds_every_flipped_bit_of_float_nodes)
{
    struct arena arena = {0};
    struct bvh_params params;
    struct bvh bvh;
    REQUIRE(build_for_flips(BVH_FLOAT, &arena, &params, &bvh));
    for (uint32_t n = 0; n < bvh.node_count; n++) {
        uint32_t words[sizeof *bvh.nodes_float / 4];
        memcpy(words, &bvh.nodes_float[n], sizeof words);
        for (uint32_t bit = 0; bit < 32 * sizeof words / 4; bit++) {
            struct err err = {0};
            words[bit / 32] ^= 1u << bit % 32;
            memcpy(&bvh.nodes_float[n], words, sizeof words);
            CHECK(!bvh_validate(&bvh, &params, &err), "node %u, bit %u", n, bit);
            words[bit / 32] ^= 1u << bit % 32;
        }
        memcpy(&bvh.nodes_float[n], words, sizeof words);
    }
    arena_finish(&arena);
}

TEST(validate_finds_moved_triangle)
{
    struct arena arena = {0};
    struct mesh mesh = mesh_soup(&arena, 1000, 0.1, 2);
    struct bvh_params params = mesh_params(&mesh);
    struct bvh bvh;
    struct err err = {0};
    if (build(&params, &arena, &bvh)) {
        mesh.vertices[500][2][1] += 0.1f;
        CHECK(!bvh_validate(&bvh, &params, &err) && strstr(err.msg, "box"), "%s", err.msg);
    }
    arena_finish(&arena);
}

TEST_MAIN(TEST_CASE(few_triangles), TEST_CASE(soups), TEST_CASE(statistics),
          TEST_CASE(sah_cost_of_one_triangle), TEST_CASE(large_triangles_among_small_ones),
          TEST_CASE(spatial_splits_pay_where_boxes_are_empty),
          TEST_CASE(optimizing_longer_costs_less), TEST_CASE(identical_triangles),
          TEST_CASE(median_mean_and_middle_split_where_they_say),
          TEST_CASE(room_and_costs_decide_on_leaves),
          TEST_CASE(long_leaves_bound_the_number_of_triangles), TEST_CASE(small_among_large),
          TEST_CASE(slivers), TEST_CASE(extreme_coordinates), TEST_CASE(all_magnitudes_together),
          TEST_CASE(exponential_spacing_stays_shallow), TEST_CASE(nested_lists_stay_shallow),
          TEST_CASE(same_bits_for_any_threads), TEST_CASE(stride_and_shapes),
          TEST_CASE(small_beside_the_boundless), TEST_CASE(bad_input),
          TEST_CASE(every_allocation_may_fail), TEST_CASE(progress_and_stopping),
          TEST_CASE(validate_finds_every_flipped_bit),
          TEST_CASE(validate_finds_every_flipped_bit_of_float_nodes),
          TEST_CASE(validate_finds_moved_triangle))
