// Computes the expected cost of a tree, its depth and its stack requirement.
#include "bvh/bvh_node.h"

// Computes the SAH cost. A ray that hits the root's box hits a box inside it with probability equal
// to the ratio of their areas; if the root has no area, no box counts.
static double sah_cost(const struct bvh *bvh)
{
    double root_area = bvh_half_area(bvh, 0, 0, bvh_child_count(bvh_children(bvh, 0)));
    double sum = 0;
    for (uint32_t n = 0; n < bvh->node_count; n++) {
        const uint32_t *child = bvh_children(bvh, n);
        for (uint32_t i = 0; i < bvh_child_count(child); i++) {
            uint32_t steps = bvh_child_is_leaf(child[i]) ? bvh_leaf_count(bvh, child[i]) : 1;
            sum += bvh_half_area(bvh, n, i, i + 1) * steps;
        }
    }
    return root_area > 0 ? 1 + sum / root_area : 1;
}

// Computes the depth of the tree; the root has depth 1.
static uint32_t tree_depth(const struct bvh *bvh, uint32_t *level)
{
    uint32_t depth = 1;
    level[0] = 1;
    for (uint32_t n = 0; n < bvh->node_count; n++) {
        depth = level[n] > depth ? level[n] : depth;
        const uint32_t *child = bvh_children(bvh, n);
        for (uint32_t i = 0; i < bvh_child_count(child); i++)
            if (!bvh_child_is_leaf(child[i]))
                level[child[i]] = level[n] + 1;
    }
    return depth;
}

// Computes the stack requirement bottom-up. A traversal continues with one child of a node and
// leaves its siblings pending. The worst order first descends into the child with the greatest
// requirement, with all siblings pending.
static uint32_t tree_stack_entries(const struct bvh *bvh, uint32_t *entries)
{
    for (uint32_t n = bvh->node_count; n-- > 0;) {
        const uint32_t *child = bvh_children(bvh, n);
        uint32_t count = bvh_child_count(child), most = 0;
        for (uint32_t i = 0; i < count; i++)
            if (!bvh_child_is_leaf(child[i]) && entries[child[i]] > most)
                most = entries[child[i]];
        entries[n] = most + (count > 1 ? count - 1 : 0);
    }
    return entries[0];
}

bool bvh_compute_stats(const struct bvh *bvh, struct bvh_stats *stats, struct err *err)
{
    struct arena scratch = {0};
    uint32_t *per_node = ARENA_NEW(&scratch, uint32_t, bvh->node_count);
    if (!per_node)
        return err_memory(err, "the BVH's statistics", bvh->node_count * sizeof *per_node);
    *stats = (struct bvh_stats){
        .sah_cost = sah_cost(bvh),
        .depth = tree_depth(bvh, per_node),
        .stack_entries = tree_stack_entries(bvh, per_node),
        .node_count = bvh->node_count,
        .bytes =
            bvh_nodes_bytes(bvh) + (uint64_t)bvh->reference_count * sizeof *bvh->triangle_order,
    };
    for (uint32_t n = 0; n < bvh->node_count; n++) {
        const uint32_t *child = bvh_children(bvh, n);
        for (uint32_t i = 0; i < bvh_child_count(child); i++)
            stats->leaf_count += bvh_child_is_leaf(child[i]);
    }
    arena_finish(&scratch);
    return true;
}
