// Computes the solid angles of triangles seen from a point, and samples triangles uniformly by
// solid angle. All functions are pure.
#ifndef SOLID_ANGLE_GLSL
#define SOLID_ANGLE_GLSL

#include "lib/angle.glsl"

// Bounds, in steradians, between which points are sampled by solid angle (Pharr, Jakob, Humphreys
// 2023, section 6.5.4). For smaller triangles sampling by area is as good, and accurate for any
// size; for larger ones the point from which they are seen is almost on the triangle.
#define SOLID_ANGLE_MIN 3e-4
#define SOLID_ANGLE_MAX 6.22
// The minimum of |a + b|^2 for the unit directions a and b to two corners. It is small close to an
// edge, where the rounding of the directions, 2^-24, displaces samples by up to 4 * 2^-24 / |a +
// b|^2 of the triangle's extent (measured by the test "kernels solid angle"): at this value by
// 2^-9.
#define CORNERS_SUM_MIN 1.220703125e-4

// A triangle as seen from a point. With unit directions a, b, c to its corners, tan(omega / 2) is
// |a . (b x c)| / (1 + a . b + b . c + c . a) (van Oosterom and Strackee 1983).
struct seen_triangle {
    vec3 to_v0, to_v1, to_v2; // unit directions to the corners
    vec3 distances;
    float volume;     // |a . (b x c)|
    float one_plus;   // 1 + a . b
    float others;     // b . c + c . a
    float half_turns; // half of the solid angle, in turns
    float solid_angle;
    bool is_near; // the point is almost on the triangle or one of its edges
};

seen_triangle see_triangle(vec3 from, vec3 v0, vec3 edge1, vec3 edge2)
{
    seen_triangle s;
    vec3 a = v0 - from, b = a + edge1, c = a + edge2;
    s.distances = vec3(length(a), length(b), length(c));
    s.to_v0 = a / s.distances.x;
    s.to_v1 = b / s.distances.y;
    s.to_v2 = c / s.distances.z;
    vec3 ab = s.to_v0 + s.to_v1, bc = s.to_v1 + s.to_v2, ca = s.to_v2 + s.to_v0;
    vec3 sums = vec3(dot(ab, ab), dot(bc, bc), dot(ca, ca));
    s.volume = abs(dot(s.to_v0, cross(edge1, edge2))) / (s.distances.y * s.distances.z);
    // 1 + a . b equals |a + b|^2 / 2, which has no cancellation.
    s.one_plus = 0.5 * sums.x;
    s.others = 0.5 * (sums.y + sums.z) - 2.0;
    s.half_turns = atan_turns(s.volume, s.one_plus + s.others);
    s.solid_angle = 4.0 * PI * s.half_turns;
    s.is_near =
        !(s.solid_angle <= SOLID_ANGLE_MAX && min(sums.x, min(sums.y, sums.z)) >= CORNERS_SUM_MIN);
    return s;
}

// Returns the solid angle of a triangle that is sampled by solid angle; 0 if it is sampled by area.
float solid_angle_of(seen_triangle s)
{
    return s.solid_angle >= SOLID_ANGLE_MIN && !s.is_near ? s.solid_angle : 0.0;
}

// Returns the barycentric coordinates, of corners 1 and 2, of a point that is uniform by solid
// angle. As in Arvo (1995), an arc from corner 1 to a point c' between corners 0 and 2 cuts off the
// fraction u.x of the solid angle, and the cosine of the sample's distance from corner 1 on that
// arc is uniform. h = a + c' is in the plane of a and c, and the formula above for the solid angle
// omega' of that part is linear in h: tan(omega' / 2) is h . (a x b) / (h . (a + b)). No inverse
// functions are needed (Peters 2021).
vec2 sample_seen_triangle(seen_triangle s, vec2 u)
{
    vec2 v = cos_sin_turns(u.x * s.half_turns);
    float x = s.volume * v.x - s.others * v.y, z = s.one_plus * v.y;
    vec3 h = x * s.to_v0 + z * s.to_v2;
    float scale = 2.0 * dot(s.to_v0, h) / dot(h, h);
    vec2 along = vec2(scale * x - 1.0, scale * z); // coordinates of c' along a and c
    float cos_edge = dot(s.to_v1, along.x * s.to_v0 + along.y * s.to_v2);
    float cosine = 1.0 - u.y * (1.0 - cos_edge);
    float part = sqrt(u.y * (1.0 + cosine) / (1.0 + cos_edge)); // the sample's component along c'
    vec3 weights = vec3(part * along.x, cosine - part * cos_edge, part * along.y) / s.distances;
    weights = max(weights, vec3(0.0)); // removes negative rounding errors
    return weights.yz / (weights.x + weights.y + weights.z);
}

// Returns the first half of a parallelogram around `center`, which is relative to the point from
// which it is seen: the triangle with the corners -u - v, u - v and u + v relative to the centre.
// Negating u and v gives the second half.
seen_triangle see_half(vec3 center, vec3 u, vec3 v)
{
    return see_triangle(vec3(0.0), center - u - v, 2.0 * u, 2.0 * (u + v));
}

// Returns the solid angle of a parallelogram that is sampled by solid angle; 0 if it is sampled by
// area. `first` is the share of its first half. It is a multiple of 2^-24, as uniforms are, so that
// a half whose share rounds to 0 is never selected.
float solid_angle_of_quad(vec3 center, vec3 u, vec3 v, out float first)
{
    seen_triangle a = see_half(center, u, v), b = see_half(center, -u, -v);
    float solid_angle = a.solid_angle + b.solid_angle;
    first = floor(a.solid_angle / solid_angle * 16777216.0 + 0.5) * 5.9604644775390625e-8;
    return solid_angle >= SOLID_ANGLE_MIN && !a.is_near && !b.is_near ? solid_angle : 0.0;
}

// Samples a parallelogram; returns the point in half edges from the centre. As uniforms.y
// increases, the point moves from a corner of the first half over the diagonal (at `first`) to the
// opposite corner, so that close uniforms give close points.
vec2 sample_seen_quad(vec3 center, vec3 u, vec3 v, float first, vec2 uniforms)
{
    bool in_first = uniforms.y < first;
    float side = in_first ? 1.0 : -1.0;
    vec2 w = in_first ? vec2(uniforms.x, uniforms.y / first)
                      : vec2(1.0 - uniforms.x, (1.0 - uniforms.y) / (1.0 - first));
    vec2 b = sample_seen_triangle(see_half(center, side * u, side * v), w);
    return side * vec2(2.0 * (b.x + b.y) - 1.0, 2.0 * b.y - 1.0);
}

#endif
