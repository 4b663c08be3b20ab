// Computes the uniforms of a path by the chosen sampler. docs/sampling.md describes the samplers.
#ifndef SAMPLER_GLSL
#define SAMPLER_GLSL

#include "lib/angle.glsl"
#include "lib/double_float.glsl"
#include "lib/halves.glsl"
#include "lib/random.glsl"

// --- random permutations -------------------------------------------------------------------------

// Owen's scrambling (1995) of fractions with reversed digits, the first digit in bit 0: whether a
// bit is flipped depends only on the bits below it. It is similar to Laine and Karras 2011,
// "Stratified sampling for stochastic transparency", but uses enough random words to make all flips
// of the first three digits independent; their single word makes eight of the 128 combinations at
// least twice as probable.
uvec4 scramble(uvec4 x, uvec4 key)
{
    uvec4 other = key >> 16u | key << 16u;
    x += key;
    x ^= x * (other & ~1u);
    x ^= other >> 4u;
    x += key >> 11u;
    x ^= x * 0x05526c56u;
    x *= other >> 8u | 1u;
    return x ^ x * 0x53a22864u;
}

// Returns the position of `i` in a random permutation of 0 .. count - 1: invertible multiplications
// and shifts of as many bits as `count` needs, repeated until the result is below `count` (Kensler
// 2013, "Correlated multi-jittered sampling"). With eight rounds, chi-square tests of pairs find no
// deviation.
uint permute(uint i, uint count, uint key)
{
    if (count < 2u)
        return 0u;
    int bits = findMSB(count - 1u) + 1;
    uint mask = 0xffffffffu >> (32 - bits);
    int middle = (bits + 1) / 2;
    do {
        uint k = key;
        for (int round = 0; round < 8; round++) {
            k = k * 747796405u + 2891336453u;
            uint mixed = k ^ k >> 15u;
            i = (i * (mixed | 1u) + (mixed >> 16u)) & mask;
            i ^= i >> middle;
        }
        k = k * 747796405u + 2891336453u;
        i = (i + (k >> 8u)) & mask;
    } while (i >= count);
    return i;
}

// --- Sobol's sequence ----------------------------------------------------------------------------

// Polynomials over GF(2) are words of their coefficients. The functions below return the digits of
// n in base p, with the lowest first: point n of Niederreiter's sequence (1988, "Low-discrepancy
// and low-dispersion sequences") for p, with reversed bits as scramble() needs. Sobol's sequence
// (1967) differs from it by a fixed permutation of each digit that depends on the digits before it.
// Owen's scrambling makes that difference irrelevant, so no direction numbers are needed. Because
// p(x)^2 = p(x^2), division by the powers of p that halve the number of digits takes a few shifts
// for all parts of the word at once: n = q p + r becomes q x^e + r.

// p = x + 1
uint digits_1(uint n)
{
    n ^= n >> 16u;
    n ^= n >> 8u & 0x00ff00ffu;
    n ^= n >> 4u & 0x0f0f0f0fu;
    n ^= n >> 2u & 0x33333333u;
    return n ^ n >> 1u & 0x55555555u;
}

// p = x^2 + x + 1. Divides by p^8 = x^16 + x^8 + 1, then by p^4, p^2 and p.
uint digits_2(uint n)
{
    uint q = n >> 16u;
    q ^= q >> 8u;
    n ^= q ^ q << 8u;
    q = n >> 8u & 0x00ff00ffu;
    q ^= q >> 4u & 0x000f000fu;
    n ^= q ^ q << 4u;
    q = n >> 4u & 0x0f0f0f0fu;
    q ^= q >> 2u & 0x03030303u;
    n ^= q ^ q << 2u;
    q = n >> 2u & 0x33333333u;
    q ^= q >> 1u & 0x11111111u;
    return n ^ q ^ q << 1u;
}

// p = x^3 + x + 1. Divides by p^8 = x^24 + x^8 + 1, then by p^4, p^2 and p.
uint digits_3(uint n)
{
    uint q = n >> 24u;
    n ^= q ^ q << 8u;
    q = n >> 12u & 0xfffu;
    q ^= q >> 8u;
    n ^= q ^ q << 4u;
    q = n >> 6u & 0x0303f03fu;
    q ^= q >> 4u & 0x00003003u;
    n ^= q ^ q << 2u;
    q = n >> 3u & 0x071c71c7u;
    q ^= q >> 2u & 0x01041041u;
    return n ^ q ^ q << 1u;
}

