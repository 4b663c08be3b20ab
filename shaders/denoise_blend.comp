// One thread mixes the light of one pixel with the history of the same surface point: temporal
// reprojection (Schied et al. 2017, section 4.1), including objects that have moved. Also finds the
// slope of the guide's depth. DENOISE_HISTORY_* selects the mode of the run.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/denoise.glsl"
#include "lib/denoise_view.glsl"
#include "lib/denoise_weights.glsl"

layout(constant_id = DENOISE_CONSTANT_HISTORY) const uint HISTORY = DENOISE_HISTORY_NONE;

DENOISE_READ(guides, DENOISE_GUIDES)
DENOISE_READ(guides_history, DENOISE_GUIDES_HISTORY)
DENOISE_READ(blended_history, DENOISE_BLENDED_HISTORY)
DENOISE_READ(records_history, DENOISE_RECORDS_HISTORY)
DENOISE_READ(from, DENOISE_FROM)
DENOISE_READ(modulation, DENOISE_MODULATION)
DENOISE_READ(picture, DENOISE_PICTURE)
DENOISE_READ(emission, DENOISE_EMISSION)
DENOISE_READ(difference, DENOISE_TO)
DENOISE_WRITE(compared, DENOISE_TO) // read as `difference` by the next run
DENOISE_WRITE(blended, DENOISE_BLENDED)
DENOISE_WRITE(records, DENOISE_RECORDS)

// The maximum number of degrees of freedom of a variance: more would give old frames too much
// weight.
const float FREEDOM_MOST = 32.0;

// The slope along an axis: the smaller of the depth changes on both sides, so that an edge beside
// the pixel does not count as slope. Changes are measured over two pixels, because each sample is
// jittered by up to half a pixel, which could cancel the whole change over one pixel.
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

// The half-buffers contain emission, but the filtered light does not. If a pixel's emission differs
// from that of its neighbours, it may also differ between the halves, with a variance of up to a
// quarter of the squared difference. If that variance could exceed this fraction of the estimated
// variance, the half-buffers are not used.
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
    float samples; // mean number of samples of the accepted taps
    float part;    // sum of the accepted taps' weights
    float same;    // this pixel's share of `part` if the random numbers repeat, else 0
    float squares; // sum of the squares of the weights, which are scaled to the sum 1
    float deviation, freedom;
};

const past NO_PAST = past(vec3(0.0), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);

// Returns the weight of pixel `tap` of the history for the reprojected position `at`. It is 0
// unless the surface in that pixel has a similar normal and the depth that its own slope predicts.
float past_weight(ivec2 tap, vec2 at, vec4 guide, float expected_depth, float tolerance)
{
    uint index = tap.y * denoise.history.width + tap.x;
    vec4 then = load_guides_history(index);
    vec4 record = load_records_history(index);
    vec2 away = at - (vec2(tap) + 0.5);
    float deviation = abs(then.w + dot(record.xy, away) - expected_depth);
    // Both depths are means over samples anywhere in their pixels.
    float allowed = abs(record.x) + abs(record.y) + tolerance;
    bool far = is_sky(guide);
    float alike = normal_weight(guide.xyz, then.xyz, far && is_sky(then) ? 1.0 : 0.0);
    bool same_place = far || deviation <= allowed;
    float bilinear = (1.0 - abs(away.x)) * (1.0 - abs(away.y));
    return !is_empty(then) && same_place ? bilinear * alike : 0.0;
}

// Interpolates the history bilinearly, over the accepted taps.
past read_past(vec2 at, ivec2 pixel, vec4 guide, float expected_depth, float tolerance)
{
    past sum = NO_PAST;
    ivec2 size = ivec2(denoise.history.width, denoise.history.height);
    bool repeats =
        denoise.repeats != 0u && size == ivec2(denoise.now.width, denoise.now.height);
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
        sum.same += repeats && tap == pixel ? weight : 0.0;
        sum.squares += weight * weight;
        sum.light += weight * light.rgb;
        sum.samples += weight * light.w;
        sum.deviation += weight * record.z;
        sum.freedom += weight * record.w;
    }
    if (!(sum.part > 0.0))
        return NO_PAST;
    sum.light /= sum.part;
    sum.samples /= sum.part;
    sum.same /= sum.part;
    sum.squares /= sum.part * sum.part;
    return sum;
}

// Moves a point and a normal to their places in the previous frame. Normals are transformed by the
// cofactor matrix, which is the inverse transpose up to a factor.
void move_back(gpu_denoise_motion motion, inout vec3 point, inout vec3 normal)
{
    vec3 at = vec3(motion.past_x_at, motion.past_y_at, motion.past_z_at);
    point = at + vec3(dot(motion.past_x, point), dot(motion.past_y, point),
                      dot(motion.past_z, point));
    normal = normalize(vec3(dot(cross(motion.past_y, motion.past_z), normal),
                            dot(cross(motion.past_z, motion.past_x), normal),
                            dot(cross(motion.past_x, motion.past_y), normal)));
}

