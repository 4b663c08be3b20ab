// Intersects rays with triangles by a watertight test (Woop, Benthin, Wald 2013). All functions are
// pure.
//
// The edge functions of an edge shared by two triangles are exact negatives of each other, because
// a * b - c * d is rounded in the same way in both (`precise` forbids contraction); so no ray
// passes between the triangles. Zero counts as inside. The original's fallback to double precision
// is omitted, because it affects which of two neighbours is hit, not whether one is hit.
#ifndef INTERSECT_TRIANGLE_GLSL
#define INTERSECT_TRIANGLE_GLSL

// The ray's own frame: the direction's longest component becomes z, and a shear makes x and y 0.
struct triangle_frame {
    bool swap_x, swap_y; // exchange z with x, or with y
    vec3 shear;          // x/z, y/z, 1/z of the direction
};

vec3 frame_swap(bool swap_x, bool swap_y, vec3 v)
{
    return vec3(swap_x ? v.z : v.x, swap_y ? v.z : v.y, swap_x ? v.x : swap_y ? v.y : v.z);
}

triangle_frame triangle_frame_create(vec3 direction)
{
    vec3 a = abs(direction);
    bool swap_x = a.x > a.y && a.x > a.z;
    bool swap_y = !swap_x && a.y > a.z;
    vec3 d = frame_swap(swap_x, swap_y, direction);
    return triangle_frame(swap_x, swap_y, vec3(d.x, d.y, 1.0) / d.z);
}

vec3 frame_transform(triangle_frame frame, vec3 v)
{
    precise vec3 s = frame_swap(frame.swap_x, frame.swap_y, v);
    precise vec2 sheared = s.xy - frame.shear.xy * s.z;
    return vec3(sheared, s.z * frame.shear.z);
}

// The corners are given in the ray's frame.
bool intersect_corners(vec3 a, vec3 b, vec3 c, out float t, out vec2 uv)
{
    precise float u = c.x * b.y - c.y * b.x;
    precise float v = a.x * c.y - a.y * c.x;
    precise float w = b.x * a.y - b.y * a.x;
    float determinant = u + v + w;
    float inverse = 1.0 / determinant;
    t = (u * a.z + v * b.z + w * c.z) * inverse;
    uv = vec2(v, w) * inverse;
    bool same_side = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    return same_side && determinant != 0.0;
}

// Tests a triangle, which is visible from both sides. On a hit `t` is in units of the direction's
// length and `uv` are the barycentric coordinates of v1 and v2.
bool intersect_triangle(triangle_frame frame, vec3 origin, vec3 v0, vec3 v1, vec3 v2, out float t,
                        out vec2 uv)
{
    vec3 a = frame_transform(frame, v0 - origin);
    vec3 b = frame_transform(frame, v1 - origin);
    vec3 c = frame_transform(frame, v2 - origin);
    return intersect_corners(a, b, c, t, uv);
}

// Intersects a triangle given by a corner and its edges, so that rounding moves it as a whole.
bool intersect_small_triangle(triangle_frame frame, vec3 origin, vec3 v0, vec3 edge1, vec3 edge2,
                              out float t, out vec2 uv)
{
    vec3 a = frame_transform(frame, v0 - origin);
    vec3 b = a + frame_transform(frame, edge1);
    vec3 c = a + frame_transform(frame, edge2);
    return intersect_corners(a, b, c, t, uv);
}

#endif
