// Tests BVH4 nodes of 128 bytes with boxes of floats. src/bvh writes them (struct bvh_node_float in
// bvh.h).
#ifndef BVH_NODE_FLOAT_GLSL
#define BVH_NODE_FLOAT_GLSL

#include "lib/buffers.glsl"
#include "lib/bvh_ray.glsl"

// Implements bvh_test_children().
//
// The test is conservative: the distance t of a plane has an error of 7 roundings of itself, 5 of
// the reciprocal (2.5 ulp by the Vulkan specification) and 2 of the arithmetic. In addition, the
// triangle test perturbs the ray relative to the far end of the triangle, which may be far behind
// the origin; so the margin is a fraction of the larger of the two distances of a slab.
ivec4 test_float_children(bvh_ray ray, uint index, float t_max, out uvec4 children)
{
    uint first = index * 8u;
    children = load_nodes(first);
    ivec4 nearest = ivec4(0);
    ivec4 farthest = ivec4(floatBitsToInt(t_max));
    for (uint axis = 0u; axis < 3u; axis++) {
        // Words 1 to 3 have the lower planes, words 4 to 6 the upper ones.
        uint low = first + 1u + axis;
        uint near_word = low + (ray.negative[axis] ? 3u : 0u);
        uint far_word = low + (ray.negative[axis] ? 0u : 3u);
        vec4 enter = (load_nodes_float(near_word) - ray.origin[axis]) * ray.inverse[axis];
        vec4 leave = (load_nodes_float(far_word) - ray.origin[axis]) * ray.inverse[axis];
        vec4 margin = max(abs(enter), abs(leave)) * (16.0 * ROUNDING);
        nearest = max(nearest, floatBitsToInt(enter - margin));
        farthest = min(farthest, floatBitsToInt(leave + margin));
    }
    ivec4 keys;
    for (int i = 0; i < 4; i++)
        keys[i] = nearest[i] <= farthest[i] && children[i] != BVH_EMPTY ? nearest[i] : BVH_MISS;
    return keys;
}

#endif
