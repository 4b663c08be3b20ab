// Watertight ray-triangle intersection (Woop, Benthin, Wald 2013). Pure functions.
//
// Edge functions of an edge shared by two triangles are exact negatives of each other, because
// a * b - c * d rounds alike in both (`precise` forbids contraction), so no ray slips through
// between them. Zero counts as inside. The original's fallback to double precision is left out: it
// changes which of two neighbours is hit, not whether one is.
#ifndef INTERSECT_TRIANGLE_GLSL
#define INTERSECT_TRIANGLE_GLSL

#include "lib/constants.glsl"

// The ray's own frame: its longest component becomes z, and x and y are sheared to 0.
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

// The greatest magnitude. Without their sign floats order like integers, whose maxima are cheaper
// where those of floats have to mind NaN.
float max_abs(float x, float y, float z)
{
    ivec3 bits = floatBitsToInt(vec3(x, y, z)) & 0x7fffffff;
    return intBitsToFloat(max(max(bits.x, bits.y), bits.z));
}

// Bound of the rounding error of t (Pharr, Jakob, Humphreys 2023, section 6.8.7), from the
// transformed corners and the edge functions. The corners' z are in units of the direction's length;
// what the shear adds to x and y is not.
float distance_error(triangle_frame frame, vec3 a, vec3 b, vec3 c, vec3 edges, float inverse)
{
    float max_x = max_abs(a.x, b.x, c.x);
    float max_y = max_abs(a.y, b.y, c.y);
    float max_z = max_abs(a.z, b.z, c.z);
    float max_edge = max_abs(edges.x, edges.y, edges.z);
    float sheared_z = max_z * abs(1.0 / frame.shear.z);
    float delta_x = GAMMA(5) * (max_x + sheared_z);
    float delta_y = GAMMA(5) * (max_y + sheared_z);
    float delta_z = GAMMA(3) * max_z;
    float delta_edge = 2.0 * (GAMMA(2) * max_x * max_y + delta_y * max_x + delta_x * max_y);
    return 3.0 * (GAMMA(3) * max_edge * max_z + delta_edge * max_z + delta_z * max_edge) *
           abs(inverse);
}

// Two-sided. On a hit `t` is in units of the direction's length and `uv` are the barycentric
// coordinates of v1 and v2. Hits are in front of the origin: either all corners are, and so is what
// lies between them, or t exceeds the bound of its error; a triangle in the plane that the ray
// leaves, or next to it, is not hit by rounding.
bool intersect_triangle(triangle_frame frame, vec3 origin, vec3 v0, vec3 v1, vec3 v2, out float t,
                        out vec2 uv)
{
    vec3 a = frame_transform(frame, v0 - origin);
    vec3 b = frame_transform(frame, v1 - origin);
    vec3 c = frame_transform(frame, v2 - origin);
    precise float u = c.x * b.y - c.y * b.x;
    precise float v = a.x * c.y - a.y * c.x;
    precise float w = b.x * a.y - b.y * a.x;
    float determinant = u + v + w;
    float inverse = 1.0 / determinant;
    t = (u * a.z + v * b.z + w * c.z) * inverse;
    uv = vec2(v, w) * inverse;
    bool same_side = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    bool in_front = (a.z > 0.0 && b.z > 0.0 && c.z > 0.0) ||
                    t > distance_error(frame, a, b, c, vec3(u, v, w), inverse);
    return same_side && determinant != 0.0 && in_front;
}

#endif
