// Ray tests of analytic shapes. Pure functions. t is in units of the direction's length; a negative
// t is no hit.
#ifndef INTERSECT_SHAPE_GLSL
#define INTERSECT_SHAPE_GLSL

// Both roots of the quadratic in the form that does not cancel: the discriminant from the closest
// point to the centre, the second root from the product of the roots (Haines, Günther and
// Akenine-Möller 2019, Ray Tracing Gems, chapter 7).
//
// A ray that starts on this very sphere has one root at 0 exactly; only the other one counts, so
// that no rounding decides whether it leaves the surface.
float intersect_sphere(vec3 origin, vec3 direction, vec3 center, float radius, bool starts_here)
{
    vec3 f = origin - center;
    float a = dot(direction, direction);
    float b = -dot(f, direction);
    if (starts_here)
        return 2.0 * b / a;
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

#endif
