// Adds contributions to arbitrary pixels of the film by atomic operations. The including kernel
// declares the film's binding as film_words[], a writable buffer of uvec4. Two dispatches with a
// barrier between them are necessary: in the first all splats claim their digits, in the second
// they are added. Then neither their order nor their division into dispatches changes the bits of
// the film. No other kernel may add to these pixels at the same time. A splat is not a sample, so
// no samples are counted.
#ifndef SPLAT_GLSL
#define SPLAT_GLSL

#include "lib/film_sums.glsl"

// Marks the digits of a contribution to half-buffer `number`, 0 or 1, of the pixel whose record
// begins at `at`, and empties bins whose digits have become too low. Several threads may do this at
// the same time, because nothing is added while digits rise, and a bin may be emptied twice.
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

// Adds to one bin of a sum; `word` is the index of the bin's low word.
void splat_to_bin(uint sum, uint word, uvec2 slice)
{
    if (slice == uvec2(0u))
        return;
    uint before = atomicAdd(film_words[sum][word], slice.x);
    uint high = slice.y + (before + slice.x < before ? 1u : 0u);
    if (high != 0u)
        atomicAdd(film_words[sum][word + 1u], high);
}

// Adds a contribution whose digits were claimed. Channels that are not finite add nothing.
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
