// Validates triangles with several entries: every point of such a triangle must be inside all boxes
// on the path to one of its entries.
#include "bvh/bvh_node.h"
#include "bvh/bvh_triangle.h"

enum { STEPS = 12 }; // test points of a triangle: a grid of this many steps per edge

struct bounds {
    double min[3], max[3];
};

struct parts {
    const struct bvh *bvh;
    const struct bvh_params *params;
    struct bounds *nodes;  // for each node, the intersection of the boxes above it
    struct bounds *places; // likewise for each entry of triangle_order
    uint32_t *first;       // index of triangle i's first entry in `sorted`; one more at the end
    uint32_t *sorted;      // entries, sorted by triangle
    struct err *err;
};

static bool allocate(struct parts *parts, struct arena *scratch)
{
    const struct bvh *bvh = parts->bvh;
    parts->nodes = ARENA_NEW(scratch, struct bounds, bvh->node_count);
    parts->places = ARENA_NEW(scratch, struct bounds, bvh->reference_count);
    parts->first = ARENA_NEW(scratch, uint32_t, (size_t)bvh->triangle_count + 2);
    parts->sorted = ARENA_NEW(scratch, uint32_t, bvh->reference_count);
    if (!parts->nodes || !parts->places || !parts->first || !parts->sorted)
        return err_memory(parts->err, "validating the BVH",
                          bvh->reference_count * sizeof *parts->places);
    return true;
}

// Intersects boxes downwards from the root. Nodes come after their parents.
static void descend(struct parts *parts)
{
    const struct bvh *bvh = parts->bvh;
    for (int axis = 0; axis < 3; axis++) {
        parts->nodes[0].min[axis] = -INFINITY;
        parts->nodes[0].max[axis] = INFINITY;
    }
    for (uint32_t n = 0; n < bvh->node_count; n++) {
        const uint32_t *child = bvh_children(bvh, n);
        for (uint32_t i = 0; i < bvh_child_count(child); i++) {
            struct bounds box;
            bvh_child_box(bvh, n, i, box.min, box.max);
            for (int axis = 0; axis < 3; axis++) {
                box.min[axis] = fmax(box.min[axis], parts->nodes[n].min[axis]);
                box.max[axis] = fmin(box.max[axis], parts->nodes[n].max[axis]);
            }
            uint32_t first = bvh_leaf_first(bvh, child[i]);
            if (!bvh_child_is_leaf(child[i]))
                parts->nodes[child[i]] = box;
            else if (!(child[i] & BVH_LEAF_SHAPE))
                for (uint32_t k = 0; k < bvh_leaf_count(bvh, child[i]); k++)
                    parts->places[first + k] = box;
        }
    }
}

static void sort_places(struct parts *parts)
{
    const struct bvh *bvh = parts->bvh;
    for (uint32_t i = 0; i < bvh->reference_count; i++)
        parts->first[bvh->triangle_order[i] + 2]++;
    for (uint32_t t = 0; t < bvh->triangle_count; t++)
        parts->first[t + 2] += parts->first[t + 1];
    for (uint32_t i = 0; i < bvh->reference_count; i++)
        parts->sorted[parts->first[bvh->triangle_order[i] + 1]++] = i;
}

static bool is_in_part(const struct parts *parts, uint32_t triangle, const double point[3])
{
    for (uint32_t i = parts->first[triangle]; i < parts->first[triangle + 1]; i++) {
        const struct bounds *box = &parts->places[parts->sorted[i]];
        bool inside = true;
        for (int axis = 0; axis < 3; axis++)
            inside = inside && point[axis] >= box->min[axis] && point[axis] <= box->max[axis];
        if (inside)
            return true;
    }
    return false;
}

static bool check_triangle(const struct parts *parts, uint32_t triangle)
{
    float v[3][3];
    bvh_triangle_load(parts->params, triangle, v);
    for (int i = 0; i <= STEPS; i++)
        for (int k = 0; k <= STEPS - i; k++) {
            double a = (double)i / STEPS, b = (double)k / STEPS, point[3];
            for (int axis = 0; axis < 3; axis++) { // rounding must not move the point out of the
                                                   // triangle's bounds
                double x = v[0][axis], y = v[1][axis], z = v[2][axis];
                point[axis] = (1 - a - b) * x + a * y + b * z;
                point[axis] = fmin(fmax(point[axis], fmin(x, fmin(y, z))), fmax(x, fmax(y, z)));
            }
            if (!is_in_part(parts, triangle, point))
                return err_set(parts->err, ERR_INPUT,
                               "BVH: triangle %u at (%g %g %g) is in none of its %u leaves",
                               triangle, point[0], point[1], point[2],
                               parts->first[triangle + 1] - parts->first[triangle]);
        }
    return true;
}

bool bvh_validate_parts(const struct bvh *bvh, const struct bvh_params *params, struct err *err)
{
    struct arena scratch = {0};
    struct parts parts = {.bvh = bvh, .params = params, .err = err};
    bool ok = allocate(&parts, &scratch);
    if (ok) {
        descend(&parts);
        sort_places(&parts);
    }
    for (uint32_t t = 0; ok && t < bvh->triangle_count; t++)
        if (parts.first[t + 1] - parts.first[t] > 1)
            ok = check_triangle(&parts, t);
    arena_finish(&scratch);
    return ok;
}
