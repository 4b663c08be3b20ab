// Lamps of triangles that are small for where they are, in coordinates of their own: there is known
// what the scene's coordinates do not tell, which of their triangles hides which. So a point of such
// a lamp is hidden by the lamp itself when it is sampled, and its shadow ray ignores the lamp.
#ifndef SMALL_LAMP_GLSL
#define SMALL_LAMP_GLSL

#include "lib/buffers.glsl"
#include "lib/intersect_triangle.glsl"
#include "lib/triangle.glsl"

// A struct gpu_small_triangle, unpacked.
struct small_triangle {
    vec3 v0, edge1, edge2;
    uint first, count, emitter;
};

small_triangle load_small_triangle(uint place)
{
    uint at = frame.small_triangles + place * SMALL_TRIANGLE_WORDS;
    uvec4 w0 = load_shapes(at);
    uvec4 w1 = load_shapes(at + 1u);
    uvec4 w2 = load_shapes(at + 2u);
    return small_triangle(uintBitsToFloat(w0.xyz), uintBitsToFloat(w1.xyz), uintBitsToFloat(w2.xyz),
                          w0.w, w1.w, w2.w);
}

// The number of a lamp: of its first triangle.
uint small_lamp_of(uint place)
{
    return load_shapes(frame.small_triangles + place * SMALL_TRIANGLE_WORDS).w;
}

// Returns whether a triangle lies in the plane through `point`, as its neighbours on a flat side of
// the lamp do: 16 roundings of the coordinates at most are error, see in_plane() in
// lib/traverse.glsl.
bool lies_in_plane(vec3 normal, vec3 point, small_triangle t)
{
    vec3 size = abs(t.v0) + abs(t.edge1) + abs(t.edge2) + abs(point);
    vec3 heights = vec3(dot(normal, t.v0 - point), dot(normal, t.v0 + t.edge1 - point),
                        dot(normal, t.v0 + t.edge2 - point));
    return all(lessThanEqual(abs(heights), vec3(GAMMA(16) * dot(abs(normal), size))));
}

// Returns whether its own lamp hides a point of a small triangle from what lies in the direction
// `way`, which need not have any length. The point is given by the triangle's barycentric
// coordinates.
bool is_hidden_by_lamp(uint place, vec2 b, vec3 way)
{
    small_triangle own = load_small_triangle(place);
    vec3 point = own.v0 + b.x * own.edge1 + b.y * own.edge2;
    vec3 normal = cross(own.edge1, own.edge2);
    triangle_frame ray_frame = triangle_frame_create(way);
    bool hidden = false;
    for (uint i = own.first; i < own.first + own.count; i++) {
        small_triangle other = load_small_triangle(i);
        float t;
        vec2 uv;
        bool hit = intersect_triangle(ray_frame, point, other.v0, other.v0 + other.edge1,
                                      other.v0 + other.edge2, t, uv);
        hidden = hidden || (hit && t > 0.0 && !lies_in_plane(normal, point, other));
    }
    return hidden;
}

// Returns whether a triangle, if it is small, is hidden by its own lamp: other triangles ask shadow
// rays.
bool is_hidden_by_lamp(triangle_record t, vec2 b, vec3 way)
{
    bool is_small = IS_SMALL(t.word);
    return is_hidden_by_lamp(is_small ? t.emitter : 0u, b, way) && is_small;
}

// Number of a triangle among the emitters.
uint emitter_of(triangle_record t)
{
    bool is_small = IS_SMALL(t.word);
    if (HAS_GEOMETRY(GEOMETRY_SMALL_TRIANGLES)) {
        uint emitter = load_small_triangle(is_small ? t.emitter : 0u).emitter;
        return is_small ? emitter : t.emitter;
    }
    return t.emitter;
}

#endif
