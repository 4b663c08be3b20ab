// Fading of what the camera sees towards the background: not physical, but asked for now and then.
#ifndef FALLOFF_GLSL
#define FALLOFF_GLSL

#include "lib/environment.glsl"
#include "lib/buffers.glsl"

// 1 - exp(-x), x >= 0: by its series where the difference would cancel.
float part_faded(float x)
{
    return x < 1e-2 ? x * (1.0 - x * (0.5 - x * (1.0 / 6.0))) : 1.0 - exp(-x);
}

// The surface that a camera ray meets at distance t counts exp(-k t^3), the rest is background:
// adds that and returns what is left of the surface. frame.falloff is the cube root of k, so that
// t^3 cannot overflow where k t^3 does not.
float fade(uint slot, vec3 direction, float t)
{
    float part = frame.falloff * t;
    float x = part * part * part;
    vec3 background = vec3(0.0);
    if (HAS(FEATURE_ENVIRONMENT))
        background = environment_radiance(direction);
    background *= part_faded(x);
    if (any(greaterThan(background, vec3(0.0))))
        add_radiance(slot, background, SITE_MISS);
    return exp(-x);
}

#endif
