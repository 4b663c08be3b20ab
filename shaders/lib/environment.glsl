// What is around the scene: constant radiance, or a latitude-longitude image, sampled by importance.
// Reads the environment's buffer.
#ifndef ENVIRONMENT_GLSL
#define ENVIRONMENT_GLSL

#include "lib/buffers.glsl"
#include "lib/sampling.glsl"

// Index of the texel that a unit direction sees; see scene/environment.h for the convention. Texels
// are constant patches.
uint environment_texel(vec3 direction, uvec2 size)
{
    float u = 0.5 + atan(direction.z, direction.x) * (0.5 * INV_PI);
    float v = acos(clamp(direction.y, -1.0, 1.0)) * INV_PI;
    uvec2 texel = min(uvec2(vec2(u, v) * vec2(size)), size - 1u);
    return texel.y * size.x + texel.x;
}

uvec2 environment_size()
{
    return uvec2(frame.environment_size & 0xffffu, frame.environment_size >> 16u);
}

// What arrives from a unit direction.
vec3 environment_radiance(vec3 direction)
{
    if (!HAS(FEATURE_ENVIRONMENT_IMAGE))
        return frame.environment;
    uint texel = environment_texel(direction, environment_size());
    return frame.environment * load_environment_float(texel).rgb;
}

// Density per solid angle with which sample_environment() chooses a unit direction.
float pdf_environment(vec3 direction)
{
    return 0.25 * INV_PI;
}

// A direction by importance, from two uniforms and two more with the bits that they lack. Returns
// the density per solid angle; 0 where there is nothing to connect to.
float sample_environment(vec2 u, vec2 u_extra, out vec3 direction, out vec3 radiance)
{
    direction = sample_sphere(u);
    radiance = environment_radiance(direction);
    return 0.25 * INV_PI;
}

#endif
