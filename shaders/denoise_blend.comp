// One thread mixes one pixel's light with what the history has of the same place: temporal
// reprojection (Schied et al. 2017, section 4.1). Also finds how the guide's depth changes.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/denoise.glsl"
#include "lib/denoise_view.glsl"
#include "lib/denoise_weights.glsl"

layout(constant_id = DENOISE_CONSTANT_HISTORY) const uint HISTORY = 0u;

DENOISE_READ(guides, DENOISE_GUIDES)
DENOISE_READ(guides_history, DENOISE_GUIDES_HISTORY)
DENOISE_READ(blended_history, DENOISE_BLENDED_HISTORY)
DENOISE_READ(records_history, DENOISE_RECORDS_HISTORY)
DENOISE_READ(from, DENOISE_FROM)
DENOISE_READ(modulation, DENOISE_MODULATION)
DENOISE_READ(picture, DENOISE_PICTURE)
DENOISE_READ(emission, DENOISE_EMISSION)
DENOISE_WRITE(blended, DENOISE_BLENDED)
DENOISE_WRITE(records, DENOISE_RECORDS)

// The most degrees of freedom that a variance may have: more would only keep what was long ago.
const float FREEDOM_MOST = 32.0;

// The smaller one of the changes to both sides, so that an edge beside the pixel is none of its
// surface's slope. Over two pixels: samples are jittered by up to half a pixel each, which over one
// could cancel the whole change.
float slope_along(ivec2 pixel, vec4 guide, ivec2 axis)
{
    float slope = 0.0;
    bool known = false;
    for (int side = -1; side <= 1; side += 2) {
        bool inside;
        vec4 other = load_guides(neighbour_index(pixel, 2 * side * axis, inside));
        bool usable = inside && !is_empty(other) && !is_sky(other);
        float change = 0.5 * float(side) * (other.w - guide.w);
        bool better = usable && (!known || abs(change) < abs(slope));
        slope = better ? change : slope;
        known = known || usable;
    }
    return slope;
}

// Emission is in the halves too, but not in the light that is filtered: where it differs from the
// next pixels' it may differ between the halves, by a variance of up to a quarter of the
// difference's square. Where that could be a part of the variance, they tell none.
const float EMISSION_PART = 0.1;

bool is_told_by_halves(ivec2 pixel, float variance)
{
    vec3 here = load_emission(pixel_index(uvec2(pixel))).rgb;
    vec3 divisor = load_modulation(pixel_index(uvec2(pixel))).rgb;
    float most = 0.0;
    for (int i = 0; i < 4; i++) {
        ivec2 offset = (i & 1) == 0 ? ivec2(i - 1, 0) : ivec2(0, i - 2);
        bool inside;
        vec3 beside = load_emission(neighbour_index(pixel, offset, inside)).rgb;
        most = max(most, luminance(abs(beside - here) / divisor));
    }
    return 0.25 * most * most <= EMISSION_PART * variance;
}

struct past {
    vec3 light;
    float samples, deviation, freedom;
    float part; // of the taps that fit
};

const past NO_PAST = past(vec3(0.0), 0.0, 0.0, 0.0, 0.0);

// A pixel of the history, where it may speak for the place `at` of its picture: the surface there
// has the same normal, and the depth that its own slope leads to. Returns its weight.
float past_weight(ivec2 tap, vec2 at, vec4 guide, float expected_depth, float tolerance)
{
    uint index = tap.y * denoise.history.width + tap.x;
    vec4 then = load_guides_history(index);
    vec4 record = load_records_history(index);
    vec2 away = at - (vec2(tap) + 0.5);
    float deviation = abs(then.w + dot(record.xy, away) - expected_depth);
    // Each is the mean of samples somewhere in their pixel.
    float allowed = abs(record.x) + abs(record.y) + tolerance;
    bool far = is_sky(guide);
    float alike = normal_weight(guide.xyz, then.xyz, far && is_sky(then) ? 1.0 : 0.0);
    bool same_place = far || deviation <= allowed;
    float bilinear = (1.0 - abs(away.x)) * (1.0 - abs(away.y));
    return !is_empty(then) && same_place ? bilinear * alike : 0.0;
}

