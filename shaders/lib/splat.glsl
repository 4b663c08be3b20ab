// Adds contributions to any pixel of the film, by atomic operations: for an includer that owns the
// film's binding as film_words[], a buffer of uvec4 that it may write. Takes two dispatches with a
// barrier between: in the first all splats claim their digits, in the second they are added. Then
// neither their order nor how they are shared between dispatches changes a bit of the film. Nothing
// else may add to these pixels meanwhile. A splat is no sample: nothing is counted.
#ifndef SPLAT_GLSL
#define SPLAT_GLSL

#include "lib/film_sums.glsl"

// Marks the digits of a contribution to half `number`, 0 or 1, of the pixel whose record begins at
// `at`, and empties the bins that are left below. Several threads may do that at once: nothing is
// added while digits rise, and emptying twice is emptying.
void splat_claim(uint at, uint number, vec3 value)
{
    uint bits = film_digit_bit(value.r, 0u) | film_digit_bit(value.g, 1u) |
                film_digit_bit(value.b, 2u);
    if (bits == 0u)
        return;
    uint before = atomicOr(film_words[at][2u + number], bits);
    for (uint c = 0u; c < 3u; c++) {
        uint sum = at + 1u + FILM_HALF_WORDS * number + c;
        bvec2 emptied = film_emptied_bins(film_top_digit(before, c),
                                          film_top_digit(before | bits, c));
        for (uint word = 0u; word < 4u; word++)
            if (emptied[word >> 1u])
                atomicExchange(film_words[sum][word], 0u);
    }
}

// Adds to one bin, whose low word is number `word` of a sum's.
void splat_to_bin(uint sum, uint word, uvec2 slice)
{
    if (slice == uvec2(0u))
        return;
    uint before = atomicAdd(film_words[sum][word], slice.x);
    uint high = slice.y + (before + slice.x < before ? 1u : 0u);
    if (high != 0u)
        atomicAdd(film_words[sum][word + 1u], high);
}

// Adds a contribution that was claimed. Channels that are not finite bring nothing.
void splat(uint at, uint number, vec3 value)
{
    uint digits = film_words[at][2u + number];
    for (uint c = 0u; c < 3u; c++) {
        uint sum = at + 1u + FILM_HALF_WORDS * number + c;
        uvec4 slices = film_slices(value[c], film_top_digit(digits, c));
        splat_to_bin(sum, 0u, slices.xy);
        splat_to_bin(sum, 2u, slices.zw);
    }
}

#endif
