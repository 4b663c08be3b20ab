// Accesses nodes of either format. This file is private to this folder.
#ifndef LAMPYRIS_BVH_BVH_NODE_H
#define LAMPYRIS_BVH_BVH_NODE_H

#include "bvh/bvh.h"
#include "bvh/bvh_box.h"

#include <stdint.h>
#include <string.h>

static inline bool bvh_child_is_leaf(uint32_t child)
{
    return (child & BVH_LEAF) != 0; // also true for BVH_EMPTY
}

static inline bool bvh_child_is_instance(uint32_t child)
{
    const uint32_t bits = BVH_LEAF | BVH_LEAF_INSTANCE;
    return child != BVH_EMPTY && (child & bits) == bits;
}

// Returns the number of primitives in a leaf child.
static inline uint32_t bvh_leaf_count(const struct bvh *bvh, uint32_t child)
{
    if (child & BVH_LEAF_SHAPE)
        return 1;
    return ((child & ~BVH_LEAF) >> bvh_leaf_index_bits(bvh->max_leaf)) + 1;
}

// Returns the first primitive of a leaf child: an index into triangle_order, or the index of a
// shape or an instance.
static inline uint32_t bvh_leaf_first(const struct bvh *bvh, uint32_t child)
{
    return child & (child & BVH_LEAF_SHAPE ? BVH_LEAF_INDEX : bvh_leaf_index_max(bvh->max_leaf));
}

static inline uint32_t bvh_child_count(const uint32_t child[4])
{
    uint32_t count = 0;
    while (count < 4 && child[count] != BVH_EMPTY)
        count++;
    return count;
}

// --- Functions for one format --------------------------------------------------------------------

// Store the boxes of the first `count` children, rounded outwards if quantised, and mark the other
// children as empty.
void bvh_quantised_set_boxes(struct bvh_node *node, const struct bvh_box *boxes, uint32_t count);
void bvh_float_set_boxes(struct bvh_node_float *node, const struct bvh_box *boxes, uint32_t count);

// Computes a child's box as stored in the node, in double precision, rounded outwards if even that
// is not exact.
void bvh_quantised_child_box(const struct bvh_node *node, uint32_t child, double min[3],
                             double max[3]);
void bvh_float_child_box(const struct bvh_node_float *node, uint32_t child, double min[3],
                         double max[3]);

// Returns whether the child's stored box is valid for `box`, the bounds of everything below: a
// quantised box must contain it in exact arithmetic, a box of floats must equal it.
bool bvh_quantised_child_fits(const struct bvh_node *node, uint32_t child,
                              const struct bvh_box *box);
bool bvh_float_child_fits(const struct bvh_node_float *node, uint32_t child,
                          const struct bvh_box *box);

// Return half the surface area of the union of the boxes of children [first, end), as stored in the
// node; 0 if there are none.
double bvh_quantised_half_area(const struct bvh_node *node, uint32_t first, uint32_t end);
double bvh_float_half_area(const struct bvh_node_float *node, uint32_t first, uint32_t end);

// Check the conditions that concern a single node. `index` is for messages.
bool bvh_quantised_check(const struct bvh_node *node, uint32_t index, struct err *err);
bool bvh_float_check(const struct bvh_node_float *node, uint32_t index, struct err *err);

// --- Functions for the BVH's format --------------------------------------------------------------

// Allocates out->node_count nodes of out->format.
bool bvh_nodes_allocate(struct arena *arena, struct bvh *out, struct err *err);

static inline uint32_t *bvh_children(const struct bvh *bvh, uint32_t node)
{
    return bvh->format == BVH_FLOAT ? bvh->nodes_float[node].child : bvh->nodes[node].child;
}

static inline void bvh_set_boxes(const struct bvh *bvh, uint32_t node, const struct bvh_box *boxes,
                                 uint32_t count)
{
    if (bvh->format == BVH_FLOAT)
        bvh_float_set_boxes(&bvh->nodes_float[node], boxes, count);
    else
        bvh_quantised_set_boxes(&bvh->nodes[node], boxes, count);
}

static inline void bvh_child_box(const struct bvh *bvh, uint32_t node, uint32_t child,
                                 double min[3], double max[3])
{
    if (bvh->format == BVH_FLOAT)
        bvh_float_child_box(&bvh->nodes_float[node], child, min, max);
    else
        bvh_quantised_child_box(&bvh->nodes[node], child, min, max);
}

static inline bool bvh_child_fits(const struct bvh *bvh, uint32_t node, uint32_t child,
                                  const struct bvh_box *box)
{
    return bvh->format == BVH_FLOAT ? bvh_float_child_fits(&bvh->nodes_float[node], child, box)
                                    : bvh_quantised_child_fits(&bvh->nodes[node], child, box);
}

static inline double bvh_half_area(const struct bvh *bvh, uint32_t node, uint32_t first,
                                   uint32_t end)
{
    return bvh->format == BVH_FLOAT ? bvh_float_half_area(&bvh->nodes_float[node], first, end)
                                    : bvh_quantised_half_area(&bvh->nodes[node], first, end);
}

static inline bool bvh_node_check(const struct bvh *bvh, uint32_t node, struct err *err)
{
    return bvh->format == BVH_FLOAT ? bvh_float_check(&bvh->nodes_float[node], node, err)
                                    : bvh_quantised_check(&bvh->nodes[node], node, err);
}

// The part of bvh_validate() for triangles with several references. All other checks must have
// passed.
bool bvh_validate_parts(const struct bvh *bvh, const struct bvh_params *params, struct err *err);

// Computes all statistics except build_seconds. Nodes must come after their parents.
bool bvh_compute_stats(const struct bvh *bvh, struct bvh_stats *stats, struct err *err);

#endif
