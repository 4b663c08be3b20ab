// The similarity of two pixels, which stops the filter at edges. Pure functions.
#ifndef DENOISE_WEIGHTS_GLSL
#define DENOISE_WEIGHTS_GLSL

// sigma_l and sigma_n of Schied et al. 2017, section 4.4.
const float SIGMA_LUMINANCE = 4.0;
const uint NORMAL_SQUARINGS = 7u; // a power of 2^7 = 128

// The B3 spline at a distance of 0, 1 or 2 steps.
float spline(int distance)
{
    return distance == 0 ? 0.375 : distance == 1 ? 0.25 : 0.0625;
}

// Relative error of a depth: a few roundings each of the ray, its hit and the sum over samples,
// 16 * 2^-24 together.
const float DEPTH_ROUNDING = 9.5367431640625e-7;

// BT.709, of what the filter weighs by. Its square times any number of samples stays finite: what
// is brighter counts as that bright.
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

// Equation (4). The environment has no normal: by `least`, 1, it is like everything, and its depth
// distinguishes it from surfaces.
float normal_weight(vec3 a, vec3 b, float least)
{
    float weight = max(dot(a, b), least);
    for (uint i = 0u; i < NORMAL_SQUARINGS; i++)
        weight *= weight;
    return weight;
}

// The place of a surface's depth: its change to the next pixel in x and y, and how far the mean of
// jittered samples may be from the depth in the pixel's middle.
struct depth_plane {
    vec4 guide;
    vec2 slope;
    float jitter;
    float rounding;
    float least_normal;
};

// `length_change`: ray_length_change().
depth_plane make_plane(vec4 guide, vec2 slope, float length_change)
{
    bool sky = is_sky(guide);
    float jitter = abs(slope.x) + abs(slope.y) + length_change * guide.w;
    // Depths of surfaces are normal numbers, those of the sky are 0: any tolerance tells them
    // apart.
    return depth_plane(guide, slope, sky ? 1e-37 : jitter, DEPTH_ROUNDING * guide.w,
                       sky ? 1.0 : 0.0);
}

// Returns the similarity of the surfaces of two pixels. The exponent is that of equation (3), but
// for a deviation from the plane rather than from the depth: on a slope seen at a grazing angle the
// filter reaches as far as on one that faces the camera. `further`: other terms of the exponent. 0
// for pixels without samples, and for dissimilar ones.
float surface_weight(depth_plane plane, vec4 other, vec2 offset, float further)
{
    float expected = dot(plane.slope, offset);
    float reach = 1.0 + abs(offset.x) + abs(offset.y);
    float tolerance = abs(expected) + plane.jitter + reach * plane.rounding;
    float deviation = abs(other.w - plane.guide.w - expected);
    return normal_weight(plane.guide.xyz, other.xyz, plane.least_normal) *
           exp(-(deviation / tolerance + further));
}

// Returns the factor of a difference of luminances in the exponent of equation (5). Without
// variance no difference is small.
float luminance_scale(float variance)
{
    return variance > 0.0 ? 1.0 / (SIGMA_LUMINANCE * sqrt(variance)) : 3.0e38;
}

// The mix lambda f + (1 - lambda) p of an estimate f that is biased by b, and of one without bias, of
// variance V, has the error lambda^2 b^2 + (1 - lambda)^2 V: least with lambda = V / (V + b^2), and
// there below both. `bias` is b^2, or less than 0 where chance explains it.
float best_part(float variance, float bias)
{
    return bias > 0.0 ? variance / (variance + bias) : 1.0;
}

#endif
