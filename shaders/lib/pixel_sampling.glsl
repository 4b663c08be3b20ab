// Places a sample in its pixel's filter if the sampler does not do so.
#ifndef PIXEL_SAMPLING_GLSL
#define PIXEL_SAMPLING_GLSL

#include "lib/sampler.glsl"

// The stratum of a sample, among n x n. Each half-buffer goes through all of them before it comes
// to any again, in an order that is drawn anew for each pixel, half and round: so every sample
// lies in any stratum with the same probability, however many there are, and the halves stay
// independent.
uvec2 pixel_stratum(uint pixel, uint sample_index, uint n)
{
    sequence_place place = place_in_sequence(sample_index);
    uint round = place.index / (n * n);
    uvec4 key = pcg4d(
        uvec4(pixel, round << 1u | place.sequence, DIMENSION_PIXEL_ORDER, frame.seed));
    uint stratum = permute(place.index - round * (n * n), n * n, key.x);
    return uvec2(stratum % n, stratum / n);
}

// Two uniforms in [0, 1), multiples of 2^-24, for filter_position(). In whole numbers: a stratum's
// points stay in it.
vec2 pixel_uniforms_2d(uint pixel, uint sample_index)
{
    uvec2 inside = pcg4d(uvec4(pixel, sample_index, DIMENSION_PIXEL, frame.seed)).xy >> 8u;
    if (PIXEL_SAMPLING == PIXEL_SAMPLING_GRID)
        inside = uvec2(1u << 23);
    if (PIXEL_SAMPLING != PIXEL_SAMPLING_RANDOM) {
        uint n = frame.pixel_strata;
        inside = (pixel_stratum(pixel, sample_index, n) << 24u | inside) / n;
    }
    return vec2(inside) * 5.9604644775390625e-8;
}

#endif
