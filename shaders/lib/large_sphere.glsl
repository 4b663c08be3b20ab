// Intersects rays with spheres whose quadratic equation needs more than single precision. For a
// ground of radius 1e6 m, seen from a height of 2 m, the constant term is the difference of two
// numbers of 1e12 m^2. All functions are pure.
#ifndef LARGE_SPHERE_GLSL
#define LARGE_SPHERE_GLSL

#include "lib/double_float.glsl"

// A sphere relative to a point, without rounding: high + low is the vector from its centre to the
// point. Lengths are in a power-of-two unit in which their squares neither overflow nor underflow.
struct exact_sphere {
    vec3 high, low;
    float radius;
    float unit;
};

exact_sphere exact_sphere_from(vec3 point, vec3 center, float radius)
{
    vec2 x = exact_sum(point.x, -center.x);
    vec2 y = exact_sum(point.y, -center.y);
    vec2 z = exact_sum(point.z, -center.z);
    float size = max(max(abs(x.x), abs(y.x)), max(abs(z.x), radius));
    float unit = size > 1e9 ? 1099511627776.0 : size < 1e-9 ? 9.094947017729282e-13 : 1.0;
    return exact_sphere(vec3(x.x, y.x, z.x) / unit, vec3(x.y, y.y, z.y) / unit, radius / unit,
                        unit);
}

// Returns f.f - r^2, where f is the vector from the centre. It is negative inside.
vec2 sphere_power(exact_sphere s)
{
    vec2 square = dot_exactly(s.high, s.high);
    square = add_exactly(square, vec2(2.0 * dot(s.high, s.low), 0.0));
    return renormalise(add_exactly(square, -exact_product(s.radius, s.radius)));
}

// Returns a point's distance from the surface, positive outside: |f| - r = (f.f - r^2) / (|f| + r).
float sphere_height(vec3 point, vec3 center, float radius)
{
    exact_sphere s = exact_sphere_from(point, center, radius);
    return s.unit * (sphere_power(s).x / (length(s.high) + s.radius));
}

// Returns both crossings in ascending order; false if there are none. A ray that starts on this
// sphere is known to start on the side to which it goes, because its origin was moved by more than
// the rounding error. So a ray that starts outside leaves, and one that starts inside has one
// crossing ahead.
bool intersect_large_sphere(vec3 origin, vec3 direction, vec3 center, float radius,
                            bool starts_here, out vec2 t)
{
    exact_sphere s = exact_sphere_from(origin, center, radius);
    vec2 a = dot_exactly(direction, direction);
    vec2 b = -add_exactly(dot_exactly(s.high, direction), vec2(dot(s.low, direction), 0.0));
    vec2 c = sphere_power(s);
    vec2 discriminant = renormalise(add_exactly(multiply(b, b), -multiply(a, c)));
    float root = sqrt(max(discriminant.x, 0.0));
    float q = b.x + (b.x < 0.0 ? -root : root);
    float t0 = c.x / q;
    float t1 = q / a.x;
    t = s.unit * vec2(min(t0, t1), max(t0, t1));
    return discriminant.x >= 0.0 && !(starts_here && c.x >= 0.0);
}

#endif
