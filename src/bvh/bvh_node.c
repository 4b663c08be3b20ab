// The quantised node: child boxes as bytes on a grid that the node's box spans.
#include "bvh_node.h"

// The smallest biased exponent in [1, 254] whose grid of 255 steps reaches from min to max. Some
// always does: floats differ by less than 2^129, and 255 * 2^127 is more.
static uint32_t grid_exponent(float min, float max)
{
    int exponent;
    // extent / 255 < 2^exponent, rounding aside; one less often suffices, as 255 is not 256.
    frexp(((double)max - min) / 255, &exponent);
    uint32_t biased = exponent + 126 > 1 ? (uint32_t)(exponent + 126) : 1;
    while (bvh_compare_sum(min, ldexp(255, (int)biased - 127), max) < 0)
        biased++;
    return biased;
}

// The last grid plane at or below a value, and the first at or above.
static uint32_t round_down(float origin, double scale, float value)
{
    double steps = floor(((double)value - origin) / scale);
    uint32_t byte = steps < 255 ? (uint32_t)steps : 255;
    while (byte > 0 && bvh_compare_sum(origin, byte * scale, value) > 0)
        byte--;
    return byte;
}

static uint32_t round_up(float origin, double scale, float value)
{
    double steps = ceil(((double)value - origin) / scale);
    uint32_t byte = steps < 255 ? (uint32_t)steps : 255;
    while (byte < 255 && bvh_compare_sum(origin, byte * scale, value) < 0)
        byte++;
    return byte;
}

void bvh_node_set_boxes(struct bvh_node *node, const struct bvh_box *boxes, uint32_t count)
{
    struct bvh_box all = count > 0 ? boxes[0] : (struct bvh_box){0};
    for (uint32_t i = 1; i < count; i++)
        box_add_box(&all, &boxes[i]);
    node->exponents = 0;
    for (int axis = 0; axis < 3; axis++) {
        node->origin[axis] = all.min[axis];
        node->exponents |= grid_exponent(all.min[axis], all.max[axis]) << (8 * axis);
        double scale = bvh_node_scale(node, axis);
        node->lo[axis] = node->hi[axis] = 0;
        for (uint32_t i = 0; i < 4; i++) {
            uint32_t lo = 255, hi = 0;
            if (i < count) {
                lo = round_down(all.min[axis], scale, boxes[i].min[axis]);
                hi = round_up(all.min[axis], scale, boxes[i].max[axis]);
            }
            node->lo[axis] |= lo << (8 * i);
            node->hi[axis] |= hi << (8 * i);
        }
    }
}

void bvh_node_child_box(const struct bvh_node *node, uint32_t child, double min[3], double max[3])
{
    for (int axis = 0; axis < 3; axis++) {
        double origin = node->origin[axis], scale = bvh_node_scale(node, axis);
        double lo = (node->lo[axis] >> (8 * child) & 255u) * scale;
        double hi = (node->hi[axis] >> (8 * child) & 255u) * scale;
        min[axis] = origin + lo;
        max[axis] = origin + hi;
        if (bvh_compare_sum(origin, lo, min[axis]) < 0)
            min[axis] = nextafter(min[axis], -INFINITY);
        if (bvh_compare_sum(origin, hi, max[axis]) > 0)
            max[axis] = nextafter(max[axis], INFINITY);
    }
}

bool bvh_node_child_contains(const struct bvh_node *node, uint32_t child, const struct bvh_box *box)
{
    for (int axis = 0; axis < 3; axis++) {
        double origin = node->origin[axis], scale = bvh_node_scale(node, axis);
        double lo = (node->lo[axis] >> (8 * child) & 255u) * scale;
        double hi = (node->hi[axis] >> (8 * child) & 255u) * scale;
        if (bvh_compare_sum(origin, lo, box->min[axis]) > 0 ||
            bvh_compare_sum(origin, hi, box->max[axis]) < 0)
            return false;
    }
    return true;
}

// Half the area of the union of children [first, end), as quantised. 0 of none.
static double children_half_area(const struct bvh_node *node, uint32_t first, uint32_t end)
{
    double size[3];
    for (int axis = 0; axis < 3; axis++) {
        int min = 255, max = 0;
        for (uint32_t i = first; i < end; i++) {
            int lo = node->lo[axis] >> (8 * i) & 255u, hi = node->hi[axis] >> (8 * i) & 255u;
            min = lo < min ? lo : min;
            max = hi > max ? hi : max;
        }
        size[axis] = (max > min ? max - min : 0) * bvh_node_scale(node, axis);
    }
    return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
}

// A ray that hits the root's box hits a box inside with the probability of the ratio of areas; in a
// root without area no box counts.
static double sah_cost(const struct bvh *bvh)
{
    double root_area = children_half_area(&bvh->nodes[0], 0, bvh_child_count(&bvh->nodes[0]));
    double sum = 0;
    for (uint32_t n = 0; n < bvh->node_count; n++) {
        const struct bvh_node *node = &bvh->nodes[n];
        for (uint32_t i = 0; i < bvh_child_count(node); i++) {
            uint32_t child = node->child[i];
            uint32_t steps = bvh_child_is_leaf(child) ? bvh_leaf_count(child) : 1;
            sum += children_half_area(node, i, i + 1) * steps;
        }
    }
    return root_area > 0 ? 1 + sum / root_area : 1;
}

// Levels from the root, which has 1, downwards.
static uint32_t tree_depth(const struct bvh *bvh, uint32_t *level)
{
    uint32_t depth = 1;
    level[0] = 1;
    for (uint32_t n = 0; n < bvh->node_count; n++) {
        depth = level[n] > depth ? level[n] : depth;
        for (uint32_t i = 0; i < bvh_child_count(&bvh->nodes[n]); i++)
            if (!bvh_child_is_leaf(bvh->nodes[n].child[i]))
                level[bvh->nodes[n].child[i]] = level[n] + 1;
    }
    return depth;
}

// A traversal goes on with one child of a node and leaves all its siblings pending; so the worst
// order descends first, with every sibling pending, into the child that needs most itself.
static uint32_t tree_stack_entries(const struct bvh *bvh, uint32_t *entries)
{
    for (uint32_t n = bvh->node_count; n-- > 0;) {
        const struct bvh_node *node = &bvh->nodes[n];
        uint32_t count = bvh_child_count(node), most = 0;
        for (uint32_t i = 0; i < count; i++)
            if (!bvh_child_is_leaf(node->child[i]) && entries[node->child[i]] > most)
                most = entries[node->child[i]];
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
        .bytes = (uint64_t)bvh->node_count * sizeof *bvh->nodes +
                 (uint64_t)bvh->triangle_count * sizeof *bvh->triangle_order,
    };
    for (uint32_t n = 0; n < bvh->node_count; n++)
        for (uint32_t i = 0; i < bvh_child_count(&bvh->nodes[n]); i++)
            stats->leaf_count += bvh_child_is_leaf(bvh->nodes[n].child[i]);
    arena_finish(&scratch);
    return true;
}
