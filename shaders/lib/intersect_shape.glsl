// Intersects rays with spheres, discs, planes and quads. All functions are pure. t is in units of
// the direction's length; it is negative if there is no hit.
#ifndef INTERSECT_SHAPE_GLSL
#define INTERSECT_SHAPE_GLSL

#include "lib/intersect_solid.glsl"

// Computes both roots of the quadratic without cancellation: the discriminant from the point
// closest to the centre, the second root from the product of the roots (Haines, Günther and
// Akenine-Möller 2019, Ray Tracing Gems, chapter 7).
//
// A ray that starts on the sphere has one root that is exactly 0. Only the other root counts, and
// only if it exceeds the rounding error, so that rounding does not decide whether the ray leaves.
// If the sphere is smaller than the rounding error of its position, the side on which the ray
// starts is more reliable than its direction.
float intersect_sphere(vec3 origin, vec3 direction, vec3 center, float radius, bool starts_here)
{
    vec3 f = origin - center;
    float a = dot(direction, direction);
    float b = -dot(f, direction);
    if (starts_here) {
        bool leaves = dot(f, f) > radius * radius * (1.0 + GAMMA(16));
        bool enters = b > GAMMA(4) * dot(abs(f), abs(direction));
        return enters && !leaves ? 2.0 * b / a : -1.0;
    }
    vec3 closest = f + (b / a) * direction;
    float discriminant = radius * radius - dot(closest, closest);
    float q = b + (b < 0.0 ? -1.0 : 1.0) * sqrt(a * max(discriminant, 0.0));
    float c = dot(f, f) - radius * radius;
    float t0 = c / q;
    float t1 = q / a;
    float low = min(t0, t1);
    float high = max(t0, t1);
    float t = low > 0.0 ? low : high;
    return discriminant >= 0.0 ? t : -1.0;
}

float intersect_disc(vec3 origin, vec3 direction, vec3 center, vec3 normal, float radius)
{
    float t = dot(center - origin, normal) / dot(direction, normal);
    vec3 from_center = origin + t * direction - center;
    return dot(from_center, from_center) <= radius * radius ? t : -1.0;
}

// Hits on planes are limited to positions with coordinates up to this.
const float PLANE_REACH = 1e18;

float intersect_plane(vec3 origin, vec3 direction, vec3 point, vec3 normal)
{
    float t = dot(point - origin, normal) / dot(direction, normal);
    vec3 speed = abs(direction);
    return t * max(speed.x, max(speed.y, speed.z)) <= PLANE_REACH ? t : -1.0;
}

// Tests the parallelogram center + a u + b v with a and b from -1 to 1, which are returned in `at`.
// Cramer's rule for f + t d = a u + b v (as Möller and Trumbore 1997) decides hits at edges without
// division.
float intersect_quad(vec3 origin, vec3 direction, vec3 center, vec3 u, vec3 v, out vec2 at)
{
    vec3 f = origin - center;
    vec3 normal = cross(u, v);
    vec3 moment = cross(f, direction);
    float slope = dot(direction, normal);
    vec2 scaled = vec2(-dot(v, moment), dot(u, moment));
    at = clamp(scaled / slope, -1.0, 1.0);
    float t = -dot(f, normal) / slope;
    bool inside = abs(scaled.x) <= abs(slope) && abs(scaled.y) <= abs(slope);
    return inside && slope != 0.0 && t < FARTHEST ? t : -1.0;
}

#endif
