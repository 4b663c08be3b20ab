// Checking a tree against its primitives: for tests, and for trees that come from a file.
#include "bvh_node.h"
#include "bvh_triangle.h"

struct validator {
    const struct bvh *bvh;
    const struct bvh_params *params;
    uint8_t *node_seen, *triangle_seen, *shape_seen, *instance_seen;
    struct bvh_box *bounds; // of the primitives below each node
    uint32_t order_used;    // entries of triangle_order in leaves
    struct err *err;
};

static bool allocate(struct validator *validator, struct arena *scratch)
{
    const struct bvh *bvh = validator->bvh;
    validator->node_seen = ARENA_NEW(scratch, uint8_t, bvh->node_count);
    validator->triangle_seen = ARENA_NEW(scratch, uint8_t, bvh->triangle_count);
    validator->shape_seen = ARENA_NEW(scratch, uint8_t, validator->params->shape_count);
    validator->instance_seen = ARENA_NEW(scratch, uint8_t, validator->params->instance_count);
    validator->bounds = ARENA_NEW(scratch, struct bvh_box, bvh->node_count);
    if (!validator->node_seen || !validator->triangle_seen || !validator->shape_seen ||
        !validator->instance_seen || !validator->bounds)
        return err_memory(validator->err, "validating the BVH",
                          bvh->node_count * sizeof *validator->bounds);
    return true;
}

static bool check_counts(const struct validator *validator)
{
    const struct bvh *bvh = validator->bvh;
    if (bvh->node_count == 0 || bvh->node_count >= BVH_LEAF || !bvh_nodes_data(bvh))
        return err_set(validator->err, ERR_INPUT, "BVH: node_count: %u is not in [1, 2^31)",
                       bvh->node_count);
    if (bvh->triangle_count != validator->params->triangle_count)
        return err_set(validator->err, ERR_INPUT, "BVH: %u triangles, expected %u",
                       bvh->triangle_count, validator->params->triangle_count);
    return true;
}

// Of an array of boxes: each may be seen once.
static bool visit_box(struct validator *validator, const char *kind, const struct bvh_box *boxes,
                      uint32_t count, uint32_t index, uint8_t *seen, struct bvh_box *bounds)
{
    if (index >= count)
        return err_set(validator->err, ERR_INPUT, "BVH: there is no %s %u", kind, index);
    if (seen[index])
        return err_set(validator->err, ERR_INPUT, "BVH: %s %u is in two leaves", kind, index);
    seen[index] = 1;
    box_add_box(bounds, &boxes[index]);
    return true;
}

// Marks a triangle and adds its box; each may be seen once.
static bool visit_triangle(struct validator *validator, uint32_t index, struct bvh_box *bounds)
{
    const struct bvh_params *params = validator->params;
    if (index >= params->triangle_count)
        return err_set(validator->err, ERR_INPUT, "BVH: there is no triangle %u", index);
    if (validator->triangle_seen[index])
        return err_set(validator->err, ERR_INPUT, "BVH: triangle %u is in two leaves", index);
    validator->triangle_seen[index] = 1;
    float vertices[3][3];
    bvh_triangle_load(params, index, vertices);
    for (int i = 0; i < 3; i++)
        box_add_point(bounds, vertices[i]);
    return true;
}

static bool visit_leaf(struct validator *validator, uint32_t leaf, struct bvh_box *bounds)
{
    const struct bvh *bvh = validator->bvh;
    uint32_t first = leaf & BVH_LEAF_INDEX;
    const struct bvh_params *params = validator->params;
    if ((leaf & BVH_LEAF_INSTANCE) == BVH_LEAF_INSTANCE)
        return visit_box(validator, "instance", params->instance_boxes, params->instance_count,
                         first, validator->instance_seen, bounds);
    if (leaf & BVH_LEAF_SHAPE)
        return visit_box(validator, "shape", params->shape_boxes, params->shape_count, first,
                         validator->shape_seen, bounds);
    uint32_t count = bvh_leaf_count(leaf);
    if (count == 2 && params->max_leaf == 1)
        return err_set(validator->err, ERR_INPUT,
                       "BVH: a leaf has two triangles, at most 1 allowed");
    if (first >= bvh->reference_count || count > bvh->reference_count - first)
        return err_set(validator->err, ERR_INPUT,
                       "BVH: a leaf has triangles %u to %u of %u in leaf order", first,
                       first + count - 1, bvh->reference_count);
    for (uint32_t i = first; i < first + count; i++) {
        if (!visit_triangle(validator, bvh->triangle_order[i], bounds))
            return false;
    }
    return true;
}

