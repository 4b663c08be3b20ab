// Reading and writing the quantised node. Private to this folder.
#ifndef LAMPYRIS_BVH_BVH_NODE_H
#define LAMPYRIS_BVH_BVH_NODE_H

#include "bvh.h"
#include "bvh_box.h"

#include <stdint.h>
#include <string.h>

static inline bool bvh_child_is_leaf(uint32_t child)
{
    return (child & BVH_LEAF) != 0; // true for BVH_EMPTY, too
}

// The primitives of a leaf child.
static inline uint32_t bvh_leaf_count(uint32_t child)
{
    return child & BVH_LEAF_SHAPE ? 1 : child & BVH_LEAF_TWO ? 2 : 1;
}

static inline uint32_t bvh_child_count(const struct bvh_node *node)
{
    uint32_t count = 0;
    while (count < 4 && node->child[count] != BVH_EMPTY)
        count++;
    return count;
}

// 2^(exponent - 127) of an axis; exact, for the biased exponent is in [1, 254].
static inline double bvh_node_scale(const struct bvh_node *node, int axis)
{
    uint32_t bits = (node->exponents >> (8 * axis) & 255u) << 23;
    float scale;
    memcpy(&scale, &bits, sizeof scale);
    return scale;
}

// A plane is a + b with b = byte * scale, which a double holds. This is the sign of (a + b) - c in
// exact arithmetic: the rounded sum decides unless it equals c, and then its rounding error does
// (TwoSum, Knuth 1969, The Art of Computer Programming 2, section 4.2.2, theorem B).
static inline int bvh_compare_sum(double a, double b, double c)
{
    double sum = a + b;
    if (sum != c)
        return sum > c ? 1 : -1;
    double b_part = sum - a;
    double error = (a - (sum - b_part)) + (b - b_part);
    return (error > 0) - (error < 0);
}

// Writes the boxes of the first `count` children, rounded outwards, and empties the others.
void bvh_node_set_boxes(struct bvh_node *node, const struct bvh_box *boxes, uint32_t count);

// The box of a child as the node describes it, in double precision; rounded outwards where even
// that is not exact.
void bvh_node_child_box(const struct bvh_node *node, uint32_t child, double min[3], double max[3]);

// Whether a child's box, in exact arithmetic, contains another.
bool bvh_node_child_contains(const struct bvh_node *node, uint32_t child,
                             const struct bvh_box *box);

// All statistics but build_seconds. Nodes must stand after their parents.
bool bvh_compute_stats(const struct bvh *bvh, struct bvh_stats *stats, struct err *err);

#endif
