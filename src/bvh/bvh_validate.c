// Validates a tree against its primitives: for tests, and for trees that were read from a file.
#include "bvh/bvh_node.h"
#include "bvh/bvh_triangle.h"

struct validator {
    const struct bvh *bvh;
    const struct bvh_params *params;
    uint8_t *node_seen, *place_seen, *shape_seen, *instance_seen;
    uint8_t *triangle_places; // number of entries of each triangle; 2 stands for two or more
    struct bvh_box *bounds;   // bounds of the primitives below each node
    bool has_parts;           // whether some triangle has several entries
    struct err *err;
};

static bool allocate(struct validator *validator, struct arena *scratch)
{
    const struct bvh *bvh = validator->bvh;
    validator->node_seen = ARENA_NEW(scratch, uint8_t, bvh->node_count);
    validator->triangle_places = ARENA_NEW(scratch, uint8_t, bvh->triangle_count);
    validator->place_seen = ARENA_NEW(scratch, uint8_t, bvh->reference_count);
    validator->shape_seen = ARENA_NEW(scratch, uint8_t, validator->params->shape_count);
    validator->instance_seen = ARENA_NEW(scratch, uint8_t, validator->params->instance_count);
    validator->bounds = ARENA_NEW(scratch, struct bvh_box, bvh->node_count);
    if (!validator->node_seen || !validator->triangle_places || !validator->place_seen ||
        !validator->shape_seen || !validator->instance_seen || !validator->bounds)
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
        return err_set(validator->err, ERR_INPUT, "BVH: %u triangles; expected %u",
                       bvh->triangle_count, validator->params->triangle_count);
    if (bvh->reference_count < bvh->triangle_count ||
        bvh->reference_count > bvh_leaf_index_max(bvh->max_leaf))
        return err_set(validator->err, ERR_INPUT,
                       "BVH: %u references for %u triangles; expected at least one per triangle, "
                       "and no more than leaf words can index",
                       bvh->reference_count, bvh->triangle_count);
    return true;
}

static bool count_places(struct validator *validator)
{
    const struct bvh *bvh = validator->bvh;
    validator->has_parts = bvh->reference_count > bvh->triangle_count;
    for (uint32_t i = 0; i < bvh->reference_count; i++) {
        uint32_t triangle = bvh->triangle_order[i];
        if (triangle >= bvh->triangle_count)
            return err_set(validator->err, ERR_INPUT,
                           "BVH: triangle_order[%u]: there is no triangle %u", i, triangle);
        uint8_t *places = &validator->triangle_places[triangle];
        *places = (uint8_t)(*places + (*places < 2));
        if (*places > 1 && !validator->has_parts)
            return err_set(validator->err, ERR_INPUT, "BVH: triangle %u is in two leaves",
                           triangle);
    }
    return true;
}

// Marks a shape or an instance as seen and gets its box. Fails if it was seen before.
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

// Marks an entry as seen and adds its triangle's box to the bounds. A triangle with several entries
// is skipped here: which part belongs to this entry is not known, and all its entries are checked
// together later.
static bool visit_place(struct validator *validator, uint32_t place, struct bvh_box *bounds)
{
    uint32_t index = validator->bvh->triangle_order[place];
    if (validator->place_seen[place])
        return err_set(validator->err, ERR_INPUT, "BVH: triangle_order[%u] is in two leaves",
                       place);
    validator->place_seen[place] = 1;
    if (validator->triangle_places[index] > 1)
        return true;
    float vertices[3][3];
    bvh_triangle_load(validator->params, index, vertices);
    for (int i = 0; i < 3; i++)
        box_add_point(bounds, vertices[i]);
    return true;
}

static bool visit_leaf(struct validator *validator, uint32_t leaf, struct bvh_box *bounds)
{
    const struct bvh *bvh = validator->bvh;
    uint32_t first = bvh_leaf_first(bvh, leaf);
    const struct bvh_params *params = validator->params;
    if ((leaf & BVH_LEAF_INSTANCE) == BVH_LEAF_INSTANCE)
        return visit_box(validator, "instance", params->instance_boxes, params->instance_count,
                         first, validator->instance_seen, bounds);
    if (leaf & BVH_LEAF_SHAPE)
        return visit_box(validator, "shape", params->shape_boxes, params->shape_count, first,
                         validator->shape_seen, bounds);
    uint32_t count = bvh_leaf_count(bvh, leaf), most = bvh_max_leaf(&params->method);
    if (count > most)
        return err_set(validator->err, ERR_INPUT,
                       "BVH: a leaf has %u triangles; expected at most %u", count, most);
    if (first >= bvh->reference_count || count > bvh->reference_count - first)
        return err_set(validator->err, ERR_INPUT,
                       "BVH: a leaf has triangles %u to %u of a leaf order of %u triangles", first,
                       first + count - 1, bvh->reference_count);
    for (uint32_t i = first; i < first + count; i++) {
        if (!visit_place(validator, i, bounds))
            return false;
    }
    return true;
}

// Returns whether a child's stored box is valid for `bounds`, the bounds of everything below the
// child. The box may be larger if some triangle of the tree has several entries.
static bool fits(const struct validator *validator, uint32_t node, uint32_t child,
                 const struct bvh_box *bounds)
{
    if (!validator->has_parts)
        return bvh_child_fits(validator->bvh, node, child, bounds);
    double min[3], max[3];
    bvh_child_box(validator->bvh, node, child, min, max);
    bool contains = true;
    for (int axis = 0; axis < 3; axis++)
        contains = contains && min[axis] <= (double)bounds->min[axis] &&
                   max[axis] >= (double)bounds->max[axis];
    return contains;
}

// Checks a child. Nodes are visited in reverse order, children before parents.
static bool visit_child(struct validator *validator, uint32_t index, uint32_t i)
{
    uint32_t child = bvh_children(validator->bvh, index)[i];
    struct bvh_box bounds = box_empty();
    if (bvh_child_is_leaf(child)) {
        if (!visit_leaf(validator, child, &bounds))
            return err_prepend(validator->err, "nodes[%u].child[%u]", index, i);
    } else {
        // Children come after their parents, so there are no cycles.
        if (child <= index || child >= validator->bvh->node_count || validator->node_seen[child])
            return err_set(
                validator->err, ERR_INPUT,
                "BVH: nodes[%u].child[%u]: %u is not a later node, or has another parent", index, i,
                child);
        validator->node_seen[child] = 1;
        bounds = validator->bounds[child];
    }
    if (!fits(validator, index, i, &bounds))
        return err_set(validator->err, ERR_INPUT,
                       "BVH: nodes[%u].child[%u]: the box does not fit its contents", index, i);
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
    for (uint32_t i = 0; i < validator->bvh->reference_count; i++)
        if (!validator->place_seen[i])
            return err_set(validator->err, ERR_INPUT, "BVH: triangle_order[%u] is in no leaf", i);
    for (uint32_t i = 0; i < validator->params->triangle_count; i++)
        if (validator->triangle_places[i] == 0)
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
                       "BVH: depth %u and stack_entries %u; expected %u and %u", have->depth,
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
    bool ok = check_counts(&validator) && allocate(&validator, &scratch) &&
              count_places(&validator) && visit_all(&validator) && check_all_seen(&validator) &&
              check_stats(&validator) &&
              (!validator.has_parts || bvh_validate_parts(bvh, params, err));
    arena_finish(&scratch);
    return ok;
}
