// One thread filters one pixel by one level of the edge-avoiding a-trous wavelet (Dammertz, Sewtz,
// Hanika and Lensch 2010) with the weights of Schied et al. 2017, section 4.4.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/denoise.glsl"
#include "lib/denoise_view.glsl"
#include "lib/denoise_weights.glsl"

layout(constant_id = DENOISE_CONSTANT_WAVELET) const uint WAVELET = DENOISE_WAVELET_LEVEL;

DENOISE_READ(guides, DENOISE_GUIDES)
DENOISE_READ(blended, DENOISE_BLENDED)
DENOISE_READ(records, DENOISE_RECORDS)
DENOISE_READ(from, DENOISE_FROM)
DENOISE_WRITE(to, DENOISE_TO)

void add_variance(inout vec2 sum, ivec2 pixel, ivec2 offset)
{
    bool inside;
    float variance = load_from(neighbour_index(pixel, offset, inside)).w;
    float weight = (offset.x == 0 ? 0.5 : 0.25) * (offset.y == 0 ? 0.5 : 0.25);
    sum += inside ? weight * vec2(variance, 1.0) : vec2(0.0);
}

// Variances are noisy themselves; a Gaussian over 3 x 3 pixels makes the weights less noisy.
float smooth_variance(ivec2 pixel)
{
    vec2 sum = vec2(0.0);
#define ADD_VARIANCE(x, y) add_variance(sum, pixel, ivec2(x, y));
    DENOISE_SQUARE_3(ADD_VARIANCE)
    return sum.x / sum.y;
}

// The pixel that is being filtered.
struct middle_pixel {
    ivec2 at;
    vec3 light;
    float luminance, luminance_scale;
    depth_plane plane;
};

// The sums of equation (1) and of the variance of a weighted mean.
struct filtered {
    vec3 change; // difference from the middle pixel's light, so that constant light keeps its bits
    float variance, weights;
};

void add_tap(inout filtered sum, middle_pixel middle, ivec2 tap)
{
    bool inside;
    ivec2 offset = int(push.step) * tap;
    uint index = neighbour_index(middle.at, offset, inside);
    vec4 light = load_from(index);
    float unlike = abs(luminance(light.rgb) - middle.luminance) * middle.luminance_scale;
    float weight = surface_weight(middle.plane, load_guides(index), vec2(offset), unlike);
    weight = tap == ivec2(0) ? 1.0 : inside ? weight : 0.0;
    weight *= spline(abs(tap.x)) * spline(abs(tap.y));
    sum.change += weight * (light.rgb - middle.light);
    sum.variance += weight * weight * light.w;
    sum.weights += weight;
}

// Packs the numbers by which the last pass judges the filter, 16 bits each: the squared difference
// that the filter has made, and the pixel's own variance if it is known. Both are relative to the
// light, so that a bright pixel does not dominate the dark ones around it.
uint pack_judgement(uint index, vec4 record, float light)
{
    vec4 before = load_blended(index);
    bool known = record.w > 0.0 && before.w > 0.0 && light > 0.0;
    float moved = known ? (light - luminance(before.rgb)) / light : 0.0;
    float variance = known ? record.z / (record.w * before.w) / (light * light) : 0.0;
    return (floatBitsToUint(moved * moved) & 0xffff0000u) | floatBitsToUint(variance) >> 16u;
}

void main()
{
    uvec2 pixel;
    if (!find_pixel(pixel))
        return;
    uint index = pixel_index(pixel);
    vec3 before = load_from(index).rgb;
    vec4 guide = load_guides(index);
    vec4 record = load_records(index);
    depth_plane plane =
        make_plane(guide, record.xy, ray_length_change(denoise.now, vec2(pixel) + 0.5));
    float scale = WAVELET == DENOISE_WAVELET_LINEAR
                      ? 0.0
                      : luminance_scale(smooth_variance(ivec2(pixel)));
    middle_pixel middle = middle_pixel(ivec2(pixel), before, luminance(before), scale, plane);
    filtered sum = filtered(vec3(0.0), 0.0, 0.0);
#define ADD_TAP(x, y) add_tap(sum, middle, ivec2(x, y));
    DENOISE_SQUARE_5(ADD_TAP)
    vec3 light = is_empty(guide) ? before : before + sum.change / sum.weights;
    float variance = sum.variance / (sum.weights * sum.weights);
    uint last = WAVELET == DENOISE_WAVELET_LAST ? pack_judgement(index, record, luminance(light))
                           : floatBitsToUint(variance);
    to_words[index] = uvec4(floatBitsToUint(light), last);
}
