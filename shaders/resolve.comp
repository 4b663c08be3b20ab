// One thread converts one pixel of the film into the means of its two half-buffers and of its AOVs.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/film_sums.glsl"
#include "lib/halves.glsl"
#include "lib/queue.glsl"

layout(std430, set = 0, binding = BINDING_FILM) readonly buffer film_block {
    uvec4 film_words[]; // gpu_film_pixel and AOVs, see shared/aov.h
};
layout(std430, set = 0, binding = BINDING_RESOLVED) writeonly buffer resolved_block {
    uvec4 resolved_words[]; // gpu_resolved_pixel and AOVs, see shared/aov.h
};

const uint SUM_WORDS = AOV_SUM_WORDS(AOVS);

// Returns the mean of a half of gpu_film_pixel, or of a class; `at` is its first word.
vec3 mean_of_bins(uint at, uint number, uint samples)
{
    uint digits = film_words[at][2u + number], sums = at + 1u + FILM_HALF_WORDS * number;
    vec3 mean = vec3(0.0);
    for (uint c = 0u; c < 3u && samples > 0u; c++)
        mean[c] = film_mean(film_words[sums + c], film_top_digit(digits, c), float(samples));
    return mean;
}

// Returns the mean of a film that keeps floats. factor: converts its values to sums.
vec3 mean_of_floats(uint at, uint number, uint samples, float factor)
{
    uint sums = at + 1u + FILM_HALF_WORDS * number;
    vec3 kept = uintBitsToFloat(
        uvec3(film_words[sums].x, film_words[sums + 1u].x, film_words[sums + 2u].x));
    return samples > 0u ? kept / float(samples) * factor : vec3(0.0);
}

// Returns the means of components 4 * word to 4 * word + 3 of the AOVs.
vec4 mean_of_group(uint at, uint word, uint samples)
{
    uint group = at + AOV_FILM_DIGITS_AT(AOVS) + word / FILM_GROUPS_A_WORD;
    uint digits = film_words[group][word % FILM_GROUPS_A_WORD];
    vec4 mean = vec4(0.0);
    for (uint c = 0u; c < 4u && samples > 0u; c++)
        mean[c] = film_mean(film_words[at + FILM_WORDS + 4u * word + c],
                            film_top_digit(digits, c), float(samples));
    return mean;
}

void main()
{
    uint item = item_index();
    if (item >= min(push.pixel_count, push.first_item + push.part_items))
        return;
    uint at = (push.first_pixel - push.film_first_pixel + item) * AOV_FILM_WORDS(AOVS);
    uint to = item * AOV_RESOLVED_WORDS(AOVS);
    uint samples = film_words[at].x;
    uint dropped = film_words[at].y;
    uint samples_a = samples_of_first_half(samples);
    uint samples_b = samples - samples_a;
    vec3 mean_a, mean_b;
    if (ACCUMULATION == ACCUMULATION_BINNED) {
        mean_a = mean_of_bins(at, 0u, samples_a);
        mean_b = mean_of_bins(at, 1u, samples_b);
    } else {
        vec2 factors = vec2(1.0);
        if (ACCUMULATION == ACCUMULATION_RUNNING)
            factors = film_sum_factors(film_words[at].w, samples);
        mean_a = mean_of_floats(at, 0u, samples_a, factors.x);
        mean_b = mean_of_floats(at, 1u, samples_b, factors.y);
    }
    resolved_words[to] = uvec4(floatBitsToUint(mean_a), samples);
    resolved_words[to + 1u] = uvec4(floatBitsToUint(mean_b), dropped);
    if (HAS_AOV(AOVS_SUMMED)) {
        for (uint word = 0u; word < SUM_WORDS; word++)
            resolved_words[to + RESOLVED_WORDS + word] =
                floatBitsToUint(mean_of_group(at, word, samples));
    }
    for (uint number = 0u; number < AOV_CLASSES(AOVS); number++) {
        uint class_at = at + AOV_FILM_CLASSES_AT(AOVS) + FILM_WORDS * number;
        uint mean_of_class = to + AOV_RESOLVED_CLASSES_AT(AOVS) + number;
        resolved_words[mean_of_class] =
            uvec4(floatBitsToUint(mean_of_bins(class_at, 0u, samples_a)), 0u);
        resolved_words[mean_of_class + AOV_CLASSES(AOVS)] =
            uvec4(floatBitsToUint(mean_of_bins(class_at, 1u, samples_b)), 0u);
    }
    for (uint i = 0u; i < 2u * AOV_HAS_CLASSES(AOVS); i++)
        resolved_words[to + AOV_RESOLVED_BRIGHTEST_AT(AOVS) + i] =
            film_words[at + AOV_FILM_BRIGHTEST_AT(AOVS) + i];
    if (HAS_AOV(AOV_IDS))
        resolved_words[to + AOV_RESOLVED_WORDS(AOVS) - 1u] =
            film_words[at + AOV_FILM_WORDS(AOVS) - 1u];
}