// Returns four dimensions of a point of the sequence, which is shuffled and scrambled by the keys
// (Burley 2020, "Practical hash-based Owen scrambling"). Different shuffles make sequences with
// different dimension numbers independent of each other.
vec4 sobol_4d(uint index, uvec4 keys)
{
    // `order` is computed by a further step of pcg4d().
    uint order = keys.x + keys.y * keys.w;
    uint n = bitfieldReverse(scramble(uvec4(bitfieldReverse(index)), uvec4(order)).x);
    uvec4 digits = uvec4(n, digits_1(n), digits_2(n), digits_3(n));
    return to_uniforms(bitfieldReverse(scramble(digits, keys)));
}

// Each pixel has its own sequence.
vec4 sobol(uint pixel, sequence_place place, uint dimension)
{
    return sobol_4d(place.index, pcg4d(uvec4(pixel, ~place.sequence, dimension, frame.seed)));
}

// --- blue noise ----------------------------------------------------------------------------------

#define TILE_BITS 8u // bits of the coordinates in a tile of pixels, which share one sequence

uint spread_bits(uint x)
{
    x = (x | x << 4u) & 0x0f0fu;
    x = (x | x << 2u) & 0x3333u;
    return (x | x << 1u) & 0x5555u;
}

// A tile of pixels shares one sequence, whose points are assigned along a Z curve: points of
// neighbouring pixels complement each other, so that neighbours' errors differ and the eye averages
// them (Ahmed and Wonka 2020, "Screen-space blue-noise diffusion of Monte Carlo sampling error via
// hierarchical ordering of pixels"). The shuffling in sobol_4d() is their method in base 2. A pixel
// has a block of the sequence, with as many points as samples are planned. Further samples use
// blocks of other sequences; if the number of samples is not known, the blocks have 1, 1, 2, 4, ...
// points.
vec4 blue_noise(uint pixel, sequence_place place, uint dimension)
{
    uint bits, block, index;
    if (place.count > 0u) {
        bits = place.count > 1u ? min(uint(findMSB(place.count - 1u)) + 1u, 30u) : 0u;
        block = place.index >> bits;
        index = place.index & ((1u << bits) - 1u);
    } else {
        bits = place.index > 0u ? uint(findMSB(place.index)) : 0u;
        block = place.index > 0u ? bits + 1u : 0u;
        index = place.index > 0u ? place.index - (1u << bits) : 0u;
    }
    uint tile_bits = min(TILE_BITS, (32u - bits) / 2u);
    uint x = pixel % frame.picture_width, y = pixel / frame.picture_width;
    uint tile = (y >> tile_bits) * ((frame.picture_width >> tile_bits) + 1u) + (x >> tile_bits);
    uint mask = (1u << tile_bits) - 1u;
    uint curve = spread_bits(x & mask) | spread_bits(y & mask) << 1u;
    uint sequence = ~(place.sequence | block << 1u);
    return sobol_4d(curve << bits | index, pcg4d(uvec4(tile, sequence, dimension, frame.seed)));
}

// --- strata --------------------------------------------------------------------------------------

#define STRATA_MAX 0xfffe0001u // 65535^2: for more, columns x rows may overflow

// Returns a point of multi-jittered sampling (Chiu, Shirley and Wang 1994) in cell `cell` of a grid
// of columns x rows. The cell's column is divided into `rows` strata, and its row into `columns`
// strata; one random permutation for all columns and one for all rows (Kensler 2013) assign the
// strata to cells. `jitter` is the position in the stratum.
vec2 stratum_point(uint cell, uint columns, uint rows, uvec2 keys, vec2 jitter)
{
    uint column = cell % columns, row = cell / columns;
    vec2 fine = vec2(column * rows + permute(row, rows, keys.x),
                     row * columns + permute(column, columns, keys.y));
    vec2 u = floor((fine + jitter) / float(columns * rows) * 16777216.0);
    return min(u, 16777215.0) * 5.9604644775390625e-8;
}

