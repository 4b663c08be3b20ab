// Runs the renderer's samplers or pixel filters on input that the host has written to the paths'
// buffer. Each thread has one word (uvec4) there, which it overwrites with its output.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/filter.glsl"
#include "lib/pixel_sampling.glsl"
#include "shared/check_sampler.h"

layout(constant_id = CONSTANT_CHECK_ROUTINE) const uint ROUTINE = 0u;

void main()
{
    uint item = push.first_item + gl_GlobalInvocationID.x;
    if (item >= push.part_items)
        return;
    uvec4 given = paths_words[item];
    vec4 result = vec4(0.0);
    if (ROUTINE == SAMPLER_ROUTINE_UNIFORMS) // pixel, sample, dimension
        result = pixel_uniforms(given.x, given.y, given.z);
#ifdef PLANTED_UNIFORMS // planted fault, which tests must detect: the numbers are not uniform
    result *= 0.9;
#endif
    if (ROUTINE == SAMPLER_ROUTINE_FILTER)
        result.xy = filter_position(uintBitsToFloat(given.xy));
    if (ROUTINE == SAMPLER_ROUTINE_PIXEL) // pixel, sample
        result.xy = pixel_uniforms_2d(given.x, given.y);
    paths_words[item] = floatBitsToUint(result);
}
