// Encodes the node of 128 bytes, whose child boxes are in single precision.
#include "bvh/bvh_node.h"

void bvh_float_set_boxes(struct bvh_node_float *node, const struct bvh_box *boxes, uint32_t count)
{
    for (int axis = 0; axis < 3; axis++) {
        for (uint32_t i = 0; i < 4; i++) {
            node->min[axis][i] = i < count ? boxes[i].min[axis] : 0;
            node->max[axis][i] = i < count ? boxes[i].max[axis] : 0;
        }
    }
}

void bvh_float_child_box(const struct bvh_node_float *node, uint32_t child, double min[3],
                         double max[3])
{
    for (int axis = 0; axis < 3; axis++) {
        min[axis] = node->min[axis][child];
        max[axis] = node->max[axis][child];
    }
}

bool bvh_float_child_fits(const struct bvh_node_float *node, uint32_t child,
                          const struct bvh_box *box)
{
    for (int axis = 0; axis < 3; axis++)
        if (node->min[axis][child] != box->min[axis] || node->max[axis][child] != box->max[axis])
            return false;
    return true;
}

double bvh_float_half_area(const struct bvh_node_float *node, uint32_t first, uint32_t end)
{
    struct bvh_box all = box_empty();
    for (uint32_t i = first; i < end; i++) {
        for (int axis = 0; axis < 3; axis++) {
            all.min[axis] = fminf(all.min[axis], node->min[axis][i]);
            all.max[axis] = fmaxf(all.max[axis], node->max[axis][i]);
        }
    }
    return end > first ? box_half_area(&all) : 0;
}

static bool is_plain_zero(float value)
{
    return value == 0 && !signbit(value);
}

bool bvh_float_check(const struct bvh_node_float *node, uint32_t index, struct err *err)
{
    for (int i = 0; i < 4; i++)
        if (node->spare[i] != 0)
            return err_set(err, ERR_INPUT, "BVH: nodes[%u]: spare words are not 0", index);
    for (uint32_t i = bvh_child_count(node->child); i < 4; i++)
        for (int axis = 0; axis < 3; axis++)
            if (node->child[i] != BVH_EMPTY || !is_plain_zero(node->min[axis][i]) ||
                !is_plain_zero(node->max[axis][i]))
                return err_set(
                    err, ERR_INPUT,
                    "BVH: nodes[%u].child[%u] follows an empty child, or is empty but has "
                    "a box",
                    index, i);
    return true;
}
