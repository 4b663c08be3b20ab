// Encodes the quantised node, whose child boxes are bytes on a grid that the node's box spans.
#include "bvh/bvh_node.h"

#include <string.h>

// Returns 2^(exponent - 127) for an axis. It is exact, because the biased exponent is in [1, 254].
static double node_scale(const struct bvh_node *node, int axis)
{
    uint32_t bits = (node->exponents >> (8 * axis) & 255u) << 23;
    float scale;
    memcpy(&scale, &bits, sizeof scale);
    return scale;
}

// Returns the sign of (a + b) - c in exact arithmetic. A plane of the grid is a + b with b = byte *
// scale, which a double represents exactly. The rounded sum decides unless it equals c; then its
// rounding error decides (TwoSum, Knuth 1969, The Art of Computer Programming 2, section 4.2.2,
// theorem B).
static int compare_sum(double a, double b, double c)
{
    double sum = a + b;
    if (sum != c)
        return sum > c ? 1 : -1;
    double b_part = sum - a;
    double error = (a - (sum - b_part)) + (b - b_part);
    return (error > 0) - (error < 0);
}

// Returns the smallest biased exponent in [1, 254] whose grid of 255 steps extends from min to max.
// There always is one: floats differ by less than 2^129, and 255 * 2^127 is more.
static uint32_t grid_exponent(float min, float max)
{
    int exponent;
    // extent / 255 < 2^exponent, up to rounding. The next lower exponent often suffices, because
    // 255 is almost 256.
    frexp(((double)max - min) / 255, &exponent);
    uint32_t biased = exponent + 126 > 1 ? (uint32_t)(exponent + 126) : 1;
    while (compare_sum(min, ldexp(255, (int)biased - 127), max) < 0)
        biased++;
    return biased;
}

// Return the last grid plane at or below a value, and the first one at or above it.
static uint32_t round_down(float origin, double scale, float value)
{
    double steps = floor(((double)value - origin) / scale);
    uint32_t byte = steps < 255 ? (uint32_t)steps : 255;
    while (byte > 0 && compare_sum(origin, byte * scale, value) > 0)
        byte--;
    return byte;
}

static uint32_t round_up(float origin, double scale, float value)
{
    double steps = ceil(((double)value - origin) / scale);
    uint32_t byte = steps < 255 ? (uint32_t)steps : 255;
    while (byte < 255 && compare_sum(origin, byte * scale, value) < 0)
        byte++;
    return byte;
}

void bvh_quantised_set_boxes(struct bvh_node *node, const struct bvh_box *boxes, uint32_t count)
{
    struct bvh_box all = count > 0 ? boxes[0] : (struct bvh_box){0};
    for (uint32_t i = 1; i < count; i++)
        box_add_box(&all, &boxes[i]);
    node->exponents = 0;
    for (int axis = 0; axis < 3; axis++) {
        node->origin[axis] = all.min[axis];
        node->exponents |= grid_exponent(all.min[axis], all.max[axis]) << (8 * axis);
        double scale = node_scale(node, axis);
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

void bvh_quantised_child_box(const struct bvh_node *node, uint32_t child, double min[3],
                             double max[3])
{
    for (int axis = 0; axis < 3; axis++) {
        double origin = node->origin[axis], scale = node_scale(node, axis);
        double lo = (node->lo[axis] >> (8 * child) & 255u) * scale;
        double hi = (node->hi[axis] >> (8 * child) & 255u) * scale;
        min[axis] = origin + lo;
        max[axis] = origin + hi;
        if (compare_sum(origin, lo, min[axis]) < 0)
            min[axis] = nextafter(min[axis], -INFINITY);
        if (compare_sum(origin, hi, max[axis]) > 0)
            max[axis] = nextafter(max[axis], INFINITY);
    }
}

bool bvh_quantised_child_fits(const struct bvh_node *node, uint32_t child,
                              const struct bvh_box *box)
{
    for (int axis = 0; axis < 3; axis++) {
        double origin = node->origin[axis], scale = node_scale(node, axis);
        double lo = (node->lo[axis] >> (8 * child) & 255u) * scale;
        double hi = (node->hi[axis] >> (8 * child) & 255u) * scale;
        if (compare_sum(origin, lo, box->min[axis]) > 0 ||
            compare_sum(origin, hi, box->max[axis]) < 0)
            return false;
    }
    return true;
}

double bvh_quantised_half_area(const struct bvh_node *node, uint32_t first, uint32_t end)
{
    double size[3];
    for (int axis = 0; axis < 3; axis++) {
        int min = 255, max = 0;
        for (uint32_t i = first; i < end; i++) {
            int lo = node->lo[axis] >> (8 * i) & 255u, hi = node->hi[axis] >> (8 * i) & 255u;
            min = lo < min ? lo : min;
            max = hi > max ? hi : max;
        }
        size[axis] = (max > min ? max - min : 0) * node_scale(node, axis);
    }
    return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
}

bool bvh_quantised_check(const struct bvh_node *node, uint32_t index, struct err *err)
{
    for (int axis = 0; axis < 3; axis++) {
        if (!isfinite(node->origin[axis]))
            return err_set(err, ERR_INPUT, "BVH: nodes[%u].origin is not finite", index);
        uint32_t exponent = node->exponents >> (8 * axis) & 255u;
        if (exponent < 1 || exponent > 254)
            return err_set(err, ERR_INPUT, "BVH: nodes[%u].exponents: %u is outside [1, 254]",
                           index, exponent);
    }
    if (node->exponents >> 24 != 0 || node->spare[0] != 0 || node->spare[1] != 0)
        return err_set(err, ERR_INPUT, "BVH: nodes[%u]: spare bits are not 0", index);
    for (uint32_t i = bvh_child_count(node->child); i < 4; i++)
        for (int axis = 0; axis < 3; axis++)
            if (node->child[i] != BVH_EMPTY || (node->lo[axis] >> (8 * i) & 255u) != 255 ||
                (node->hi[axis] >> (8 * i) & 255u) != 0)
                return err_set(
                    err, ERR_INPUT,
                    "BVH: nodes[%u].child[%u] follows an empty child, or is empty but has "
                    "a box",
                    index, i);
    return true;
}

bool bvh_nodes_allocate(struct arena *arena, struct bvh *out, struct err *err)
{
    if (out->format == BVH_FLOAT)
        out->nodes_float = ARENA_NEW(arena, struct bvh_node_float, out->node_count);
    else
        out->nodes = ARENA_NEW(arena, struct bvh_node, out->node_count);
    return bvh_nodes_data(out) || err_memory(err, "the BVH's nodes", bvh_nodes_bytes(out));
}
