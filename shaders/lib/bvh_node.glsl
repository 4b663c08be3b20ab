// The BVH's nodes, in whichever of their two formats: child words, and testing the boxes.
#ifndef BVH_NODE_GLSL
#define BVH_NODE_GLSL

#define BVH_LEAF 0x80000000u
#define BVH_LEAF_SHAPE 0x40000000u
#define BVH_LEAF_INSTANCE (BVH_LEAF_SHAPE | 0x20000000u)
#define BVH_LEAF_INDEX 0x1fffffffu // number of a shape or an instance
// A leaf of triangles: how many come after the first one, above the bits of that one's index.
#define BVH_LEAF_ONE_MORE (1u << LEAF_INDEX_BITS)
#define BVH_LEAF_MORE (BVH_LEAF_SHAPE - BVH_LEAF_ONE_MORE)
#define BVH_LEAF_TRIANGLE (BVH_LEAF_ONE_MORE - 1u)
#define BVH_EMPTY 0xffffffffu
#define BVH_MISS 0x7fffffff

#include "lib/bvh_node_float.glsl"
#include "lib/bvh_node_quantised.glsl"

// One comparator of a sorting network.
void order(inout int a, inout int b)
{
    int low = min(a, b);
    b = max(a, b);
    a = low;
}

uint child_word(uvec4 children, int key)
{
    uint low = (key & 1) != 0 ? children.y : children.x;
    uint high = (key & 1) != 0 ? children.w : children.z;
    return (key & 2) != 0 ? high : low;
}

// Tests the ray, clipped to (0, t_max), against the four children of node `index`: the bits of each
// one's entry distance, or BVH_MISS.
//
// Distances of boxes behind the origin are clamped to 0, so that their bits order like integers;
// integer minima and maxima are cheaper than float ones where those have to mind NaN.
ivec4 bvh_test_children(bvh_ray ray, uint index, float t_max, out uvec4 children)
{
    if (NODES == NODES_FLOAT)
        return test_float_children(ray, index, t_max, children);
    return test_quantised_children(ray, index, t_max, children);
}

#endif
