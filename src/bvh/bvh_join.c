// Joins two levels into one array: the world's tree, whose leaves lead to instances, and the trees
// that the instances share.
#include "bvh/bvh_node.h"

struct join {
    const struct bvh_join_params *params;
    struct bvh *out;
    uint32_t node_count, place_count, triangle_count; // totals of the trees copied so far
};

static void add_places(struct join *join, const struct bvh *tree)
{
    uint32_t *order = join->out->triangle_order + join->place_count;
    for (uint32_t i = 0; i < tree->reference_count; i++)
        order[i] = tree->triangle_order[i] + join->triangle_count;
}

static void add_nodes(struct join *join, const struct bvh *tree)
{
    uint64_t bytes = bvh_node_bytes(tree->format);
    char *to =
        tree->format == BVH_FLOAT ? (char *)join->out->nodes_float : (char *)join->out->nodes;
    memcpy(to + join->node_count * bytes, bvh_nodes_data(tree), bvh_nodes_bytes(tree));
    for (uint32_t n = 0; n < tree->node_count; n++) {
        uint32_t *child = bvh_children(join->out, join->node_count + n);
        for (uint32_t i = 0; i < bvh_child_count(child); i++)
            if (!bvh_child_is_leaf(child[i]))
                child[i] += join->node_count;
            else if (!(child[i] & BVH_LEAF_SHAPE))
                child[i] += join->place_count;
    }
}

static void add_tree(struct join *join, const struct bvh *tree)
{
    add_places(join, tree);
    add_nodes(join, tree);
    join->node_count += tree->node_count;
    join->place_count += tree->reference_count;
    join->triangle_count += tree->triangle_count;
}

static bool allocate(struct join *join, struct arena *arena, struct err *err)
{
    const struct bvh_join_params *p = join->params;
    uint64_t nodes = p->world->node_count, places = p->world->reference_count, triangles = 0;
    for (uint32_t i = 0; i < p->tree_count; i++) {
        nodes += p->trees[i].node_count;
        places += p->trees[i].reference_count;
        triangles += p->trees[i].triangle_count;
    }
    uint32_t places_max = bvh_leaf_index_max(p->world->max_leaf);
    if (nodes >= BVH_LEAF || places > places_max)
        return err_set(
            err, ERR_INPUT, "BVH: %llu nodes and %llu triangles in all; expected at most %u and %u",
            (unsigned long long)nodes, (unsigned long long)places, BVH_LEAF - 1, places_max);
    *join->out = (struct bvh){
        .format = p->world->format,
        .max_leaf = p->world->max_leaf,
        .node_count = (uint32_t)nodes,
        .triangle_count = p->world->triangle_count + (uint32_t)triangles,
        .reference_count = (uint32_t)places,
        .triangle_order = ARENA_NEW(arena, uint32_t, places),
        .roots = ARENA_NEW(arena, uint32_t, (size_t)p->tree_count + 1),
    };
    if (!join->out->triangle_order || !join->out->roots)
        return err_memory(err, "the BVH's triangle order", places * sizeof(uint32_t));
    return bvh_nodes_allocate(arena, join->out, err);
}

// Returns the cost that the trees below the leaves of instances add to the world's. A ray that
// reaches such a leaf is assumed to hit the root's box of that tree, too.
static double cost_of_instances(const struct bvh_join_params *p)
{
    const struct bvh *world = p->world;
    double root_area = bvh_half_area(world, 0, 0, bvh_child_count(bvh_children(world, 0)));
    double sum = 0;
    for (uint32_t n = 0; n < world->node_count && root_area > 0; n++) {
        const uint32_t *child = bvh_children(world, n);
        for (uint32_t i = 0; i < bvh_child_count(child); i++)
            if (bvh_child_is_instance(child[i]))
                sum += bvh_half_area(world, n, i, i + 1) / root_area *
                       p->trees[p->instance_tree[child[i] & BVH_LEAF_INDEX]].stats.sah_cost;
    }
    return sum;
}

static void join_stats(const struct bvh_join_params *p, struct bvh *out)
{
    uint32_t depth = 0, entries = 0;
    out->stats = p->world->stats;
    for (uint32_t i = 0; i < p->tree_count; i++) {
        const struct bvh_stats *tree = &p->trees[i].stats;
        depth = tree->depth > depth ? tree->depth : depth;
        entries = tree->stack_entries > entries ? tree->stack_entries : entries;
        out->stats.leaf_count += tree->leaf_count;
        out->stats.build_seconds += tree->build_seconds;
    }
    out->stats.depth += depth;
    out->stats.stack_entries += entries + 1; // plus the marker at which an instance ends
    out->stats.node_count = out->node_count;
    out->stats.sah_cost += cost_of_instances(p);
    out->stats.bytes =
        bvh_nodes_bytes(out) + (uint64_t)out->reference_count * sizeof *out->triangle_order;
}

bool bvh_join(const struct bvh_join_params *params, struct arena *arena, struct bvh *out,
              struct err *err)
{
    struct join join = {.params = params, .out = out};
    if (!allocate(&join, arena, err))
        return false;
    add_tree(&join, params->world);
    for (uint32_t i = 0; i < params->tree_count; i++) {
        out->roots[i + 1] = join.node_count;
        add_tree(&join, &params->trees[i]);
    }
    join_stats(params, out);
    return true;
}
