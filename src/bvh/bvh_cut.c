// Represents the top of a tree by a few boxes.
#include "bvh/bvh_node.h"

struct cut {
    const struct bvh *tree;
    struct bvh_box boxes[BVH_CUT_MAX];
    uint32_t words[BVH_CUT_MAX]; // child words
    uint32_t count;
};

// Adds a node's children: the first replaces the entry at `at`, the others are appended.
static void add_children(struct cut *cut, uint32_t node, uint32_t at)
{
    const uint32_t *child = bvh_children(cut->tree, node);
    for (uint32_t i = 0; i < bvh_child_count(child); i++) {
        double min[3], max[3];
        uint32_t to = i == 0 ? at : cut->count;
        bvh_child_box(cut->tree, node, i, min, max);
        for (int axis = 0; axis < 3; axis++) {
            float low = (float)min[axis], high = (float)max[axis];
            cut->boxes[to].min[axis] = low > min[axis] ? nextafterf(low, -INFINITY) : low;
            cut->boxes[to].max[axis] = high < max[axis] ? nextafterf(high, INFINITY) : high;
        }
        cut->words[to] = child[i];
        cut->count += to == cut->count;
    }
}

// Returns the position of the inner node with the largest box; `count` if there is none.
static uint32_t largest(const struct cut *cut)
{
    uint32_t best = cut->count;
    double most = -1;
    for (uint32_t i = 0; i < cut->count; i++) {
        double area = box_half_area(&cut->boxes[i]);
        if (!bvh_child_is_leaf(cut->words[i]) && area > most) {
            most = area;
            best = i;
        }
    }
    return best;
}

uint32_t bvh_cut(const struct bvh *tree, struct bvh_box out[BVH_CUT_MAX])
{
    struct cut cut = {.tree = tree};
    add_children(&cut, 0, 0);
    for (uint32_t at = largest(&cut); at < cut.count && cut.count + 3 <= BVH_CUT_MAX;
         at = largest(&cut))
        add_children(&cut, cut.words[at], at);
    for (uint32_t i = 0; i < cut.count; i++)
        out[i] = cut.boxes[i];
    return cut.count;
}
