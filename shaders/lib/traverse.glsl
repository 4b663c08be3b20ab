// Depth-first traversal of the BVH, nearest child first. Included by the kernels that trace; a
// kernel defines ANY_HIT to stop at the first hit.
#ifndef TRAVERSE_GLSL
#define TRAVERSE_GLSL

#include "lib/alpha.glsl"
#include "lib/bvh_node.glsl"
#include "lib/instance.glsl"
#include "lib/intersect_triangle.glsl"
#include "lib/shape_leaf.glsl"
#include "lib/small_lamp.glsl"
#include "lib/stack.glsl"
#include "lib/steps.glsl"
#include "lib/trace_types.glsl"
#include "lib/triangle.glsl"

// The plane of the triangle that a ray starts on. Its coplanar neighbours cannot be hit either:
// their distance is 0 and must not become more by rounding, which is some epsilon times the
// triangle's size. In the space of the triangle: an instance's own, where it is of one.
struct left_plane {
    vec3 normal; // not normalised
    bool exists;
    vec3 point; // with instances
    uint id;    // id of the triangle, where one may be in several places
    uint target_id; // id of the primitive that the ray is sent to
    bool target_is_small;
    uint target_lamp; // then the lamp that it is of
    vec3 target_normal, target_point; // with small triangles; the normal is 0 where there is none
};

left_plane load_left_plane(uint primitive, uint target)
{
    left_plane plane = left_plane(vec3(0.0), false, vec3(0.0), NO_PRIMITIVE, NO_PRIMITIVE, false,
                                  0u, vec3(0.0), vec3(0.0));
    if (HAS(FEATURE_TRIANGLES) && primitive < PRIMITIVE_SHAPE) {
        triangle_record t = load_triangle(primitive);
        plane.normal = cross(t.edge1, t.edge2);
        plane.exists = true;
        plane.point = t.v0;
        plane.id = t.id;
    }
    if (HAS_GEOMETRY(GEOMETRY_DUPLICATES) && target < PRIMITIVE_ENVIRONMENT)
        plane.target_id = load_triangles(target * 3u).w;
    if (HAS_GEOMETRY(GEOMETRY_SMALL_TRIANGLES) && target < PRIMITIVE_ENVIRONMENT) {
        triangle_record t = load_triangle(target);
        plane.target_is_small = IS_SMALL(t.word);
        plane.target_lamp = small_lamp_of(plane.target_is_small ? t.emitter : 0u);
        plane.target_normal = triangle_normal(t);
        plane.target_point = t.v0;
    }
    return plane;
}

// Returns whether a corner lies in the plane through the ray's origin. Of its computed height at
// most 16 roundings of the coordinates are error: 7 by which the origin was moved off the surface,
// 4 of the normal, 5 of the difference and the dot product.
bool in_plane(left_plane plane, vec3 origin, vec3 corner)
{
    float height = dot(plane.normal, corner - origin);
    return abs(height) <= GAMMA(16) * dot(abs(plane.normal), abs(corner) + abs(origin));
}

bool leaves_triangle(left_plane plane, vec3 origin, vec3 v0, vec3 v1, vec3 v2)
{
    // On its way to an instance's space an origin loses more: there the triangle's own corner is
    // asked.
    vec3 from = HAS_GEOMETRY(GEOMETRY_INSTANCES) ? plane.point : origin;
    return plane.exists && in_plane(plane, from, v0) && in_plane(plane, from, v1) &&
           in_plane(plane, from, v2);
}

// The state of a traversal that is not finished.
struct trace_state {
    uint current; // node, or leaf word, or BVH_EMPTY: done
    uint depth;   // entries on the stack, the sentinel included
    float march;  // how far the ray has got through the distance field of the leaf in hand; 0: not
                  // begun
    uint instance; // in whose tree it is, or NO_INSTANCE
};

void trace_begin(out trace_state state)
{
    stack_store(0, BVH_EMPTY);
    state = trace_state(0u, 1u, 0.0, NO_INSTANCE);
}

