// The picture has the same bits for every way of splitting primitives into a BVH, and for every
// kind of nodes.
#include "render_fixture.h"

#define SAMPLES 4u

struct way {
    const char *name;
    struct bvh_method bvh;
    bool no_texel;
};

static const struct way ways[] = {
    {"SAH", {BVH_SPLIT_SAH, BVH_QUANTISED}, false},
    {"median", {BVH_SPLIT_MEDIAN, BVH_QUANTISED}, false},
    {"mean", {BVH_SPLIT_MEAN, BVH_QUANTISED}, false},
    {"SAH, float nodes", {BVH_SPLIT_SAH, BVH_FLOAT}, false},
    {"median, float nodes", {BVH_SPLIT_MEDIAN, BVH_FLOAT}, false},
    {"mean, float nodes", {BVH_SPLIT_MEAN, BVH_FLOAT}, false},
    {"SAH, float nodes from storage buffers", {BVH_SPLIT_SAH, BVH_FLOAT}, true},
    {"SAH, not optimized", {BVH_SPLIT_SAH, BVH_QUANTISED, BVH_OPTIMIZE_OFF}, false},
    {"spatial", {BVH_SPLIT_SPATIAL, BVH_QUANTISED}, false},
    {"spatial, float nodes, long", {BVH_SPLIT_SPATIAL, BVH_FLOAT, BVH_OPTIMIZE_LONG}, false},
    {"middle", {BVH_SPLIT_MIDDLE, BVH_QUANTISED}, false},
    {"middle, float nodes, leaves of 8", {BVH_SPLIT_MIDDLE, BVH_FLOAT, .max_leaf = 8}, false},
    {"leaves of 1", {.max_leaf = 1}, false},
    {"leaves of 8, dear nodes", {.max_leaf = 8, .traversal_cost = 8}, false},
    {"leaves of 8, dear nodes, from storage buffers", {.max_leaf = 8, .traversal_cost = 8}, true},
    {"dear triangles", {.intersection_cost = 8}, false},
};
enum { WAYS = sizeof ways / sizeof *ways };

struct picture {
    struct film_image film;
    struct bvh_stats stats;
    uint64_t order_hash; // hash of the order of triangles in the tree and of the number of nodes
    uint32_t duplicates;
};

static bool render(struct scene *scene, const struct way *way, struct arena *arena,
                   struct picture *out, struct err *err)
{
    struct gpu gpu;
    struct renderer r;
    const struct gpu_params device = {.limits = {.no_texel = way->no_texel}};
    const struct renderer_params params = {.gpu = &gpu, .scene = scene, .bvh = way->bvh};
    const struct render_call call = {.samples = SAMPLES};
    if (!gpu_open(&device, &gpu, err))
        return false;
    bool ok = renderer_create(&params, &r, err);
    if (ok) {
        uint64_t node_bytes = way->bvh.format == BVH_FLOAT ? 128 : 64;
        CHECK(r.plan.buffers[BINDING_NODES].bytes == r.bvh.node_count * node_bytes, "%s",
              way->name);
        CHECK((r.specialization.nodes == NODES_FLOAT) == (way->bvh.format == BVH_FLOAT), "%s",
              way->name);
        out->stats = r.bvh.stats;
        out->duplicates = r.bvh.reference_count - r.bvh.triangle_count;
        out->order_hash = r.bvh.node_count;
        for (uint32_t i = 0; i < r.bvh.reference_count; i++)
            out->order_hash = out->order_hash * 31 + r.bvh.triangle_order[i];
        ok = renderer_render(&r, &call, err) && renderer_read(&r, arena, &out->film, err);
        renderer_finish(&r);
    }
    gpu_close(&gpu);
    return ok;
}

static uint32_t different_pixels(const struct film_image *a, const struct film_image *b)
{
    uint32_t different = 0;
    for (uint32_t i = 0; i < a->width * a->height; i++)
        different += memcmp(a->mean[i], b->mean[i], sizeof a->mean[i]) ||
                     memcmp(a->half_a[i], b->half_a[i], sizeof a->half_a[i]);
    return different;
}

// Ends the test if there is no device.
static void check_device(void)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    gpu_close(&gpu);
}

static void check(uint32_t light_choice)
{
    struct scene scene;
    struct arena arena = {0};
    struct picture pictures[WAYS];
    struct err err = {0};
    check_device();
    REQUIRE_OK(load_scene("tests/render/scenes/hierarchies.json", NULL, &scene, &err));
    scene.settings.light_choice = light_choice;
    for (int i = 0; i < WAYS; i++) {
        REQUIRE_OK(render(&scene, &ways[i], &arena, &pictures[i], &err));
        CHECK(different_pixels(&pictures[i].film, &pictures[0].film) == 0,
              "%s: %u of %u pixels differ", ways[i].name,
              different_pixels(&pictures[i].film, &pictures[0].film),
              scene.settings.width * scene.settings.height);
        // If the trees were the same, equal pictures would prove nothing.
        bool same_tree = pictures[i].order_hash == pictures[0].order_hash;
        bool same_way = ways[i].bvh.split == BVH_SPLIT_SAH &&
                        ways[i].bvh.optimize == BVH_OPTIMIZE_NORMAL && ways[i].bvh.max_leaf == 0 &&
                        ways[i].bvh.intersection_cost == 0;
        bool is_spatial = ways[i].bvh.split == BVH_SPLIT_SPATIAL;
        CHECK(same_tree == same_way, "%s", ways[i].name);
        CHECK((pictures[i].duplicates > 0) == is_spatial, "%s: %u duplicates", ways[i].name,
              pictures[i].duplicates);
        CHECK(is_spatial || pictures[i].stats.sah_cost >= 0.999 * pictures[3].stats.sah_cost,
              "%s: SAH cost %g", ways[i].name, pictures[i].stats.sah_cost);
    }
    uint32_t lit = 0;
    for (uint32_t i = 0; i < scene.settings.width * scene.settings.height; i++)
        lit += pictures[0].film.mean[i][0] > 0.0f;
    CHECK(lit > 288, "%u pixels are lit", lit);
    arena_finish(&arena);
    scene_finish(&scene);
}

TEST(same_bits)
{
    check(LIGHT_CHOICE_POWER);
}

TEST(same_bits_with_a_tree_of_lights)
{
    check(LIGHT_CHOICE_TREE);
}

TEST_MAIN(TEST_CASE(same_bits), TEST_CASE(same_bits_with_a_tree_of_lights))
