// Reads the child words of BVH nodes and tests their boxes, in either of the two node formats.
#ifndef BVH_NODE_GLSL
#define BVH_NODE_GLSL

#define BVH_LEAF 0x80000000u
#define BVH_LEAF_SHAPE 0x40000000u
#define BVH_LEAF_INSTANCE (BVH_LEAF_SHAPE | 0x20000000u)
#define BVH_LEAF_INDEX 0x1fffffffu // index of a shape or an instance
// The increment of a leaf's word for one more triangle. The word holds the number of triangles
// after the first one, in the bits above the first one's index.
#define BVH_LEAF_ONE_MORE (1u << LEAF_INDEX_BITS)
#define BVH_LEAF_MORE (BVH_LEAF_SHAPE - BVH_LEAF_ONE_MORE)
#define BVH_LEAF_TRIANGLE (BVH_LEAF_ONE_MORE - 1u)
#define BVH_EMPTY 0xffffffffu
#define BVH_MISS 0x7fffffff

#include "lib/bvh_node_float.glsl"
#include "lib/bvh_node_quantised.glsl"

// Sorts two values. This is a comparator of a sorting network.
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

// Tests the ray, clipped to (0, t_max), against the boxes of the four children of node `index`.
// Returns the bits of the entry distances; BVH_MISS for boxes that the ray misses.
//
// The distance of a box that begins behind the origin is clamped to 0, so that the bits of all
// distances have the order of integers. Integer minima and maxima are cheaper than those of floats,
// which must handle NaN on some devices.
ivec4 bvh_test_children(bvh_ray ray, uint index, float t_max, out uvec4 children)
{
    if (NODES == NODES_FLOAT)
        return test_float_children(ray, index, t_max, children);
    return test_quantised_children(ray, index, t_max, children);
}

#endif
