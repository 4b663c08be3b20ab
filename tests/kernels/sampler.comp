// Runs the shipped samplers or pixel filters on inputs that the test wrote into the paths' buffer:
// one word of four for each thread, which is overwritten by what comes out.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/filter.glsl"
#include "lib/pixel_sampling.glsl"
#include "sampler_routines.h"

layout(constant_id = CONSTANT_ROUTINE) const uint ROUTINE = 0u;

void main()
{
    uint item = push.first_item + gl_GlobalInvocationID.x;
    if (item >= push.part_items)
        return;
    uvec4 given = paths_words[item];
    vec4 result = vec4(0.0);
    if (ROUTINE == ROUTINE_UNIFORMS) // pixel, sample, dimension
        result = pixel_uniforms(given.x, given.y, given.z);
    if (ROUTINE == ROUTINE_FILTER)
        result.xy = filter_position(uintBitsToFloat(given.xy));
    if (ROUTINE == ROUTINE_PIXEL) // pixel, sample
        result.xy = pixel_uniforms_2d(given.x, given.y);
    paths_words[item] = floatBitsToUint(result);
}
