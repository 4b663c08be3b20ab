// Maps linear radiance to display values by tone curves: those of image/tone.c, which names their
// sources, in single precision. All functions are pure.
#ifndef TONE_GLSL
#define TONE_GLSL

#include "shared/display.h"

// Negative values and NaN become 0; infinity becomes the greatest float. Tests the bit pattern,
// because drivers may assume that floats are finite. The patterns of negative values and of NaN are
// above that of infinity.
float clean(float value)
{
    uint bits = floatBitsToUint(value);
    return bits > 0x7f800000u ? 0.0 : uintBitsToFloat(min(bits, 0x7f7fffffu));
}

vec3 clean(vec3 rgb)
{
    return vec3(clean(rgb.r), clean(rgb.g), clean(rgb.b));
}

// Numerator and denominator are halved, so that the greatest floats do not overflow.
vec3 tone_reinhard(vec3 rgb)
{
    vec3 half_rgb = 0.5 * rgb;
    return half_rgb / (0.5 + dot(vec3(0.2126, 0.7152, 0.0722), half_rgb));
}

// The curve exceeds 1, the maximum of a display, for values above 7.3, so values above 16 may be
// replaced by 16.
vec3 tone_aces(vec3 rgb)
{
    vec3 x = min(rgb, vec3(16.0));
    return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
}

const float AGX_INSET = 0.2;
const vec3 AGX_WHITE_SHARE = vec3(0.2119946452, 0.3921508255, 0.3958545292);
const float AGX_STOPS_BELOW = 10.0;
const float AGX_STOPS_ABOVE = 6.5;
const float AGX_MIDDLE_GREY = 0.18;
const float AGX_POWER = 2.2;
const float AGX_SLOPE = 2.4;
const float AGX_BEND = 1.5;
const float AGX_PIVOT = AGX_STOPS_BELOW / (AGX_STOPS_BELOW + AGX_STOPS_ABOVE);
const float AGX_GREY = pow(AGX_MIDDLE_GREY, 1.0 / AGX_POWER);
// The scale s of agx_half_sigmoid() below middle grey, and above it.
const float AGX_TOE = AGX_SLOPE * AGX_PIVOT /
    pow(pow(AGX_SLOPE * AGX_PIVOT / AGX_GREY, AGX_BEND) - 1.0, 1.0 / AGX_BEND);
const float AGX_SHOULDER = AGX_SLOPE * (1.0 - AGX_PIVOT) /
    pow(pow(AGX_SLOPE * (1.0 - AGX_PIVOT) / (1.0 - AGX_GREY), AGX_BEND) - 1.0, 1.0 / AGX_BEND);

// u^1.5 is computed with a square root, which is exact at 0, where logarithms are infinite.
float agx_half_sigmoid(float x, float scale)
{
    float u = AGX_SLOPE * x / scale;
    return scale * u / pow(1.0 + u * sqrt(u), 1.0 / AGX_BEND);
}

// Values beyond the ends of the logarithmic range are mapped to the ends of the curve.
float agx_curve(float value)
{
    float lowest = AGX_MIDDLE_GREY * exp2(-AGX_STOPS_BELOW);
    float highest = AGX_MIDDLE_GREY * exp2(AGX_STOPS_ABOVE);
    if (value <= lowest)
        return 0.0;
    float stops = log2(min(value, highest) / AGX_MIDDLE_GREY);
    float x = clamp((stops + AGX_STOPS_BELOW) / (AGX_STOPS_BELOW + AGX_STOPS_ABOVE), 0.0, 1.0);
    float y = x < AGX_PIVOT
        ? AGX_GREY - agx_half_sigmoid(max(AGX_PIVOT - x, 0.0), AGX_TOE)
        : AGX_GREY + agx_half_sigmoid(max(x - AGX_PIVOT, 0.0), AGX_SHOULDER);
    return pow(max(y, 0.0), AGX_POWER);
}

vec3 tone_agx(vec3 rgb)
{
    float white = dot(AGX_WHITE_SHARE, rgb);
    vec3 inset = (1.0 - AGX_INSET) * rgb + vec3(AGX_INSET * white);
    return vec3(agx_curve(inset.r), agx_curve(inset.g), agx_curve(inset.b));
}

vec3 tone_map(const uint tone, vec3 rgb)
{
    if (tone == DISPLAY_TONE_REINHARD)
        return tone_reinhard(rgb);
    if (tone == DISPLAY_TONE_ACES)
        return tone_aces(rgb);
    if (tone == DISPLAY_TONE_AGX)
        return tone_agx(rgb);
    return rgb;
}

// Returns the sRGB encoding of values in [0, 1] (IEC 61966-2-1, 5.2).
vec3 srgb_from_linear(vec3 linear)
{
    vec3 curve = 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055;
    return mix(curve, 12.92 * linear, lessThanEqual(linear, vec3(0.0031308)));
}

#endif
