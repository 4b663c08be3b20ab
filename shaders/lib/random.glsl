// Computes counter-based random numbers: a value depends only on (seed, pixel, sample, dimension).
#ifndef RANDOM_GLSL
#define RANDOM_GLSL

#include "lib/constants.glsl"

// Each use has its own dimension, so that leaving a feature out does not change the others. A
// dimension number gives four values.
const uint DIMENSION_CAMERA = 0u;       // pixel x, y; lens x, y
const uint DIMENSION_FIRST_BOUNCE = 1u; // then DIMENSIONS_A_BOUNCE for each bounce
const uint DIMENSIONS_A_BOUNCE = 3u;
const uint DIMENSION_LIGHT = 0u; // emitter; x and y of the point on the emitter; roulette
const uint DIMENSION_BSDF = 1u;  // direction x, y; lobe; a second choice
const uint DIMENSION_EXTRA = 2u; // more bits for the emitter; dispersion; direction strategy;
                                 // unused
const uint DIMENSION_LIGHT_PATH = DIMENSIONS_OF_LIGHT_PATHS; // see light_path_dimension()
const uint DIMENSION_PIXEL = DIMENSIONS_OF_PIXELS; // position in a stratum, x and y: see
                                                   // pixel_sampling.glsl
const uint DIMENSION_PIXEL_ORDER = DIMENSION_PIXEL + 1u;
const uint DIMENSION_ALL_LIGHTS = DIMENSIONS_OF_ALL_LIGHTS; // see light_dimension()

uint bounce_dimension(uint bounce, uint use)
{
    return DIMENSION_FIRST_BOUNCE + bounce * DIMENSIONS_A_BOUNCE + use;
}

// Light paths have dimensions separate from those of camera paths. The first dimension gives the
// emitter, the point on it x, y, and more bits for the emitter. The second gives the direction x, y
// and its side. Each bounce has the dimensions of a camera path's bounce, except that the first
// three of DIMENSION_LIGHT are the point on the lens x, y and the position in the pixel filter.
uint light_path_dimension(uint bounce, uint use)
{
    return DIMENSION_LIGHT_PATH + 1u + bounce_dimension(bounce, use);
}

// Returns the dimension of lamp number `light` if each of LIGHT_RAYS lamps has a shadow ray (point
// on an emitter x, y; which emitter of the lamp, 2 values); it is separate from all others.
uint light_dimension(uint bounce, uint light)
{
    return DIMENSION_ALL_LIGHTS + bounce * LIGHT_RAYS + light;
}

// Returns the hash pcg4d (Jarzynski and Olano 2020, "Hash Functions for GPU Rendering", listing in
// section 4).
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

// Returns uniforms in [0, 1), multiples of 2^-24.
vec4 to_uniforms(uvec4 bits)
{
    return vec4(bits >> 8u) * 5.9604644775390625e-8;
}

// Returns four independent uniforms.
vec4 random_4d(uint seed, uint pixel, uint sample_index, uint dimension)
{
    return to_uniforms(pcg4d(uvec4(pixel, sample_index, dimension, seed)));
}

#endif
