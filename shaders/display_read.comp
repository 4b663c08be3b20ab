// One thread converts one pixel of a film chunk to a pixel of a linear image that has the quantity
// to be shown.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/display.glsl"
#include "lib/film_sums.glsl"

WORDS(film, DISPLAY_BINDING_FILM) // gpu_film_pixel and AOVs, see shared/aov.h
layout(std430, set = 0, binding = DISPLAY_BINDING_DENOISED) readonly buffer denoised_block {
    vec4 denoised[];
};
layout(std430, set = 0, binding = DISPLAY_BINDING_SOURCES) readonly buffer sources_block {
    uint sources[]; // the triangle after each dropped one; the first triangle of each instance and
                    // mesh; the scene's instance of each placed mesh
};
layout(std430, set = 0, binding = DISPLAY_BINDING_TO) writeonly buffer to_block {
    vec4 to_pixels[];
};

// Returns float number `place` of the AOVs' sums.
float aov_float(uint at, uint place)
{
    uint word = place >> 2u;
    uint digits = film_word(at + AOV_FILM_DIGITS_AT(AOVS) +
                            word / FILM_GROUPS_A_WORD)[word % FILM_GROUPS_A_WORD];
    return film_mean(film_word(at + FILM_WORDS + place), film_top_digit(digits, place & 3u), 1.0);
}

vec3 aov_vector(uint at, const uint aov)
{
    uint place = AOV_VECTOR_AT(AOVS, aov);
    return vec3(aov_float(at, place), aov_float(at, place + 1u), aov_float(at, place + 2u));
}

float aov_scalar(uint at, const uint aov)
{
    return aov_float(at, AOV_SCALAR_AT(AOVS, aov));
}

// lib/halves.glsl has this function for the kernels that render. That file cannot be included here,
// because it reads the uniform block of those kernels.
uint samples_of_first_half(uint samples)
{
    if (HALVES == HALVES_CONTIGUOUS)
        return min(samples, push.planned_samples - push.planned_samples / 2u);
    return samples - samples / 2u;
}

// Returns the sum of a half-buffer's radiance. factor: converts a running mean into a sum.
vec3 half_sum(uint first, uint digits, bool is_float, float factor)
{
    vec3 sum;
    for (uint c = 0u; c < 3u; c++) {
        uvec4 bins = film_word(first + c);
        sum[c] = is_float ? uintBitsToFloat(bins.x) * factor
                          : film_mean(bins, film_top_digit(digits, c), 1.0);
    }
    return sum;
}

// Returns the sums of both half-buffers' radiance.
void radiance_sums(uint at, out vec3 a, out vec3 b)
{
    uvec4 head = film_word(at);
    bool is_float = head.z == FILM_HAS_FLOATS;
    vec2 factors = film_sum_factors(head.w, head.x);
    a = half_sum(at + 1u, head.z, is_float, factors.x);
    b = half_sum(at + 1u + FILM_HALF_WORDS, head.w, is_float, factors.y);
}

// Returns in x the variance of the mean radiance, averaged over the channels, as in struct
// film_aovs; y: 0 if the variance is not known.
vec2 variance_of(uint at, float samples)
{
    float samples_a = float(samples_of_first_half(uint(samples)));
    float samples_b = samples - samples_a;
    if (samples_a == 0.0 || samples_b == 0.0)
        return vec2(0.0);
    vec3 a, b;
    radiance_sums(at, a, b);
    vec3 difference = a / samples_a - b / samples_b;
    vec3 variance = difference * difference * (samples_a / samples) * (samples_b / samples);
    return vec2((variance.r + variance.g + variance.b) / 3.0, 1.0);
}

// Returns how many of `count` ascending numbers, which begin at index `first`, are at most `value`.
uint count_up_to(uint first, uint count, uint value)
{
    uint low = 0u;
    while (low < count) {
        uint middle = low + (count - low) / 2u;
        if (sources[first + middle] <= value)
            low = middle + 1u;
        else
            count = middle;
    }
    return low;
}

