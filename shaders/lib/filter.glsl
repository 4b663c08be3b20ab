// Samples the pixel filter: places a sample in or around its pixel, so that all samples have the
// same weight.
#ifndef FILTER_GLSL
#define FILTER_GLSL

#include "lib/angle.glsl"
#include "lib/buffers.glsl"

// Samples the density 1 - |x| in [-1, 1] by inversion.
vec2 sample_tent(vec2 u)
{
    vec2 t = 2.0 * u - 1.0;
    vec2 rest = 1.0 - abs(t);
    return sign(t) * (1.0 - sqrt(rest));
}

// Samples the density exp(-9/2 r^2) in the unit disc (Box and Muller 1958). This is a Gaussian
// whose standard deviation is a third of the radius, truncated at the radius; the fraction beyond
// would be exp(-9/2) = 1.1 %.
vec2 sample_gaussian(vec2 u)
{
    float r = sqrt(-2.0 / 9.0 * log(1.0 - u.x * 0.98889100346175773));
    return r * cos_sin_turns(u.y);
}

// Samples the density w(x) = 1 + sum a_k cos(k pi x), k = 1 .. 3, in [-1, 1]: the four-term window
// with side lobes of -92 dB (Harris 1978, "On the use of windows for harmonic analysis", table 1).
float sample_blackman_harris(float u)
{
    const vec4 a = vec4(0.35875, 0.48829, 0.14128, 0.01168) / 0.35875;
    float t = abs(2.0 * u - 1.0);
    // Solves (integral of w from 0 to x) = t. y is roughly proportional to a normal deviate. A
    // polynomial in y, fitted to the inverse function, has an error of 6e-5 in t; one step of
    // Newton's method reduces it to 1.2e-7.
    float y = sqrt(-log((1.0 - t) * (1.0 + t)));
    float x = 2.89964926e-4;
    x = x * y - 2.3637407e-3;
    x = x * y + 4.62546991e-3;
    x = x * y - 6.52821688e-3;
    x = x * y + 2.07944843e-3;
    x = min((x * y + 0.358498156) * y, 1.0);
    vec2 turned = cos_sin_turns(0.5 * x);
    float c = turned.x, s = turned.y;
    float integral = x + s / PI * (a.y - a.w / 3.0 + c * (a.z + c * a.w * 4.0 / 3.0));
    float density = 1.0 + a.y * c + a.z * (2.0 * c * c - 1.0) + a.w * c * (4.0 * c * c - 3.0);
    x = clamp(x + (t - integral) / density, 0.0, 1.0);
    return u < 0.5 ? -x : x;
}

// Returns the position in pixels from the pixel's upper left corner; u is in [0, 1)^2.
vec2 filter_position(vec2 u)
{
    if (FILTER == FILTER_TENT)
        return 0.5 + frame.filter_radius * sample_tent(u);
    if (FILTER == FILTER_GAUSSIAN)
        return 0.5 + frame.filter_radius * sample_gaussian(u);
    if (FILTER == FILTER_BLACKMAN_HARRIS)
        return 0.5 + frame.filter_radius *
                         vec2(sample_blackman_harris(u.x), sample_blackman_harris(u.y));
    return 0.5 + frame.filter_radius * (2.0 * u - 1.0); // exactly u if the radius is 0.5
}

#endif
