// Computes trigonometric functions of angles in turns, with errors of a few roundings on every
// device. Vulkan permits errors of 4096 units in the last place for atan() and of 2^-11 for cos(),
// which is more than a texel of a large environment. All functions are pure.
#ifndef ANGLE_GLSL
#define ANGLE_GLSL

#include "lib/numbers.glsl"

// Returns the sine of an angle of at most a quarter of a turn, by its Taylor series. The first
// omitted term is below 6e-8.
float sin_small(float turns)
{
    float t = turns * (2.0 * PI);
    float t2 = t * t;
    float rest = 1.0 - t2 / 42.0 * (1.0 - t2 / 72.0 * (1.0 - t2 / 110.0));
    return t * (1.0 - t2 / 6.0 * (1.0 - t2 / 20.0 * rest));
}

// Returns cosine and sine of an angle below 2^22 turns, which includes all azimuths. The angle is
// reduced to at most an eighth of a turn, for Taylor series whose first omitted terms are below
// 3e-8 and 2e-9.
vec2 cos_sin_turns(float turns)
{
    float quarter = floor(4.0 * turns + 0.5);
    float t = (turns - 0.25 * quarter) * (2.0 * PI); // the difference is exact
    float t2 = t * t;
    float c = 1.0 / 24.0 - t2 * (1.0 / 720.0 - t2 * (1.0 / 40320.0));
    float s = 1.0 / 120.0 - t2 * (1.0 / 5040.0 - t2 * (1.0 / 362880.0));
    vec2 v = vec2(1.0 - t2 * (0.5 - t2 * c), t - t * t2 * (1.0 / 6.0 - t2 * s));
    int quadrant = int(quarter) & 3;
    if ((quadrant & 1) != 0)
        v = vec2(-v.y, v.x);
    return quadrant >= 2 ? -v : v;
}

// Returns the angle of (x, y) from the x axis, in [-1/2, 1/2]. The arguments are reduced to at most
// tan(pi / 8), for which Gregory's series of the arctangent is used. The first omitted term is
// below 2e-8.
float atan_turns(float y, float x)
{
    float low = min(abs(x), abs(y)), high = max(max(abs(x), abs(y)), 1e-37);
    bool steep = low > 0.41421356 * high;
    float z = steep ? (low - high) / (low + high) : low / high;
    float z2 = z * z;
    float series = 1.0 / 13.0 - z2 / 15.0;
    series = 1.0 / 9.0 - z2 * (1.0 / 11.0 - z2 * series);
    series = 1.0 / 5.0 - z2 * (1.0 / 7.0 - z2 * series);
    series = z * (1.0 - z2 * (1.0 / 3.0 - z2 * series));
    float turns = series * (0.5 * INV_PI) + (steep ? 0.125 : 0.0);
    turns = abs(y) > abs(x) ? 0.25 - turns : turns;
    turns = x < 0.0 ? 0.5 - turns : turns;
    return y < 0.0 ? -turns : turns;
}

#endif
