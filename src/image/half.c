#include "image/image.h"

#include <math.h>
#include <string.h>

uint16_t half_from_float(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    uint16_t sign = (uint16_t)(bits >> 16 & 0x8000);
    if (isnan(value)) // becomes a quiet NaN with the upper bits of the payload
        return (uint16_t)(sign | 0x7e00 | (bits >> 13 & 0x3ff));
    if (isinf(value))
        return (uint16_t)(sign | 0x7c00);
    float magnitude = fabsf(value);
    if (magnitude >= HALF_MAX)
        return (uint16_t)(sign | 0x7bff);
    // Below 2^-14 halves are multiples of 2^-24, and the multiple is the encoding. If rounding
    // gives 2^-14, the encoding is that of the first normal number.
    if (magnitude < 0x1p-14f)
        return (uint16_t)(sign | (uint16_t)nearbyintf(magnitude * 0x1p24f));
    // Drops 13 bits of the fraction. Adding just under half a step before, and one more if the kept
    // part is odd, carries exactly when rounding to nearest even goes up; the carry may reach the
    // exponent.
    uint32_t magnitude_bits = bits & 0x7fffffff;
    uint32_t rounded = magnitude_bits + 0xfff + (magnitude_bits >> 13 & 1);
    const uint32_t bias_difference = (uint32_t)(127 - 15) << 10;
    return (uint16_t)(sign | (uint16_t)((rounded >> 13) - bias_difference));
}

float float_from_half(uint16_t half)
{
    uint32_t sign = (uint32_t)(half & 0x8000) << 16, magnitude = half & 0x7fff, bits;
    if (magnitude < 0x0400) { // zero and subnormal numbers: multiples of 2^-24
        float value = (float)magnitude * 0x1p-24f;
        return sign ? -value : value;
    }
    if (magnitude >= 0x7c00) // infinity and NaN have all exponent bits set
        bits = sign | 0x7f800000 | (magnitude & 0x3ff) << 13;
    else
        bits = sign | ((magnitude << 13) + ((uint32_t)(127 - 15) << 23));
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}
