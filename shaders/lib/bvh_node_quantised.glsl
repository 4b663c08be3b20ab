// Tests BVH4 nodes of 64 bytes with 8-bit boxes. src/bvh writes them (struct bvh_node in bvh.h).
#ifndef BVH_NODE_QUANTISED_GLSL
#define BVH_NODE_QUANTISED_GLSL

#include "lib/buffers.glsl"
#include "lib/bvh_ray.glsl"

// Implements bvh_test_children().
//
// The test is conservative. For the plane p = node origin + q * scale, the distance t = q * (scale
// * inverse) + (node origin - ray origin) * inverse has an error of less than 16 roundings of |node
// origin - ray origin| * |inverse| + 255 * scale * |inverse|: 5 of the reciprocal (2.5 ulp by the
// Vulkan specification), at most 4 of the arithmetic, the rest for the perturbation of the ray by
// the triangle test. The slabs are widened by that much (after Ize 2013, "Robust BVH Ray
// Traversal").
ivec4 test_quantised_children(bvh_ray ray, uint index, float t_max, out uvec4 children)
{
    uvec4 head = load_nodes(index * 4u);
    children = load_nodes(index * 4u + 1u);
    uvec4 low = load_nodes(index * 4u + 2u);
    uvec2 high = load_nodes(index * 4u + 3u).xy;

    vec3 scale = uintBitsToFloat((uvec3(head.w, head.w >> 8u, head.w >> 16u) & 255u) << 23u);
    vec3 slope = scale * ray.inverse;
    vec3 offset = (uintBitsToFloat(head.xyz) - ray.origin) * ray.inverse;
    vec3 margin = (abs(offset) + 255.0 * abs(slope)) * (16.0 * ROUNDING);
    vec3 offset_near = offset - margin;
    vec3 offset_far = offset + margin;

    uvec3 low_planes = low.xyz;
    uvec3 high_planes = uvec3(low.w, high);
    uvec3 near_planes = mix(low_planes, high_planes, ray.negative);
    uvec3 far_planes = mix(high_planes, low_planes, ray.negative);
    int limit = floatBitsToInt(t_max);

    ivec4 keys;
    for (int i = 0; i < 4; i++) {
        uint shift = uint(i) * 8u;
        ivec3 enter = floatBitsToInt(vec3((near_planes >> shift) & 255u) * slope + offset_near);
        ivec3 leave = floatBitsToInt(vec3((far_planes >> shift) & 255u) * slope + offset_far);
        int first = max(max(enter.x, enter.y), max(enter.z, 0));
        int last = min(min(leave.x, leave.y), min(leave.z, limit));
        keys[i] = first <= last && children[i] != BVH_EMPTY ? first : BVH_MISS;
    }
    return keys;
}

#endif