past find_past(ivec2 pixel, vec4 guide, vec2 slope, uint motion)
{
    vec2 middle = vec2(pixel) + 0.5;
    if (HISTORY == DENOISE_HISTORY_NONE || is_empty(guide))
        return NO_PAST;
    view_ray ray = ray_through(denoise.now, middle);
    bool far = is_sky(guide);
    vec3 point = far ? ray.direction
                     : ray.origin + ray.direction * ray_depth(denoise.now, guide.w, ray.cosine);
    if (HISTORY != DENOISE_HISTORY_MIXED && motion > 0u && !far)
        move_back(denoise.motions[motion - 1u], point, guide.xyz);
    vec2 at;
    float expected_depth;
    bool seen = project(denoise.history, point, far, at, expected_depth);
    bool inside = seen && all(greaterThan(at, vec2(-1.0))) &&
                  all(lessThan(at, vec2(denoise.history.width, denoise.history.height) + 1.0));
    // The relative change of depth within this pixel, including rounding errors.
    float own = (abs(slope.x) + abs(slope.y)) / guide.w + ray_length_change(denoise.now, middle) +
                ray_length_change(denoise.history, at) + 2.0 * DEPTH_ROUNDING;
    if (!inside)
        return NO_PAST;
    return read_past(at, pixel, guide, expected_depth, far ? 0.0 : own * expected_depth);
}

// The relative rounding error of light, equal to that of depths.
const float LIGHT_ROUNDING = DEPTH_ROUNDING;

// The factor by which sums of squared weights overestimate the number of averaged pixels. Two
// levels of the wavelet reduce the variance as the mean of 65.6 pixels does. The sums give 178.9,
// because each level assumes that its input pixels are independent.
const float PIXELS_TOLD = 178.9 / 65.6;
// The minimum number of pixels from which the history's bias is estimated.
const float PIXELS_LEAST = 4.0;

// The minimum number of samples of a history that is compared with the film. Schied et al. 2017
// ignore the moments of fewer frames (section 4.2); here, too, fewer samples would not show whether
// a difference is noise.
const float SAMPLES_LEAST = 4.0;

// Returns the factor, 0 to 1, by which the weight of the history is reduced because light and
// shadow may have moved. The mean difference between film and history over the surrounding pixels
// is the bias of the history, plus noise, whose variance follows from the squared differences. The
// result is 0 if hardly any of the surrounding pixels have a history, as at an edge.
float history_trust(uint index)
{
    vec4 means = load_difference(index); // means of the difference, of its square, and of 1 where
                                         // film and history are known; sum of the squared weights
    float count = means.z * means.z / (PIXELS_TOLD * means.w);
    if (!(count >= PIXELS_LEAST))
        return 0.0;
    float bias = means.x / means.z;
    float variance = means.y / (means.z * count);
    return best_part(variance, bias * bias - variance);
}

// Returns the variance of the difference between the means of the history and of the film, as a
// multiple of the variance of one sample. `overlap` is the covariance of the two means, also as a
// multiple of that variance. It is not 0 if both means use the same random numbers for the same
// pixel, because the smaller set of samples is then a subset of the larger one.
float new_part(past before, float samples, float overlap)
{
    return 1.0 / samples + before.squares / before.samples - 2.0 * overlap;
}

// The square of the accuracy of positions in the history, which is a thousandth of a pixel. A
// smaller result of new_part() is rounding error.
const float PLACE_ROUNDING = 1e-6;

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

    vec4 emission = load_emission(index);
    past before = find_past(ivec2(pixel), guide, slope, uint(emission.w));
    float difference = luminance(before.light) - luminance(light.rgb);
    if (HISTORY == DENOISE_HISTORY_COMPARED) {
        float rounding = LIGHT_ROUNDING * luminance(light.rgb);
        bool known = before.part > 0.0 && samples > 0.0;
        float squared = difference * difference + rounding * rounding;
        store_compared(index, known ? vec4(difference, squared, 1.0, 1.0) : vec4(0.0));
        store_records(index, vec4(slope, 0.0, 0.0));
        return;
    }
    float trust = 1.0;
    if (HISTORY == DENOISE_HISTORY_CHECKED)
        trust = before.samples >= SAMPLES_LEAST ? history_trust(index) : 0.0;
    float fading = max(0.0, 1.0 - samples / DENOISE_FADE_SAMPLES);
    float held = before.part * before.samples;
    float worth = fading * min(held, DENOISE_HISTORY_SAMPLES);
    // If the scene has changed, the film's samples replace those of the history with the same
    // random numbers.
    if (HISTORY == DENOISE_HISTORY_CHECKED)
        worth = fading * clamp(held - before.same * samples, 0.0, DENOISE_HISTORY_SAMPLES);
    if (worth > 0.0 && samples > 0.0) {
        float share = trust * worth / (worth + samples);
        light.rgb += share * (before.light - light.rgb);
        // Combines two means and their squared deviations (Chan, Golub and LeVeque 1979). The
        // history's mean is over all samples of the accepted taps; their number is scaled by the
        // weight of these taps. Otherwise a pixel at an edge would have a small variance only
        // because it has few taps.
        float told = trust * before.part;
        float both = before.samples * samples / (before.samples + samples);
        float overlap = before.same / max(before.samples, samples);
        float new_freedom = new_part(before, samples, overlap) * both;
        if (new_freedom > PLACE_ROUNDING) {
            deviation += told * both * difference * difference;
            freedom += told * new_freedom;
        }
        deviation += trust * before.deviation;
        freedom += trust * before.freedom;
        samples = 1.0 / (share * share / held + 2.0 * share * (1.0 - share) * overlap +
                         (1.0 - share) * (1.0 - share) / samples);
    }
    float kept = min(1.0, FREEDOM_MOST / max(freedom, 1.0));
    store_blended(index, vec4(light.rgb, samples));
    store_records(index, vec4(slope, kept * deviation, kept * freedom));
}
