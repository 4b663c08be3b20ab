// Tests occlusion by lamps whose triangles are small relative to their coordinates. The scene's
// coordinates are too coarse to determine which triangle hides which; records in the lamp's own
// coordinates are accurate enough. So occlusion by the lamp itself is tested when a point on it is
// sampled, and the shadow ray ignores the lamp.
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

// Returns the number of a lamp, which is that of its first triangle.
uint small_lamp_of(uint place)
{
    return load_shapes(frame.small_triangles + place * SMALL_TRIANGLE_WORDS).w;
}

// Returns whether a triangle is in the plane through `point`, like its neighbours on a flat side of
// the lamp. Heights of at most 16 roundings of the coordinates count as rounding errors; see
// in_plane() in lib/traverse.glsl.
bool lies_in_plane(vec3 normal, vec3 point, small_triangle t)
{
    vec3 size = abs(t.v0) + abs(t.edge1) + abs(t.edge2) + abs(point);
    vec3 heights = vec3(dot(normal, t.v0 - point), dot(normal, t.v0 + t.edge1 - point),
                        dot(normal, t.v0 + t.edge2 - point));
    return all(lessThanEqual(abs(heights), vec3(GAMMA(16) * dot(abs(normal), size))));
}

// Returns whether a point of a small triangle is hidden by its own lamp in the direction `way`, of
// any length. The point is given by the triangle's barycentric coordinates.
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

// Returns whether a triangle is small and hidden by its own lamp. For other triangles shadow rays
// test this.
bool is_hidden_by_lamp(triangle_record t, vec2 b, vec3 way)
{
    bool is_small = IS_SMALL(t.word);
    return is_hidden_by_lamp(is_small ? t.emitter : 0u, b, way) && is_small;
}

// Returns the index of a triangle among the emitters.
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