// Marks the end of an instance's part of the stack: then the traversal is in the world again.
#define BVH_LEAVE 0xfffffffeu

// The ray as the tree in hand sees it. Directions keep their length in the world, so that distances
// are the same in all spaces.
struct trace_space {
    vec3 origin;
    bvh_ray box_ray;
    triangle_frame frame;
    uint instance;
    uint material; // word in place of the triangles' own, or NO_MATERIAL
};

trace_space world_space(trace_ray ray)
{
    return trace_space(ray.origin, bvh_ray_create(ray.origin, ray.direction),
                       triangle_frame_create(ray.direction), NO_INSTANCE, NO_MATERIAL);
}

// An instance's space, with the root of its tree; or with NO_INSTANCE the world.
trace_space enter_space(trace_ray ray, uint instance, out uint root)
{
    bool is_world = instance == NO_INSTANCE;
    instance_inverse inverse = load_instance_inverse(is_world ? 0u : instance);
    uvec4 words = load_instance_words(is_world ? 0u : instance);
    vec3 origin = is_world ? ray.origin : (ray.origin - inverse.place) * inverse.rows;
    vec3 direction = is_world ? ray.direction : ray.direction * inverse.rows;
    root = words.x;
    return trace_space(origin, bvh_ray_create(origin, direction), triangle_frame_create(direction),
                       instance, is_world ? NO_MATERIAL : words.y);
}

// Returns whether a hit does not count: one on the primitive that the ray starts on, or on the one
// that it is sent to.
bool is_ignored(trace_ray ray, left_plane plane, uint instance, uint index, uint id)
{
    bool duplicates = HAS_GEOMETRY(GEOMETRY_DUPLICATES);
    bool starts_here = duplicates ? id == plane.id : index == ray.ignore_a;
    bool ends_here = duplicates ? id == plane.target_id : index == ray.ignore_b;
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES))
        starts_here = starts_here && instance == ray.start_instance;
    return starts_here || ends_here;
}

// The greatest rotation of a plane's small triangles by rounding, as the sine of an angle: see
// SMALL_TOLERANCE in flatten.c.
#define PARALLEL_TOLERANCE (1.0 / 1024.0)

// Returns whether a triangle lies in the plane of the one that a shadow ray is sent to, which it
// cannot hide from the ray: small triangles lie beside their neighbours in a plane, each moved as a
// whole by the roundings of its first corner, half an ulp a coordinate. As much as two roundings
// let it be off.
bool is_beside_target(left_plane plane, triangle_record t)
{
    float height = dot(plane.target_normal, t.v0 - plane.target_point);
    float rounding = dot(abs(plane.target_normal), abs(t.v0) + abs(plane.target_point));
    vec3 turn = cross(plane.target_normal, triangle_normal(t));
    return abs(height) <= GAMMA(2) * rounding && length(turn) <= PARALLEL_TOLERANCE;
}

// The key by which alpha decides whether a triangle is met: it differs between instances.
uint crossing_of(uint id, uint instance)
{
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES))
        return id ^ (instance + 1u) * 0x9e3779b9u;
    return id;
}

void intersect_triangle_leaf(trace_ray ray, trace_space space, left_plane plane, uint index,
                             inout trace_hit best)
{
    triangle_record triangle = load_triangle(index);
    vec3 v0 = triangle.v0, v1 = triangle.v1, v2 = triangle.v2;
    float t;
    vec2 uv;
    bool leaves = leaves_triangle(plane, space.origin, v0, v1, v2);
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES))
        leaves = leaves && space.instance == ray.start_instance;
    bool hit = intersect_triangle(space.frame, space.origin, v0, v1, v2, t, uv);
    if (IS_SMALL(triangle.word))
        hit = intersect_small_triangle(space.frame, space.origin, v0, triangle.edge1,
                                       triangle.edge2, t, uv);