// Nodes are visited backwards, children before parents.
static bool visit_child(struct validator *validator, uint32_t index, uint32_t i)
{
    uint32_t child = bvh_children(validator->bvh, index)[i];
    struct bvh_box bounds = box_empty();
    if (bvh_child_is_leaf(child)) {
        if (!visit_leaf(validator, child, &bounds))
            return err_prepend(validator->err, "nodes[%u].child[%u]", index, i);
    } else {
        // That children stand after their parents excludes cycles.
        if (child <= index || child >= validator->bvh->node_count || validator->node_seen[child])
            return err_set(validator->err, ERR_INPUT,
                           "BVH: nodes[%u].child[%u]: %u is not a later node without parent", index,
                           i, child);
        validator->node_seen[child] = 1;
        bounds = validator->bounds[child];
    }
    if (!bvh_child_fits(validator->bvh, index, i, &bounds))
        return err_set(validator->err, ERR_INPUT,
                       "BVH: nodes[%u].child[%u]: the box is not one of what is below", index, i);
    box_add_box(&validator->bounds[index], &bounds);
    return true;
}

static bool visit_all(struct validator *validator)
{
    for (uint32_t n = validator->bvh->node_count; n-- > 0;) {
        validator->bounds[n] = box_empty();
        if (!bvh_node_check(validator->bvh, n, validator->err))
            return false;
        for (uint32_t i = 0; i < bvh_child_count(bvh_children(validator->bvh, n)); i++)
            if (!visit_child(validator, n, i))
                return false;
    }
    return true;
}

static bool check_all_seen(const struct validator *validator)
{
    for (uint32_t i = 1; i < validator->bvh->node_count; i++)
        if (!validator->node_seen[i])
            return err_set(validator->err, ERR_INPUT, "BVH: nodes[%u] has no parent", i);
    for (uint32_t i = 0; i < validator->params->triangle_count; i++)
        if (!validator->triangle_seen[i])
            return err_set(validator->err, ERR_INPUT, "BVH: triangle %u is in no leaf", i);
    for (uint32_t i = 0; i < validator->params->shape_count; i++)
        if (!validator->shape_seen[i])
            return err_set(validator->err, ERR_INPUT, "BVH: shape %u is in no leaf", i);
    for (uint32_t i = 0; i < validator->params->instance_count; i++)
        if (!validator->instance_seen[i])
            return err_set(validator->err, ERR_INPUT, "BVH: instance %u is in no leaf", i);
    return true;
}

static bool check_stats(const struct validator *validator)
{
    const struct bvh_stats *have = &validator->bvh->stats;
    struct bvh_stats want;
    if (!bvh_compute_stats(validator->bvh, &want, validator->err))
        return false;
    if (have->depth != want.depth || have->stack_entries != want.stack_entries)
        return err_set(validator->err, ERR_INPUT,
                       "BVH: depth %u and stack_entries %u, expected %u and %u", have->depth,
                       have->stack_entries, want.depth, want.stack_entries);
    if (want.stack_entries > BVH_STACK_ENTRIES_MAX)
        return err_set(validator->err, ERR_INPUT, "BVH: stack_entries: %u is more than %u",
                       want.stack_entries, BVH_STACK_ENTRIES_MAX);
    if (have->node_count != want.node_count || have->leaf_count != want.leaf_count ||
        have->bytes != want.bytes || have->sah_cost != want.sah_cost)
        return err_set(validator->err, ERR_INPUT,
                       "BVH: stats: %u nodes, %u leaves, %llu bytes, SAH cost %.17g; expected %u, "
                       "%u, %llu, %.17g",
                       have->node_count, have->leaf_count, (unsigned long long)have->bytes,
                       have->sah_cost, want.node_count, want.leaf_count,
                       (unsigned long long)want.bytes, want.sah_cost);
    return true;
}

bool bvh_validate(const struct bvh *bvh, const struct bvh_params *params, struct err *err)
{
    struct arena scratch = {0};
    struct validator validator = {.bvh = bvh, .params = params, .err = err};
    bool ok = check_counts(&validator) && allocate(&validator, &scratch) && visit_all(&validator) &&
              check_all_seen(&validator) && check_stats(&validator);
    arena_finish(&scratch);
    return ok;
}
