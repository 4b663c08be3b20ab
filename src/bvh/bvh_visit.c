// Visits the primitives in leaves whose boxes a ray crosses.
#include "bvh/bvh_node.h"
#include "bvh/bvh_slab.h"

static void visit_leaf(const struct bvh *bvh, uint32_t leaf, bvh_visit_fn visit, void *context)
{
    uint32_t first = bvh_leaf_first(bvh, leaf);
    if (bvh_child_is_instance(leaf)) {
        visit(context, BVH_LEAF_INSTANCE | first);
        return;
    }
    for (uint32_t i = 0; i < bvh_leaf_count(bvh, leaf) && !(leaf & BVH_LEAF_SHAPE); i++)
        visit(context, bvh->triangle_order[first + i]);
}

void bvh_visit_ray(const struct bvh *bvh, uint32_t root, const double origin[3],
                   const double direction[3], bvh_visit_fn visit, void *context)
{
    const struct slab_ray slab = slab_ray_for(origin, direction);
    uint32_t stack[BVH_STACK_ENTRIES_MAX + 1], size = 1;
    stack[0] = root;
    while (size > 0) {
        uint32_t node = stack[--size];
        const uint32_t *child = bvh_children(bvh, node);
        for (uint32_t i = 0; i < bvh_child_count(child); i++) {
            double min[3], max[3], interval[2];
            bvh_child_box(bvh, node, i, min, max);
            if (!slab_test(&slab, min, max, interval))
                continue;
            if (bvh_child_is_leaf(child[i]))
                visit_leaf(bvh, child[i], visit, context);
            else
                stack[size++] = child[i];
        }
    }
}
