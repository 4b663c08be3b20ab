// Samples directional lights with an angular diameter, which are cones of constant radiance around
// a direction. All functions are pure. A cone is given by its versine, 1 - cos of its half-angle,
// which is accurate for narrow cones.
#ifndef SUN_GLSL
#define SUN_GLSL

#include "lib/sampling.glsl"

// Returns the radiance of a cone that has this irradiance on a surface facing it: the integral of
// the cosine over the cone is pi sin^2.
vec3 sun_radiance(vec3 irradiance, float versine)
{
    return irradiance / (PI * versine * (2.0 - versine));
}

// Returns the density per solid angle inside the cone.
float pdf_sun(float versine)
{
    return 1.0 / (2.0 * PI * versine);
}

// Samples a direction uniformly in the cone around the unit vector `axis`, which points to the sun.
// Returns the density.
float sample_sun(vec3 axis, float versine, vec2 u, out vec3 direction)
{
    float one_minus_cos = u.x * versine;
    float sin_theta = sqrt(one_minus_cos * (2.0 - one_minus_cos));
    vec3 local = vec3(sin_theta * cos_sin_turns(u.y), 1.0 - one_minus_cos);
    direction = normalize(basis_around(axis) * local);
    return pdf_sun(versine);
}

// Returns whether a unit direction is in the cone: |direction - axis|^2 is twice the versine
// between them.
bool sees_sun(vec3 axis, float versine, vec3 direction)
{
    vec3 chord = direction - axis;
    return dot(chord, chord) <= 2.0 * versine;
}

#endif
