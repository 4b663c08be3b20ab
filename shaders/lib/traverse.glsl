// Depth-first traversal of the BVH, nearest child first. Included by the kernels that trace; a
// kernel defines ANY_HIT to stop at the first hit.
#ifndef TRAVERSE_GLSL
#define TRAVERSE_GLSL

#include "lib/alpha.glsl"
#include "lib/bvh_node.glsl"
#include "lib/intersect_shape.glsl"
#include "lib/intersect_triangle.glsl"
#include "lib/steps.glsl"

struct trace_ray {
    vec3 origin;
    vec3 direction;
    uint ignore_a, ignore_b; // primitive words: where it starts, and what it is sent to
    uvec4 alpha; // what decides whether it meets surfaces that are not everywhere there
};

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

struct trace_hit {
    float t;        // distance so far, in units of the direction's length
    vec2 uv;
    uint primitive; // NO_PRIMITIVE: none
    uint id;        // decides between equal distances, so that the BVH's shape does not
};

// What a traversal is in the middle of.
struct trace_state {
    uint current; // node, or leaf word, or BVH_EMPTY: done
    uint depth;   // entries on the stack, the sentinel included
};

uint stack[STACK_ENTRIES + 2u]; // the sentinel, and one that a branch-free push may overwrite

void trace_begin(out trace_state state)
{
    stack[0] = BVH_EMPTY;
    state = trace_state(0u, 1u);
}

void accept_hit(inout trace_hit best, bool hit, float t, vec2 uv, uint primitive, uint id)
{
    bool nearer = hit && t > 0.0 && (t < best.t || (t == best.t && id < best.id));
    best.t = nearer ? t : best.t;
    best.uv = nearer ? uv : best.uv;
    best.primitive = nearer ? primitive : best.primitive;
    best.id = nearer ? id : best.id;
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

// The distance at which a shape that is not everywhere there is met: where a ray passes a sphere's
// near side it may meet the far one, another place of decision. Negative: nowhere.
float shape_hit_there(trace_ray ray, vec3 center, uint kind, uint primitive, uint word, float t)
{
    const uint far_side = 0x80000000u;
    vec3 point = ray.origin + t * ray.direction;
    if (!(t > 0.0) || alpha_passes(primitive, vec2(0.0), point, word, primitive, ray.alpha))
        return t;
    if (!HAS(FEATURE_SPHERES) || kind != SHAPE_KIND_SPHERE || primitive == ray.ignore_a)
        return -1.0;
    // The roots' sum is twice the distance of the point nearest to the centre.
    float length2 = dot(ray.direction, ray.direction);
    float far = 2.0 * dot(center - ray.origin, ray.direction) / length2 - t;
    point = ray.origin + far * ray.direction;
    bool there = far > t && alpha_passes(primitive, vec2(0.0), point, word, primitive | far_side,
                                         ray.alpha);
    return there ? far : -1.0;
}

void intersect_shape_leaf(trace_ray ray, uint index, inout trace_hit best)
{
    vec4 w0 = load_shapes_float(index * SHAPE_WORDS);
    uvec4 w1 = load_shapes(index * SHAPE_WORDS + 1u);
    uint kind = w1.w >> SHAPE_KIND_SHIFT;
    uint primitive = PRIMITIVE_SHAPE | index;
    float t = -1.0;
    if (HAS(FEATURE_SPHERES) && kind == SHAPE_KIND_SPHERE && primitive != ray.ignore_b)
        t = intersect_sphere(ray.origin, ray.direction, w0.xyz, w0.w, primitive == ray.ignore_a);
    if (HAS(FEATURE_DISCS) && kind == SHAPE_KIND_DISC && primitive != ray.ignore_a &&
        primitive != ray.ignore_b)
        t = intersect_disc(ray.origin, ray.direction, w0.xyz, uintBitsToFloat(w1.xyz), w0.w);
    if (HAS(FEATURE_ALPHA) && (w1.w & MATERIAL_WORD_ALPHA) != 0u)
        t = shape_hit_there(ray, w0.xyz, kind, primitive, w1.w, t);
    accept_hit(best, true, t, vec2(0.0), primitive, primitive);
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
            bool is_shape = (HAS(FEATURE_SPHERES) || HAS(FEATURE_DISCS)) &&
                            (HAS(FEATURE_TRIANGLES) ? (current & BVH_LEAF_SHAPE) != 0u : true);
            if (HAS(FEATURE_TRIANGLES) && !is_shape)
                intersect_triangle_leaf(ray, frame, plane, index, best);
            if (is_shape)
                intersect_shape_leaf(ray, index, best);
            // One triangle a round: lanes with one-triangle leaves do not wait for the others.
            bool more = (current & BVH_LEAF_TWO) != 0u;
            current = more ? (current & ~BVH_LEAF_TWO) + 1u : top;
            depth -= more ? 0u : 1u;
#ifdef ANY_HIT
            current = best.primitive != NO_PRIMITIVE ? BVH_EMPTY : current;
#endif
        }
    }
    state = trace_state(current, depth);
}

#endif
