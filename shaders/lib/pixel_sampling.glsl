// Places a sample in its pixel's filter, by strategies other than the sampler's.
#ifndef PIXEL_SAMPLING_GLSL
#define PIXEL_SAMPLING_GLSL

#include "lib/sampler.glsl"

// Returns the stratum of a sample, among n x n. Each half-buffer visits all strata before it visits
// any again, in a random order that differs between pixels, halves and rounds. So every sample is
// in each stratum with the same probability for any number of samples, and the halves are
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

// Returns two uniforms in [0, 1), multiples of 2^-24, for filter_position(). They are computed with
// integers, so that the points of a stratum do not leave it.
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
