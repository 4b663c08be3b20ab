// One thread turns one pixel of the film into the means of its two half-buffers, and of its AOVs.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/film_sums.glsl"
#include "lib/halves.glsl"
#include "lib/queue.glsl"

layout(std430, set = 0, binding = BINDING_FILM) readonly buffer film_block {
    uvec4 film_words[]; // gpu_film_pixel, and see shared/aov.h
};
layout(std430, set = 0, binding = BINDING_RESOLVED) writeonly buffer resolved_block {
    uvec4 resolved_words[]; // gpu_resolved_pixel, and see shared/aov.h
};

const uint SUM_WORDS = AOV_SUM_WORDS(AOVS);

// The mean of the compensated sum in words `sum` and `lost` of the film. w has no meaning.
vec4 mean(uint sum, uint lost, uint samples)
{
    vec4 exact = uintBitsToFloat(film_words[sum]) - uintBitsToFloat(film_words[lost]);
    return samples > 0u ? exact / float(samples) : vec4(0.0);
}

void main()
{
    uint item = item_index();
    if (item >= min(push.pixel_count, push.first_item + push.part_items))
        return;
    uint at = (push.first_pixel - push.film_first_pixel + item) * AOV_FILM_WORDS(AOVS);
    uint to = item * AOV_RESOLVED_WORDS(AOVS);
    uint samples = film_words[at].w;
    uint dropped = film_words[at + 1u].w;
    uint samples_a = samples_of_first_half(samples);
    uint samples_b = samples - samples_a;
    vec3 mean_a = mean(at, at + 1u, samples_a).rgb;
    vec3 mean_b = mean(at + 2u, at + 3u, samples_b).rgb;
    if (ACCUMULATION == ACCUMULATION_RUNNING) {
        vec2 factors = sum_factors(film_words[at + 2u].w, samples);
        mean_a *= factors.x;
        mean_b *= factors.y;
    }
    resolved_words[to] = uvec4(floatBitsToUint(mean_a), samples);
    resolved_words[to + 1u] = uvec4(floatBitsToUint(mean_b), dropped);
    if (HAS_AOV(AOVS_SUMMED)) {
        uint sums = at + FILM_WORDS;
        for (uint word = 0u; word < SUM_WORDS; word++)
            resolved_words[to + RESOLVED_WORDS + word] =
                floatBitsToUint(mean(sums + word, sums + SUM_WORDS + word, samples));
    }
    for (uint number = 0u; number < AOV_CLASSES(AOVS); number++) {
        uint word = at + AOV_FILM_CLASSES_AT(AOVS) + 4u * number;
        uint mean_of_class = to + AOV_RESOLVED_CLASSES_AT(AOVS) + number;
        resolved_words[mean_of_class] = floatBitsToUint(mean(word, word + 1u, samples_a));
        resolved_words[mean_of_class + AOV_CLASSES(AOVS)] =
            floatBitsToUint(mean(word + 2u, word + 3u, samples_b));
    }
    for (uint i = 0u; i < 2u * AOV_HAS_CLASSES(AOVS); i++)
        resolved_words[to + AOV_RESOLVED_BRIGHTEST_AT(AOVS) + i] =
            film_words[at + AOV_FILM_BRIGHTEST_AT(AOVS) + i];
    if (HAS_AOV(AOV_IDS))
        resolved_words[to + AOV_RESOLVED_WORDS(AOVS) - 1u] =
            film_words[at + AOV_FILM_WORDS(AOVS) - 1u];
}