// Returns the object's index plus 1, as in struct film_aovs.ids; 0: nothing was hit.
uint object_of(uvec4 ids)
{
    if (ids.x == 0u)
        return 0u;
    if ((ids.x - 1u & PRIMITIVE_SHAPE) != 0u)
        return push.instances + (ids.x - 1u & ~PRIMITIVE_SHAPE) + 1u;
    uint runs = push.dropped;
    uint placed = runs + push.instances + push.meshes;
    if (ids.y != 0u)
        return sources[placed + ids.y - 1u] + 1u;
    uint source = ids.x - 1u;
    source += count_up_to(0u, push.dropped, source);
    return count_up_to(runs, push.instances + push.meshes, source);
}

// Returns a colour for a number from 1 on. Multiples of the golden ratio are far apart on the
// circle of hues (Knuth 1973, section 6.4); a hash varies saturation and value.
vec3 color_of_number(uint number)
{
    uint hash = number * 2654435769u; // 2^32 / golden ratio
    uint mixed = (hash ^ hash >> 15u) * 2246822519u; // the second prime of Collet's xxHash
    float hue = float(hash >> 8u) * 5.9604644775390625e-8 * 6.0; // in [0, 6)
    float value = 0.6 + 0.4 * float(mixed >> 24u) / 255.0;
    float saturation = 0.45 + 0.4 * float(mixed >> 16u & 255u) / 255.0;
    vec3 pure = clamp(abs(mod(hue + vec3(0.0, 4.0, 2.0), 6.0) - 3.0) - 1.0, 0.0, 1.0);
    return value * mix(vec3(1.0), pure, saturation);
}

vec3 color_of_id(uint number)
{
    return number == 0u ? vec3(0.0) : color_of_number(number);
}

vec4 shown_value(uint at, float samples)
{
    if (SHOWN == SHOWN_ALBEDO)
        return vec4(aov_vector(at, AOV_ALBEDO) / samples, 1.0);
    if (SHOWN == SHOWN_NORMAL) // black where nothing was hit
        return vec4(0.5 * (aov_vector(at, AOV_NORMAL) + aov_scalar(at, AOV_ALPHA)) / samples, 1.0);
    if (SHOWN == SHOWN_DEPTH)
        return vec4(vec3(aov_scalar(at, AOV_DEPTH), aov_scalar(at, AOV_ALPHA), 0.0) / samples, 1.0);
    if (SHOWN == SHOWN_OBJECTS || SHOWN == SHOWN_MATERIALS) {
        uvec4 ids = film_word(at + AOV_FILM_WORDS(AOVS) - 1u);
        return vec4(color_of_id(SHOWN == SHOWN_OBJECTS ? object_of(ids) : ids.z), 1.0);
    }
    if (SHOWN == SHOWN_SAMPLES)
        return vec4(samples, 1.0, 0.0, 1.0);
    if (SHOWN == SHOWN_STEPS)
        return vec4(aov_scalar(at, AOV_STEPS) / samples, 1.0, 0.0, 1.0);
    if (SHOWN == SHOWN_VARIANCE)
        return vec4(variance_of(at, samples), 0.0, 1.0);
    if (SHOWN == SHOWN_EMISSION)
        return vec4(aov_vector(at, AOV_EMISSION) / samples, 1.0);
    if (SHOWN == SHOWN_DIRECT)
        return vec4(aov_vector(at, AOV_DIRECT) / samples, 1.0);
    if (SHOWN == SHOWN_INDIRECT)
        return vec4(aov_vector(at, AOV_INDIRECT) / samples, 1.0);
    vec3 a, b;
    radiance_sums(at, a, b);
    return vec4((a + b) / samples, 1.0);
}

void main()
{
    uint item = item_index();
    if (item >= push.items)
        return;
    if (HAS_FLAG(DISPLAY_DENOISED)) {
        vec4 value = denoised[push.first_pixel + item];
        to_pixels[item] = value.w > 0.0 ? vec4(value.rgb, 1.0) : vec4(0.0);
        return;
    }
    uint at = item * AOV_FILM_WORDS(AOVS);
    uint samples = film_word(at).x;
    to_pixels[item] = samples > 0u ? shown_value(at, float(samples)) : vec4(0.0);
}
