// Adds values to sums of the film, and reads the sums. shared/film_sums.h describes their
// representation. All functions are pure.
#ifndef FILM_SUMS_GLSL
#define FILM_SUMS_GLSL

#include "shared/types.h"

// Returns the digit of a finite value. A value in [2^k, 2^(k + 1)) has digit (k + 128) / 32, where
// k + 127 is its exponent field. Returns 0 for values that are not finite, which add nothing.
uint film_digit(float value)
{
    uint exponent = floatBitsToUint(value) >> 23u & 255u;
    return exponent == 255u ? 0u : (exponent + 1u) >> 5u;
}

// Returns the bit of a value's digit in the digits' word, for sum number `component` of the word.
uint film_digit_bit(float value, uint component)
{
    return (1u << film_digit(value)) >> 1u << (FILM_DIGIT_BITS * component);
}

// Returns the highest digit of sum number `component`.
uint film_top_digit(uint digits, uint component)
{
    return uint(findMSB(digits >> (FILM_DIGIT_BITS * component) & FILM_DIGITS_MASK) + 1);
}

// Returns whether the even bin (x) and the odd bin (y) are emptied when the top digit rises.
bvec2 film_emptied_bins(uint before, uint after)
{
    bool one = after - before == 1u, more = after - before > 1u;
    return bvec2(more || (one && (after & 1u) == 0u), more || (one && (after & 1u) == 1u));
}

// Returns the parts that a value, whose digit is at most `top`, adds to the two bins of a sum.
uvec4 film_slices(float value, uint top)
{
    uint bits = floatBitsToUint(value), exponent = bits >> 23u & 255u;
    uint mantissa = (bits & 0x7fffffu) | (exponent > 0u ? 0x800000u : 0u);
    mantissa = exponent == 255u ? 0u : mantissa;
    // The value is mantissa * 2^(max(exponent, 1) - 150); `left` is the shift of the mantissa in
    // units of the lower bin.
    int left = int(max(exponent, 1u)) - 150 - FILM_LEAST_EXPONENT - 32 * (int(top) - 1);
    uint right = uint(clamp(-left, 0, 25)); // a shift by 25 gives 0
    mantissa = (mantissa + (1u << right >> 1u)) >> right;
    uint up = uint(max(left, 0)); // at most 39
    uint low = up < 32u ? mantissa << (up & 31u) : 0u;
    uint high = up < 32u ? mantissa >> 1u >> (31u - (up & 31u)) : mantissa << (up & 31u);
    high += low >> 31u; // rounds to nearest; the remainder is signed
    uvec2 upper = uvec2(high, 0u), lower = uvec2(low, 0u - (low >> 31u));
    if ((bits >> 31u) != 0u) {
        upper = uvec2(0u - high, high != 0u ? ~0u : 0u);
        lower = uvec2(0u - low, ~lower.y + (low == 0u ? 1u : 0u));
    }
    return (top & 1u) == 0u ? uvec4(upper, lower) : uvec4(lower, upper);
}

// Adds `slices` to the two bins of a sum, with carries. Additions may come in any order.
uvec4 film_add_bins(uvec4 bins, uvec4 slices)
{
    uvec2 low = bins.xz + slices.xz;
    uvec2 carry = uvec2(lessThan(low, slices.xz));
    uvec2 high = bins.yw + slices.yw + carry;
    return uvec4(low.x, high.x, low.y, high.y);
}

// Adds a value to a sum whose top digit is `top`.
void film_add(inout uvec4 bins, inout uint top, float value)
{
    uint before = top;
    top = max(top, film_digit(value));
    bvec2 emptied = film_emptied_bins(before, top);
    bins.xy = emptied.x ? uvec2(0u) : bins.xy;
    bins.zw = emptied.y ? uvec2(0u) : bins.zw;
    bins = film_add_bins(bins, film_slices(value, top));
}

// Returns 2^exponent for an exponent in [-126, 127].
float film_power_of_two(int exponent)
{
    return uintBitsToFloat(uint(exponent + 127) << 23u);
}

// Returns a sum divided by a number of samples. Both bins together are an integer of 96 bits.
float film_mean(uvec4 bins, uint top, float samples)
{
    uvec2 upper = (top & 1u) == 0u ? bins.xy : bins.zw;
    uvec2 lower = (top & 1u) == 0u ? bins.zw : bins.xy;
    uvec3 words = uvec3(lower.x, lower.y + upper.x, upper.y);
    words.z += 0u - (lower.y >> 31u); // sign extension
    words.z += words.y < upper.x ? 1u : 0u;
    bool negative = (words.z >> 31u) != 0u;
    if (negative) {
        words = ~words;
        words.x++;
        words.y += words.x == 0u ? 1u : 0u;
        words.z += words.x == 0u && words.y == 0u ? 1u : 0u;
    }
    // `head` gets the highest 32 significant bits. Its lowest bit is set if any lower bit is set.
    uvec3 shifted = words.z != 0u ? words : words.y != 0u ? uvec3(0u, words.xy)
                                                          : uvec3(0u, 0u, words.x);
    int skipped = words.z != 0u ? 64 : words.y != 0u ? 32 : 0;
    if (shifted.z == 0u)
        return 0.0;
    int most = findMSB(shifted.z);
    uint left = uint(31 - most);
    uint head = shifted.z << left | shifted.y >> 1u >> (31u - left);
    head |= (shifted.y << left | shifted.x) != 0u ? 1u : 0u;
    // The scaling takes two steps, because the power of two may be out of range for one float.
    int exponent = skipped + most - 31 + FILM_LEAST_EXPONENT + 32 * (int(top) - 1);
    int first = exponent / 2;
    precise float mean = float(head) / samples * film_power_of_two(first) *
                         film_power_of_two(exponent - first);
    return negative ? -mean : mean;
}

// Returns the factors that convert the halves of struct gpu_film_pixel to sums: 1, or for running
// means their numbers of samples. means_a: as in that struct; samples: those of both halves.
vec2 film_sum_factors(uint means_a, uint samples)
{
    return means_a > 0u ? vec2(means_a - 1u, samples - (means_a - 1u)) : vec2(1.0);
}

#endif
