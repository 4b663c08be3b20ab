// Computes the similarity of two pixels, which stops the filter at edges. All functions are pure.
#ifndef DENOISE_WEIGHTS_GLSL
#define DENOISE_WEIGHTS_GLSL

// The parameters sigma_l and sigma_n of Schied et al. 2017, section 4.4.
const float SIGMA_LUMINANCE = 4.0;
const uint NORMAL_SQUARINGS = 7u; // the exponent sigma_n is 2^7 = 128

// Returns the B3 spline's weight at a distance of 0, 1 or 2 steps.
float spline(int distance)
{
    return distance == 0 ? 0.375 : distance == 1 ? 0.25 : 0.0625;
}

// The relative error of a depth, 16 * 2^-24: a few roundings each for the ray, its hit and the sum
// over samples.
const float DEPTH_ROUNDING = 9.5367431640625e-7;

// The maximum luminance (BT.709) by which the filter weighs: its square times any number of samples
// is finite. Brighter light counts as this bright.
const float LUMINANCE_MOST = 1e14;
float luminance(vec3 light)
{
    return min(dot(light, vec3(0.2126, 0.7152, 0.0722)), LUMINANCE_MOST);
}

bool is_empty(vec4 guide)
{
    return guide.w < 0.0;
}

bool is_sky(vec4 guide)
{
    return dot(guide.xyz, guide.xyz) == 0.0;
}

// Returns the weight of Schied et al. 2017, equation (4), but at least least^128. The environment
// has no normal: with least = 1 it is similar to everything, and only its depth distinguishes it
// from surfaces.
float normal_weight(vec3 a, vec3 b, float least)
{
    float weight = max(dot(a, b), least);
    for (uint i = 0u; i < NORMAL_SQUARINGS; i++)
        weight *= weight;
    return weight;
}

// The depth of a surface around a pixel: its change to the next pixel in x and in y, and a bound on
// the difference between the mean depth of jittered samples and the depth at the pixel's centre.
struct depth_plane {
    vec4 guide;
    vec2 slope;
    float jitter;
    float rounding;
    float least_normal;
};

// length_change: the result of ray_length_change().
depth_plane make_plane(vec4 guide, vec2 slope, float length_change)
{
    bool sky = is_sky(guide);
    float jitter = abs(slope.x) + abs(slope.y) + length_change * guide.w;
    // Depths of surfaces are normal floats and the depth of the sky is 0, so any tolerance
    // distinguishes them.
    return depth_plane(guide, slope, sky ? 1e-37 : jitter, DEPTH_ROUNDING * guide.w,
                       sky ? 1.0 : 0.0);
}

// Returns the similarity of the surfaces of two pixels; 0 for pixels without samples. The exponent
// is that of equation (3), but for the deviation from the plane instead of the depth: so on a slope
// seen at a grazing angle the filter reaches as far as on a surface that faces the camera. further:
// other terms of the exponent.
float surface_weight(depth_plane plane, vec4 other, vec2 offset, float further)
{
    float expected = dot(plane.slope, offset);
    float reach = 1.0 + abs(offset.x) + abs(offset.y);
    float tolerance = abs(expected) + plane.jitter + reach * plane.rounding;
    float deviation = abs(other.w - plane.guide.w - expected);
    return normal_weight(plane.guide.xyz, other.xyz, plane.least_normal) *
           exp(-(deviation / tolerance + further));
}

// Returns the factor of a luminance difference in the exponent of equation (5). Without variance
// every difference is large.
float luminance_scale(float variance)
{
    return variance > 0.0 ? 1.0 / (SIGMA_LUMINANCE * sqrt(variance)) : 3.0e38;
}

// Returns the best weight lambda in lambda f + (1 - lambda) p, where f is an estimate with bias b,
// and p is unbiased with variance V. The error lambda^2 b^2 + (1 - lambda)^2 V is least for lambda
// = V / (V + b^2), and is then below both b^2 and V. `bias` is an estimate of b^2, which may be
// negative.
float best_part(float variance, float bias)
{
    return bias > 0.0 ? variance / (variance + bias) : 1.0;
}

#endif