// Bilinear, of those taps that fit; what is missing of them takes its share of the samples along.
past read_past(vec2 at, vec4 guide, float expected_depth, float tolerance)
{
    past sum = NO_PAST;
    ivec2 size = ivec2(denoise.history.width, denoise.history.height);
    ivec2 corner = ivec2(floor(at - 0.5));
    for (int i = 0; i < 4; i++) {
        ivec2 tap = corner + ivec2(i & 1, i >> 1);
        vec2 beside = at;
        if (denoise.history.kind == CAMERA_PANORAMIC && (tap.x < 0 || tap.x >= size.x)) {
            int around = tap.x < 0 ? size.x : -size.x;
            tap.x += around;
            beside.x += float(around);
        }
        bool inside = all(lessThan(uvec2(tap), uvec2(size)));
        tap = inside ? tap : ivec2(0);
        float weight = past_weight(tap, beside, guide, expected_depth, tolerance);
        uint index = tap.y * size.x + tap.x;
        vec4 light = load_blended_history(index);
        vec4 record = load_records_history(index);
        weight = inside && light.w > 0.0 ? weight : 0.0;
        sum.part += weight;
        sum.light += weight * light.rgb;
        sum.samples += weight * light.w;
        sum.deviation += weight * record.z;
        sum.freedom += weight * record.w;
    }
    if (!(sum.part > 0.0))
        return NO_PAST;
    sum.light /= sum.part;
    return sum;
}

past find_past(vec2 middle, vec4 guide, vec2 slope)
{
    if (HISTORY == 0u)
        return NO_PAST;
    view_ray ray = ray_through(denoise.now, middle);
    bool far = is_sky(guide);
    vec3 point = far ? ray.direction
                     : ray.origin + ray.direction * ray_depth(denoise.now, guide.w, ray.cosine);
    vec2 at;
    float expected_depth;
    bool seen = project(denoise.history, point, far, at, expected_depth);
    bool inside = seen && all(greaterThan(at, vec2(-1.0))) &&
                  all(lessThan(at, vec2(denoise.history.width, denoise.history.height) + 1.0));
    // The change of this pixel's depth, scaled to that of the history.
    float own = (abs(slope.x) + abs(slope.y)) / guide.w + ray_length_change(denoise.now, middle) +
                ray_length_change(denoise.history, at) + 2.0 * DEPTH_ROUNDING;
    if (!inside || is_empty(guide))
        return NO_PAST;
    return read_past(at, guide, expected_depth, far ? 0.0 : own * expected_depth);
}

void main()
{
    uvec2 pixel;
    if (!find_pixel(pixel))
        return;
    uint index = pixel_index(pixel);
    vec4 guide = load_guides(index);
    vec4 light = load_from(index);
    float samples = load_picture(index).w;
    vec2 slope = vec2(0.0);
    if (!is_empty(guide) && !is_sky(guide))
        slope = vec2(slope_along(ivec2(pixel), guide, ivec2(1, 0)),
                     slope_along(ivec2(pixel), guide, ivec2(0, 1)));
    float deviation = light.w;
    float freedom = load_modulation(index).w;
    if (!is_told_by_halves(ivec2(pixel), deviation))
        deviation = freedom = 0.0;

    past before = find_past(vec2(pixel) + 0.5, guide, slope);
    float fading = max(0.0, 1.0 - samples / DENOISE_FADE_SAMPLES);
    float worth = fading * min(before.samples, DENOISE_HISTORY_SAMPLES);
    if (worth > 0.0 && samples > 0.0) {
        float share = worth / (worth + samples);
        float difference = luminance(before.light) - luminance(light.rgb);
        light.rgb += share * (before.light - light.rgb);
        // Two means and what lies between them (Chan, Golub and LeVeque 1979). The history's is that
        // of all samples of the taps that fit, however few these are; what it tells counts as they
        // do. Otherwise an edge's pixel would take the fewness of its taps for a small variance.
        float whole = before.samples / before.part;
        deviation += before.deviation + before.part * difference * difference *
                                            (whole * samples / (whole + samples));
        freedom += before.freedom + before.part;
        samples = 1.0 / (share * share / before.samples + (1.0 - share) * (1.0 - share) / samples);
    }
    float kept = min(1.0, FREEDOM_MOST / max(freedom, 1.0));
    store_blended(index, vec4(light.rgb, samples));
    store_records(index, vec4(slope, kept * deviation, kept * freedom));
}
