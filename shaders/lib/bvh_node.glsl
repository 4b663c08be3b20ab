// The node format: a quantised BVH4 of 64 bytes, written by src/bvh (struct bvh_node in bvh.h).
#ifndef BVH_NODE_GLSL
#define BVH_NODE_GLSL

#include "lib/buffers.glsl"

#define BVH_LEAF 0x80000000u
#define BVH_LEAF_SHAPE 0x40000000u
#define BVH_LEAF_TWO 0x20000000u
#define BVH_LEAF_INDEX 0x1fffffffu
#define BVH_EMPTY 0xffffffffu
#define BVH_MISS 0x7fffffff

// What the box tests need of a ray.
struct bvh_ray {
    vec3 origin;
    vec3 inverse; // 1 / direction, finite
    bvec3 negative;
};

bvh_ray bvh_ray_create(vec3 origin, vec3 direction)
{
    // A component this small moves the ray by less than the tests' margin over any distance that a
    // float scene spans; its reciprocal times a coordinate stays finite.
    const float smallest = 1e-18;
    vec3 d = mix(direction, mix(vec3(smallest), vec3(-smallest), lessThan(direction, vec3(0.0))),
                 lessThan(abs(direction), vec3(smallest)));
    return bvh_ray(origin, 1.0 / d, lessThan(d, vec3(0.0)));
}

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
//
// Conservative: with plane p = node origin + q * scale, t = q * (scale * inverse) + (node origin -
// ray origin) * inverse is off by less than 16 roundings of |node origin - ray origin| * |inverse|
// + 255 * scale * |inverse|: 5 for the reciprocal (2.5 ulp by the Vulkan specification), at most 4
// for the arithmetic, the rest for the triangle test's own perturbation of the ray. The slabs are
// widened by that much (after Ize 2013, "Robust BVH Ray Traversal").
ivec4 bvh_test_children(bvh_ray ray, uint index, float t_max, out uvec4 children)
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
