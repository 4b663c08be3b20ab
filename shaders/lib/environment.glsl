// Latitude-longitude environment images. Pure functions.
#ifndef ENVIRONMENT_GLSL
#define ENVIRONMENT_GLSL

#include "lib/constants.glsl"

// Index of the texel that a unit direction sees; see scene/environment.h for the convention. Texels
// are constant patches.
uint environment_texel(vec3 direction, uvec2 size)
{
    float u = 0.5 + atan(direction.z, direction.x) * (0.5 * INV_PI);
    float v = acos(clamp(direction.y, -1.0, 1.0)) * INV_PI;
    uvec2 texel = min(uvec2(vec2(u, v) * vec2(size)), size - 1u);
    return texel.y * size.x + texel.x;
}

#endif
