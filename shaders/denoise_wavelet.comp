// One thread filters one pixel by one level of the edge-avoiding a-trous wavelet (Dammertz, Sewtz,
// Hanika and Lensch 2010) with the weights of Schied et al. 2017, section 4.4.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/denoise.glsl"
#include "lib/denoise_view.glsl"
#include "lib/denoise_weights.glsl"

layout(constant_id = DENOISE_CONSTANT_LAST) const uint LAST = 0u;

DENOISE_READ(guides, DENOISE_GUIDES)
DENOISE_READ(blended, DENOISE_BLENDED)
DENOISE_READ(records, DENOISE_RECORDS)
DENOISE_READ(from, DENOISE_FROM)
DENOISE_WRITE(to, DENOISE_TO)

// The B3 spline of a distance of 0, 1 or 2 steps.
float spline(int distance)
{
    return distance == 0 ? 0.375 : distance == 1 ? 0.25 : 0.0625;
}

// Variances are noisy themselves: a Gaussian of 3 x 3 pixels makes the weights steady.
float smooth_variance(ivec2 pixel)
{
    vec2 sum = vec2(0.0);
    for (int y = -1; y <= 1; y++)
        for (int x = -1; x <= 1; x++) {
            ivec2 at = pixel + ivec2(x, y);
            bool inside = is_inside(at);
            float weight = inside ? (x == 0 ? 0.5 : 0.25) * (y == 0 ? 0.5 : 0.25) : 0.0;
            sum += weight * vec2(load_from(pixel_index(uvec2(inside ? at : pixel))).w, 1.0);
        }
    return sum.x / sum.y;
}

// Of a filter that reads light and variance: equation (1), and the variance of a weighted mean.
struct filtered {
    vec3 change; // from the middle's light, so that what is even stays as it is to the last bit
    float variance, weights;
};

void add_tap(inout filtered sum, vec4 middle, vec4 light, float weight)
{
    sum.change += weight * (light.rgb - middle.rgb);
    sum.variance += weight * weight * light.w;
    sum.weights += weight;
}

filtered filter_level(ivec2 pixel, vec4 middle, depth_plane plane)
{
    filtered sum = filtered(vec3(0.0), 0.0, 0.0);
    float here = luminance(middle.rgb);
    float scale = luminance_scale(smooth_variance(pixel));
    int stride = int(push.step);
    for (int y = -2; y <= 2; y++)
        for (int x = -2; x <= 2; x++) {
            ivec2 offset = stride * ivec2(x, y);
            ivec2 at = pixel + offset;
            bool inside = is_inside(at);
            uint index = pixel_index(uvec2(inside ? at : pixel));
            vec4 guide = load_guides(index);
            vec4 light = load_from(index);
            float exponent = depth_exponent(plane, guide, vec2(offset)) +
                             abs(luminance(light.rgb) - here) * scale;
            float weight = normal_weight(plane.guide, guide) * exp(-exponent);
            bool own = x == 0 && y == 0;
            weight = own ? 1.0 : inside && !is_empty(guide) ? weight : 0.0;
            add_tap(sum, middle, light, spline(abs(x)) * spline(abs(y)) * weight);
        }
    return sum;
}

// What the last pass judges by, as two numbers of 16 bits: how far the filter moved the pixel, and
// what its own variance says, if it says anything.
float pack_judgement(uint index, vec4 record, float light)
{
    vec4 before = load_blended(index);
    float moved = light - luminance(before.rgb);
    bool known = record.w > 0.0 && before.w > 0.0;
    float variance = known ? record.z / (record.w * before.w) : 0.0;
    uint high = known ? floatBitsToUint(moved * moved) >> 16u : 0u;
    return uintBitsToFloat(high << 16u | floatBitsToUint(variance) >> 16u);
}

void main()
{
    uvec2 pixel;
    if (!find_pixel(pixel))
        return;
    uint index = pixel_index(pixel);
    vec4 middle = load_from(index);
    vec4 guide = load_guides(index);
    vec4 record = load_records(index);
    float jitter = abs(record.x) + abs(record.y) +
                   ray_length_change(denoise.now, vec2(pixel) + 0.5) * guide.w;
    filtered sum = filter_level(ivec2(pixel), middle, depth_plane(guide, record.xy, jitter));
    vec3 light = middle.rgb + sum.change / sum.weights;
    float variance = sum.variance / (sum.weights * sum.weights);
    if (is_empty(guide))
        light = middle.rgb;
    to_words[index] =
        vec4(light, LAST != 0u ? pack_judgement(index, record, luminance(light)) : variance);
}
