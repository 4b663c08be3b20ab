// Maps uniforms to directions and points. All functions are pure.
#ifndef SAMPLING_GLSL
#define SAMPLING_GLSL

#include "lib/angle.glsl"
#include "lib/constants.glsl"

// Returns the unit vector n and two vectors that complete it to an orthonormal basis (Duff et al.
// 2017, "Building an Orthonormal Basis, Revisited", listing 3).
mat3 basis_around(vec3 n)
{
    float s = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + n.z);
    float b = n.x * n.y * a;
    return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x),
                vec3(b, s + n.y * n.y * a, -n.y), n);
}

// Samples the unit disc uniformly, by polar coordinates.
vec2 sample_disc(vec2 u)
{
    return sqrt(u.x) * cos_sin_turns(u.y);
}

// Samples the hemisphere about +z with density cos(theta) / pi per solid angle (Malley's method).
vec3 sample_cosine_hemisphere(vec2 u)
{
    vec2 d = sample_disc(u);
    return vec3(d, sqrt(max(0.0, 1.0 - u.x)));
}

float pdf_cosine_hemisphere(float cos_theta)
{
    return cos_theta * INV_PI;
}

// Samples the hemisphere about +z uniformly. u.x selects the height, u.y the azimuth.
vec3 sample_hemisphere(vec2 u)
{
    return vec3(sqrt(u.x * (2.0 - u.x)) * cos_sin_turns(u.y), 1.0 - u.x);
}

vec3 sample_sphere(vec2 u)
{
    float z = 1.0 - 2.0 * u.x;
    float radius = sqrt(max(0.0, 4.0 * u.x * (1.0 - u.x)));
    return vec3(radius * cos_sin_turns(u.y), z);
}

// Samples a triangle uniformly: returns the barycentric coordinates of corners 1 and 2 (Turk 1990,
// Graphics Gems, p. 24).
vec2 sample_triangle(vec2 u)
{
    float root = sqrt(u.x);
    return vec2(root * (1.0 - u.y), root * u.y);
}

// Returns the MIS weight of the first of two strategies by the chosen heuristic (Veach 1997,
// section 9.2.2): the power heuristic (eq. 9.13) with exponent 2 or another, written so that powers
// cannot overflow, or the balance heuristic (eq. 9.8).
float mis_weight(float pdf, float other_pdf)
{
    float ratio = other_pdf / pdf;
    if (MIS == MIS_POWER_ANY)
        return 1.0 / (1.0 + pow(ratio, frame.mis_exponent));
    return 1.0 / (1.0 + (MIS == MIS_BALANCE ? ratio : ratio * ratio));
}

#endif
