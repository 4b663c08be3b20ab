// Depth-first traversal of the BVH, nearest child first. Included by the kernels that trace; a
// kernel defines ANY_HIT to stop at the first hit.
#ifndef TRAVERSE_GLSL
#define TRAVERSE_GLSL

#include "lib/alpha.glsl"
#include "lib/bvh_node.glsl"
#include "lib/intersect_triangle.glsl"
#include "lib/shape_leaf.glsl"
#include "lib/steps.glsl"
#include "lib/trace_types.glsl"

// The plane of the triangle that a ray starts on. Its coplanar neighbours cannot be hit either:
// their distance is 0 and must not become more by rounding, which is some epsilon times the
// triangle's size.
struct left_plane {
    vec3 normal; // not normalised
    bool exists;
};

left_plane load_left_plane(uint primitive)
{
    left_plane plane = left_plane(vec3(0.0), false);
    if (HAS(FEATURE_TRIANGLES) && primitive < PRIMITIVE_SHAPE) {
        vec3 v0 = load_triangles_float(primitive * 3u).xyz;
        vec3 v1 = load_triangles_float(primitive * 3u + 1u).xyz;
        vec3 v2 = load_triangles_float(primitive * 3u + 2u).xyz;
        plane = left_plane(cross(v1 - v0, v2 - v0), true);
    }
    return plane;
}

// Whether a corner lies in the plane through the ray's origin. Of its computed height at most 16
// roundings of the coordinates are error: 7 by which the origin was moved off the surface, 4 of the
// normal, 5 of the difference and the dot product.
bool in_plane(left_plane plane, vec3 origin, vec3 corner)
{
    float height = dot(plane.normal, corner - origin);
    return abs(height) <= GAMMA(16) * dot(abs(plane.normal), abs(corner) + abs(origin));
}

// What a traversal is in the middle of.
struct trace_state {
    uint current; // node, or leaf word, or BVH_EMPTY: done
    uint depth;   // entries on the stack, the sentinel included
    float march;  // how far the ray has got through the distance field of the leaf in hand; 0: not
                  // begun
};

uint stack[STACK_ENTRIES + 2u]; // the sentinel, and one that a branch-free push may overwrite

void trace_begin(out trace_state state)
{
    stack[0] = BVH_EMPTY;
    state = trace_state(0u, 1u, 0.0);
}

void intersect_triangle_leaf(trace_ray ray, triangle_frame frame, left_plane plane, uint index,
                             inout trace_hit best)
{
    uvec4 w0 = load_triangles(index * 3u);
    uvec4 w1 = load_triangles(index * 3u + 1u);
    uvec4 w2 = load_triangles(index * 3u + 2u);
    vec3 v0 = uintBitsToFloat(w0.xyz);
    vec3 v1 = uintBitsToFloat(w1.xyz);
    vec3 v2 = uintBitsToFloat(w2.xyz);
    float t;
    vec2 uv;
    bool leaves = plane.exists && in_plane(plane, ray.origin, v0) &&
                  in_plane(plane, ray.origin, v1) && in_plane(plane, ray.origin, v2);
    bool hit = intersect_triangle(frame, ray.origin, v0, v1, v2, t, uv) && !leaves &&
               index != ray.ignore_a && index != ray.ignore_b;
    if (HAS(FEATURE_ALPHA) && hit && t > 0.0 && t <= best.t && (w1.w & MATERIAL_WORD_ALPHA) != 0u)
        hit = alpha_passes(index, uv, vec3(0.0), w1.w, w0.w, ray.alpha);
    accept_hit(best, hit, t, uv, index, w0.w);
}

// Chooses the next node among the children that the ray enters and pushes the others. `keys` are
// the entry distances' bits, or BVH_MISS; `top` is the stack's top, popped when there is no child.
// Branch-free: every push is written, and the depth says which ones count.
#ifdef ANY_HIT
// The first hit will do: in the children's own order, which saves the sorting.
uint visit_children(ivec4 keys, uvec4 children, uint top, inout uint depth)
{
    uint next = BVH_EMPTY;
    bool none = true;
    for (int i = 0; i < 4; i++) {
        bool hit = keys[i] < BVH_MISS;
        stack[depth] = next;
        depth += hit && !none ? 1u : 0u;
        next = hit ? children[i] : next;
        none = none && !hit;
    }
    depth -= none ? 1u : 0u;
    return none ? top : next;
}
#else
// Nearest first. The child's number takes the place of the distance's lowest two bits.
uint visit_children(ivec4 keys, uvec4 children, uint top, inout uint depth)
{
    for (int i = 0; i < 4; i++)
        keys[i] = keys[i] < BVH_MISS ? (keys[i] & ~3) | i : BVH_MISS;
    order(keys.x, keys.z);
    order(keys.y, keys.w);
    order(keys.x, keys.y);
    order(keys.z, keys.w);
    order(keys.y, keys.z);
    stack[depth] = child_word(children, keys.w);
    depth += keys.w < BVH_MISS ? 1u : 0u;
    stack[depth] = child_word(children, keys.z);
    depth += keys.z < BVH_MISS ? 1u : 0u;
    stack[depth] = child_word(children, keys.y);
    depth += keys.y < BVH_MISS ? 1u : 0u;
    bool none = keys.x == BVH_MISS;
    depth -= none ? 1u : 0u;
    return none ? top : child_word(children, keys.x);
}
#endif

// Goes on until the traversal is done or `iterations` reaches the budget. Both loops count
// together, since a driver may limit the iterations of all loops of an invocation.
void trace(trace_ray ray, inout trace_state state, inout trace_hit best, inout uint iterations)
{
    bvh_ray box_ray = bvh_ray_create(ray.origin, ray.direction);
    triangle_frame frame = triangle_frame_create(ray.direction);
    left_plane plane = load_left_plane(ray.ignore_a);
    uint current = state.current;
    uint depth = state.depth;
    float march = state.march;
    while (current != BVH_EMPTY && iterations < ITERATION_BUDGET) {
        while (current < BVH_LEAF && iterations < ITERATION_BUDGET) {
            iterations++;
            if (HAS(FEATURE_STEPS))
                steps.nodes++;
            uint top = stack[depth - 1u];
            uvec4 children;
            ivec4 keys = bvh_test_children(box_ray, current, best.t, children);
            current = visit_children(keys, children, top, depth);
        }
        iterations++;
        if (current != BVH_EMPTY && current >= BVH_LEAF) {
            if (HAS(FEATURE_STEPS))
                steps.primitives++;
            uint top = stack[depth - 1u];
            uint index = current & BVH_LEAF_INDEX;
            bool is_shape = IS_SHAPE(current);
            if (HAS(FEATURE_TRIANGLES) && !is_shape)
                intersect_triangle_leaf(ray, frame, plane, index, best);
            bool leaf_done = true;
            if (is_shape)
                leaf_done = intersect_shape_leaf(ray, index, march, iterations, best);
            // One triangle a round: lanes with one-triangle leaves do not wait for the others.
            bool more = (current & BVH_LEAF_TWO) != 0u;
            uint next = more ? (current & ~BVH_LEAF_TWO) + 1u : top;
            current = leaf_done ? next : current;
            depth -= more || !leaf_done ? 0u : 1u;
#ifdef ANY_HIT
            current = best.primitive != NO_PRIMITIVE ? BVH_EMPTY : current;
#endif
        }
    }
    state = trace_state(current, depth, march);
}

#endif