// Returns two points: x and y are a point of one set of strata, z and w of another. If the samples
// do not fill all cells, random cells remain empty. Samples beyond the planned number have their
// own strata; if the number is not known, all samples are independent.
vec4 stratified(uint pixel, uint sample_index, sequence_place place, uint dimension)
{
    vec4 independent = random_4d(frame.seed, pixel, sample_index, dimension);
    if (place.count == 0u || place.count > STRATA_MAX)
        return independent;
    uint block = place.index / place.count;
    uint index = place.index - block * place.count;
    uint columns = uint(ceil(sqrt(float(place.count))));
    uint rows = (place.count + columns - 1u) / columns;
    uint sequence = ~(place.sequence | block << 1u);
    uvec4 keys = pcg4d(uvec4(pixel, sequence, dimension, frame.seed));
    vec4 jitter = SAMPLER == SAMPLER_GRID ? vec4(0.5) : independent;
    uint first = permute(index, columns * rows, keys.x);
    uint second = permute(index, columns * rows, keys.y);
    return vec4(stratum_point(first, columns, rows, uvec2(keys.z, ~keys.w), jitter.xy),
                stratum_point(second, columns, rows, uvec2(keys.w, ~keys.z), jitter.zw));
}

// --- a linear congruential generator -------------------------------------------------------------

// A simple generator, for comparison. The seed comes from eight rounds of the Tiny Encryption
// Algorithm (Wheeler and Needham 1994), as Zafar, Olano and Curtis 2010 propose. Then four steps of
// the generator of Numerical Recipes (1992, section 7.1) follow, with a new seed for each dimension
// number.
vec4 random_lcg(uint pixel, uint sample_index, uint dimension)
{
    uvec2 v = uvec2(pixel, sample_index);
    uint sum = 0u;
    for (int round = 0; round < 8; round++) {
        sum += 0x9e3779b9u;
        v.x += (v.y << 4u) + frame.seed ^ v.y + sum ^ (v.y >> 5u) + dimension;
        v.y += (v.x << 4u) + ~dimension ^ v.x + sum ^ (v.x >> 5u) + ~frame.seed;
    }
    uvec4 states;
    uint state = v.x;
    for (int i = 0; i < 4; i++) {
        state = state * 1664525u + 1013904223u;
        states[i] = state;
    }
    return to_uniforms(states);
}

// --- fractions of sines --------------------------------------------------------------------------

// Returns the sine of any float, in radians. Its number of turns is a sum of two floats, as is 1 /
// (2 pi).
float sine_of(float radians)
{
    const vec2 inverse = vec2(0.159154937, 6.42063832e-09);
    vec2 turns = exact_product(radians, inverse.x);
    float rest = turns.y + radians * inverse.y;
    return cos_sin_turns(fract(turns.x) + fract(rest)).y;
}

// Returns, for comparison, fract(43758.5453 sin(12.9898 x + 78.233 y + ...)), which many tutorials
// on shaders use. The product is a multiple of 2^-8 if the sine is near 1, and similar arguments
// have similar results. So the numbers are neither uniform nor independent (docs/sampling.md).
vec4 random_sine(uint pixel, uint sample_index, uint dimension)
{
    uint x = pixel % frame.picture_width, y = pixel / frame.picture_width;
    vec4 place = vec4(x, y, sample_index, frame.seed);
    float phase = dot(place, vec4(12.9898, 78.233, 45.164, 94.673));
    vec4 phases = phase + 37.719 * (4.0 * float(dimension) + vec4(0.0, 1.0, 2.0, 3.0));
    vec4 sines = vec4(sine_of(phases.x), sine_of(phases.y), sine_of(phases.z), sine_of(phases.w));
    vec4 u = fract(sines * 43758.5453);
    return min(floor(u * 16777216.0), 16777215.0) * 5.9604644775390625e-8;
}

// -------------------------------------------------------------------------------------------------

vec4 pixel_uniforms(uint pixel, uint sample_index, uint dimension)
{
    if (SAMPLER == SAMPLER_LCG)
        return random_lcg(pixel, sample_index, dimension);
    if (SAMPLER == SAMPLER_SINE)
        return random_sine(pixel, sample_index, dimension);
    if (SAMPLER == SAMPLER_SOBOL)
        return sobol(pixel, place_in_sequence(sample_index), dimension);
    if (SAMPLER == SAMPLER_BLUE_NOISE)
        return blue_noise(pixel, place_in_sequence(sample_index), dimension);
    if (SAMPLER == SAMPLER_STRATIFIED || SAMPLER == SAMPLER_GRID)
        return stratified(pixel, sample_index, place_in_sequence(sample_index), dimension);
    return random_4d(frame.seed, pixel, sample_index, dimension);
}

// Returns four uniforms in [0, 1) for the slot's pixel and sample, for one use (DIMENSION_*). Any
// dimension number is possible. Components x and y are stratified together, and so are z and w.
vec4 uniforms(uint slot, uint dimension)
{
    return pixel_uniforms(slot_pixel(slot), slot_sample(slot), dimension + slot_stream(slot));
}

#endif