#ifdef ANY_HIT
    // Small ones are in the world, not in an instance.
    bool any_is_small = plane.target_is_small || IS_SMALL(triangle.word);
    if (HAS_GEOMETRY(GEOMETRY_SMALL_TRIANGLES) && any_is_small && space.instance == NO_INSTANCE)
        hit = hit && !is_beside_target(plane, triangle);
    if (HAS_GEOMETRY(GEOMETRY_SMALL_TRIANGLES)) {
        bool is_small = IS_SMALL(triangle.word) && plane.target_is_small;
        uint lamp = small_lamp_of(is_small ? triangle.emitter : 0u);
        hit = hit && !(is_small && lamp == plane.target_lamp);
    }
#endif
    hit = hit && !leaves && !is_ignored(ray, plane, space.instance, index, triangle.id);
    if (HAS(FEATURE_ALPHA)) {
        uint word = triangle.word;
        if (HAS_GEOMETRY(GEOMETRY_INSTANCES) && space.material != NO_MATERIAL)
            word = space.material;
        if (hit && t > 0.0 && t <= best.t && (word & MATERIAL_WORD_ALPHA) != 0u)
            hit = alpha_passes(index, uv, vec3(0.0), word, crossing_of(triangle.id, space.instance),
                               ray.alpha);
    }
    accept_hit(best, hit, t, uv, index, triangle.id, space.instance);
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
        stack_store(depth, next);
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
    stack_store(depth, child_word(children, keys.w));
    depth += keys.w < BVH_MISS ? 1u : 0u;
    stack_store(depth, child_word(children, keys.z));
    depth += keys.z < BVH_MISS ? 1u : 0u;
    stack_store(depth, child_word(children, keys.y));
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
    uint root = 0u;
    trace_space space = world_space(ray);
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES) && HAS(FEATURE_SUSPEND))
        space = enter_space(ray, state.instance, root);
    left_plane plane = load_left_plane(ray.ignore_a, ray.ignore_b);
    uint current = state.current;
    uint depth = state.depth;
    float march = state.march;
    while (current != BVH_EMPTY && iterations < ITERATION_BUDGET) {
        while (current < BVH_LEAF && iterations < ITERATION_BUDGET) {
            iterations++;
            if (COUNTS_STEPS)
                steps.nodes++;
            uint top = stack_load(depth - 1u);
            uvec4 children;
            ivec4 keys = bvh_test_children(space.box_ray, current, best.t, children);
            current = visit_children(keys, children, top, depth);
        }
        iterations++;
        if (current != BVH_EMPTY && current >= BVH_LEAF) {
            uint top = stack_load(depth - 1u);
            uint index = current & BVH_LEAF_INDEX;
            bool is_space = IS_INSTANCE_LEAF(current);
            bool is_shape = IS_SHAPE(current) && !is_space;
            bool is_triangle = !is_shape && !is_space;
            if (HAS(FEATURE_TRIANGLES) && is_triangle)
                intersect_triangle_leaf(ray, space, plane, current & BVH_LEAF_TRIANGLE, best);
            bool leaf_done = true;
            if (is_shape)
                leaf_done = intersect_shape_leaf(ray, index, march, iterations, best);
            // One triangle a round: lanes with one-triangle leaves do not wait for the others.
            bool more = (current & BVH_LEAF_MORE) != 0u && is_triangle;
            uint next = more ? current - BVH_LEAF_ONE_MORE + 1u : top;
            if (is_space) {
                bool enters = current != BVH_LEAVE;
                space = enter_space(ray, enters ? index : NO_INSTANCE, root);
                stack_store(depth, BVH_LEAVE);
                depth += enters ? 2u : 0u; // one of them is taken back below
                next = enters ? root : top;
            }
            if (COUNTS_STEPS)
                steps.primitives += current != BVH_LEAVE && leaf_done ? 1u : 0u;
            current = leaf_done ? next : current;
            depth -= more || !leaf_done ? 0u : 1u;
#ifdef ANY_HIT
            current = best.primitive != NO_PRIMITIVE ? BVH_EMPTY : current;
#endif
        }
    }
    state = trace_state(current, depth, march, space.instance);
}

#endif
