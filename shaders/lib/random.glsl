// Random numbers by counter: a value depends on (seed, pixel, sample, dimension) alone.
#ifndef RANDOM_GLSL
#define RANDOM_GLSL

#include "lib/constants.glsl"

// A dimension belongs to a use, so that leaving a feature out shifts nothing. Each number stands
// for four values.
const uint DIMENSION_CAMERA = 0u;       // pixel x, y; lens x, y
const uint DIMENSION_FIRST_BOUNCE = 1u; // then DIMENSIONS_A_BOUNCE each
const uint DIMENSIONS_A_BOUNCE = 3u;
const uint DIMENSION_LIGHT = 0u; // which emitter; point on it x, y; roulette
const uint DIMENSION_BSDF = 1u;  // direction x, y; lobe; a second choice
const uint DIMENSION_EXTRA = 2u; // within the emitter's bin; dispersion; way to go on; one to spare
const uint DIMENSION_LIGHT_PATH = DIMENSIONS_OF_LIGHT_PATHS; // see light_path_dimension()
const uint DIMENSION_PIXEL = DIMENSIONS_OF_PIXELS; // place in a stratum x, y: pixel_sampling.glsl
const uint DIMENSION_PIXEL_ORDER = DIMENSION_PIXEL + 1u;
const uint DIMENSION_ALL_LIGHTS = DIMENSIONS_OF_ALL_LIGHTS; // see light_dimension()

uint bounce_dimension(uint bounce, uint use)
{
    return DIMENSION_FIRST_BOUNCE + bounce * DIMENSIONS_A_BOUNCE + use;
}

// Light paths have dimensions apart from those of camera paths: which emitter, point on it x, y, more
// of the first; direction x, y, its side, one to spare; then of each bounce, with the point on the
// lens x, y and the place in the pixel filter for DIMENSION_LIGHT's first three.
uint light_path_dimension(uint bounce, uint use)
{
    return DIMENSION_LIGHT_PATH + 1u + bounce_dimension(bounce, use);
}

// The dimension of lamp number `light` (point on an emitter x, y; which of the lamp's, twice) when
// each of `LIGHT_RAYS` is connected to: apart from all others.
uint light_dimension(uint bounce, uint light)
{
    return DIMENSION_ALL_LIGHTS + bounce * LIGHT_RAYS + light;
}

// pcg4d, Jarzynski and Olano 2020, "Hash Functions for GPU Rendering", listing in section 4.
uvec4 pcg4d(uvec4 v)
{
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> 16u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// Uniforms in [0, 1), multiples of 2^-24.
vec4 to_uniforms(uvec4 bits)
{
    return vec4(bits >> 8u) * 5.9604644775390625e-8;
}

// Four that are independent.
vec4 random_4d(uint seed, uint pixel, uint sample_index, uint dimension)
{
    return to_uniforms(pcg4d(uvec4(pixel, sample_index, dimension, seed)));
}

#endif
