// Runs the shipped samplers or pixel filters on inputs that the host wrote into the paths' buffer:
// one word of four for each thread, which is overwritten by what comes out.
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
#ifdef PLANTED_UNIFORMS // tests of tests only: are numbers found that are not uniform?
    result *= 0.9;
#endif
    if (ROUTINE == SAMPLER_ROUTINE_FILTER)
        result.xy = filter_position(uintBitsToFloat(given.xy));
    if (ROUTINE == SAMPLER_ROUTINE_PIXEL) // pixel, sample
        result.xy = pixel_uniforms_2d(given.x, given.y);
    paths_words[item] = floatBitsToUint(result);
}
