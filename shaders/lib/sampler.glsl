// The uniforms of a path, by the sampler that was chosen.
#ifndef SAMPLER_GLSL
#define SAMPLER_GLSL

#include "lib/buffers.glsl"
#include "lib/random.glsl"

// Four uniforms in [0, 1) of the slot's pixel and sample, for one use of them (DIMENSION_*).
vec4 uniforms(uint slot, uint dimension)
{
    return random_4d(frame.seed, slot_pixel(slot), slot_sample(slot), dimension);
}

#endif
