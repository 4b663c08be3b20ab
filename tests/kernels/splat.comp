// One thread adds a splat to the film by the routines of lib/splat.glsl, or claims its digits
// (push.bounce 0). The test wrote splats into the paths' buffer, a uvec4 word each: red, green,
// blue, and twice the pixel plus the half.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/buffers.glsl"

layout(std430, set = 0, binding = BINDING_FILM) buffer film_block {
    uvec4 film_words[];
};

#include "lib/splat.glsl"

void main()
{
    uint item = gl_GlobalInvocationID.x;
    if (item >= push.part_items)
        return;
    uvec4 words = paths_words[item];
    uint at = (words.w >> 1u) * AOV_FILM_WORDS(AOVS);
    vec3 value = uintBitsToFloat(words.rgb);
    if (push.bounce == 0u)
        splat_claim(at, words.w & 1u, value);
    else
        splat(at, words.w & 1u, value);
}
