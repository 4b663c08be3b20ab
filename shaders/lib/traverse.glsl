// Traverses the BVH depth-first, nearest child first. A kernel that includes this file defines
// ANY_HIT to stop at the first hit.
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

// The plane of the triangle on which a ray starts. Coplanar neighbours of the triangle cannot be
// hit either: their distance is 0, and rounding, which may be a multiple of the triangle's size,
// must not make it greater. The plane is in the space of the triangle, which may be an instance's.
struct left_plane {
    vec3 normal; // not normalised
    bool exists;
    vec3 point; // used with instances
    uint id;    // id of the triangle, which may be in several leaves
    uint target_id; // id of the ray's target
    bool target_is_small;
    uint target_lamp; // the lamp of the target, if it is a small triangle
    vec3 target_normal, target_point; // used with small triangles; the normal is 0 if there is none
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

// Returns whether a corner is in the plane through the ray's origin. The error of its computed
// height is at most 16 roundings of the coordinates: 7 by which the origin was moved off the
// surface, 4 of the normal, 5 of the difference and the dot product.
bool in_plane(left_plane plane, vec3 origin, vec3 corner)
{
    float height = dot(plane.normal, corner - origin);
    return abs(height) <= GAMMA(16) * dot(abs(plane.normal), abs(corner) + abs(origin));
}

bool leaves_triangle(left_plane plane, vec3 origin, vec3 v0, vec3 v1, vec3 v2)
{
    // Transforming an origin to an instance's space adds errors, so a corner of the triangle is
    // used instead.
    vec3 from = HAS_GEOMETRY(GEOMETRY_INSTANCES) ? plane.point : origin;
    return plane.exists && in_plane(plane, from, v0) && in_plane(plane, from, v1) &&
           in_plane(plane, from, v2);
}

// The state of an incomplete traversal.
struct trace_state {
    uint current; // node, leaf word, or BVH_EMPTY if the traversal is complete
    uint depth;   // entries on the stack, including the sentinel
    float march;  // progress through the current leaf's distance field; 0: not begun
    uint instance; // instance whose tree is traversed, or NO_INSTANCE
};

void trace_begin(out trace_state state)
{
    stack_store(0, BVH_EMPTY);
    state = trace_state(0u, 1u, 0.0, NO_INSTANCE);
}

// A marker on the stack at the end of an instance's entries, where the traversal returns to world
// space.
#define BVH_LEAVE 0xfffffffeu

// The ray in the space of the current tree. Its direction is not normalised after the transform, so
// distances are the same in all spaces.
struct trace_space {
    vec3 origin;
    bvh_ray box_ray;
    triangle_frame frame;
    uint instance;
    uint material; // word that replaces the triangles' own, or NO_MATERIAL
};

trace_space world_space(trace_ray ray)
{
    return trace_space(ray.origin, bvh_ray_create(ray.origin, ray.direction),
                       triangle_frame_create(ray.direction), NO_INSTANCE, NO_MATERIAL);
}

// Returns the space of an instance, or world space for NO_INSTANCE, and the root of its tree.
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

// Returns whether a hit is ignored: if it is on the primitive on which the ray starts, or on the
// ray's target.
bool is_ignored(trace_ray ray, left_plane plane, uint instance, uint index, uint id)
{
    bool duplicates = HAS_GEOMETRY(GEOMETRY_DUPLICATES);
    bool starts_here = duplicates ? id == plane.id : index == ray.ignore_a;
    bool ends_here = duplicates ? id == plane.target_id : index == ray.ignore_b;
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES))
        starts_here = starts_here && instance == ray.start_instance;
    return starts_here || ends_here;
}

// The maximum rotation of the plane of small triangles by rounding, as the sine of an angle: see
// SMALL_TOLERANCE in flatten_lamps.c.
#define PARALLEL_TOLERANCE (1.0 / 1024.0)

// Returns whether a triangle is in the plane of a shadow ray's target, and so cannot hide it.
// Rounding moves each small triangle as a whole, by half an ulp per coordinate of its first corner,
// so that coplanar neighbours differ by up to two roundings.
bool is_beside_target(left_plane plane, triangle_record t)
{
    float height = dot(plane.target_normal, t.v0 - plane.target_point);
    float rounding = dot(abs(plane.target_normal), abs(t.v0) + abs(plane.target_point));
    vec3 turn = cross(plane.target_normal, triangle_normal(t));
    return abs(height) <= GAMMA(2) * rounding && length(turn) <= PARALLEL_TOLERANCE;
}

// Returns the key with which alpha decides whether a triangle is hit; it differs between instances.
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
    // Small triangles are in world space, not in an instance.
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

// Selects the next node among the children that the ray enters, and pushes the others. `keys` are
// the bits of the entry distances, or BVH_MISS; `top` is the top of the stack, which is popped if
// no child is entered. The code has no branches: every push is written, and the depth determines
// which ones count.
#ifdef ANY_HIT
// The first hit suffices, so children are visited in their own order, without sorting.
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
// The nearest child comes first. The child's index replaces the lowest two bits of the distance.
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

// Continues the traversal until it is complete or `iterations` reaches the budget. Both loops share
// one count, because a driver may limit the iterations of all loops of an invocation together.
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
            // Each iteration tests one triangle, so that lanes with leaves of one triangle do not
            // wait for the others.
            bool more = (current & BVH_LEAF_MORE) != 0u && is_triangle;
            uint next = more ? current - BVH_LEAF_ONE_MORE + 1u : top;
            if (is_space) {
                bool enters = current != BVH_LEAVE;
                space = enter_space(ray, enters ? index : NO_INSTANCE, root);
                stack_store(depth, BVH_LEAVE);
                depth += enters ? 2u : 0u; // the depth decreases by one below
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
