// One thread turns one pixel of the film into what the filter works on: light without the colours of
// surfaces, what its half-buffers say of the variance, and the first surface as guide.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "shared/aov.h"
#include "lib/denoise.glsl"
#include "lib/denoise_view.glsl"
#include "lib/denoise_weights.glsl"

layout(constant_id = DENOISE_CONSTANT_AOVS) const uint AOVS = 0u;

layout(std430, set = 0, binding = DENOISE_FILM) readonly buffer film_block {
    uvec4 film_words[]; // gpu_film_pixel, and see shared/aov.h
};
DENOISE_WRITE(guides, DENOISE_GUIDES)
DENOISE_WRITE(to, DENOISE_TO)
DENOISE_WRITE(modulation, DENOISE_MODULATION)
DENOISE_WRITE(picture, DENOISE_PICTURE)

const uint SUM_WORDS = AOV_SUM_WORDS(AOVS);

// What a surface without a colour of its own still reflects, at right angles and with an index of
// refraction of 1.5: ((1.5 - 1) / (1.5 + 1))^2 (Fresnel). A divisor below would blow up what is
// reflected above dark paint, and smear it over brighter paint beside it.
const float LEAST_ALBEDO = 0.04;

float aov_mean(uint at, uint place, float samples)
{
    uint sum = at + FILM_WORDS + (place >> 2u);
    uint lost = sum + SUM_WORDS;
    return (uintBitsToFloat(film_words[sum][place & 3u]) -
            uintBitsToFloat(film_words[lost][place & 3u])) / samples;
}

vec3 aov_vector(uint at, uint place, float samples)
{
    return vec3(aov_mean(at, place, samples), aov_mean(at, place + 1u, samples),
                aov_mean(at, place + 2u, samples));
}

vec3 half_sum(uint at, uint words)
{
    return uintBitsToFloat(film_words[at + words].xyz) -
           uintBitsToFloat(film_words[at + words + 1u].xyz);
}

// As lib/halves.glsl.
uint samples_of_first_half(uint samples)
{
    return denoise.halves == HALVES_CONTIGUOUS ? min(samples, denoise.first_half)
                                               : samples - samples / 2u;
}

vec4 make_guide(uint at, float samples, float alpha, uint pixel)
{
    if (alpha == 0.0)
        return vec4(0.0);
    vec2 middle = vec2(pixel % denoise.now.width, pixel / denoise.now.width) + 0.5;
    float t = aov_mean(at, AOV_SCALAR_AT(AOVS, AOV_DEPTH), samples) / alpha;
    vec3 normal = aov_vector(at, AOV_VECTOR_AT(AOVS, AOV_NORMAL), samples);
    float squared = dot(normal, normal);
    // Normals of several samples may cancel: such a pixel faces the camera.
    view_ray ray = ray_through(denoise.now, middle);
    normal = squared > 0.0 ? normal * inversesqrt(squared) : -ray.direction;
    return vec4(normal, guide_depth(denoise.now, t, ray.cosine));
}

// Luminances' sum of squared deviations between the halves, whose expectation is the variance of one
// sample (Chan, Golub and LeVeque 1983, equation 2.1b).
float halves_deviation(uint at, float a, float b, vec3 divisor)
{
    float difference = luminance(half_sum(at, 0u) / (a * divisor)) -
                       luminance(half_sum(at, 2u) / (b * divisor));
    return difference * difference * (a * b / (a + b));
}

void main()
{
    uint item = (push.first_group + gl_WorkGroupID.x) * DENOISE_WORKGROUP + gl_LocalInvocationIndex;
    if (item >= push.pixel_count)
        return;
    uint pixel = push.first_pixel + item;
    uint at = item * AOV_FILM_WORDS(AOVS);
    uint samples = film_words[at].w;
    if (samples == 0u) {
        guides_words[pixel] = vec4(0.0, 0.0, 0.0, DENOISE_EMPTY);
        to_words[pixel] = vec4(0.0);
        modulation_words[pixel] = vec4(1.0);
        picture_words[pixel] = vec4(0.0);
        return;
    }
    float n = float(samples);
    vec3 mean = (half_sum(at, 0u) + half_sum(at, 2u)) / n;
    float alpha = aov_mean(at, AOV_SCALAR_AT(AOVS, AOV_ALPHA), n);
    vec3 albedo = aov_vector(at, AOV_VECTOR_AT(AOVS, AOV_ALBEDO), n);
    // Samples that meet nothing have an albedo of 0, but their light was reflected by nothing.
    vec3 divisor = max(albedo + (1.0 - alpha), vec3(LEAST_ALBEDO));
    float first = float(samples_of_first_half(samples));
    bool both = first > 0.0 && first < n;
    guides_words[pixel] = make_guide(at, n, alpha, pixel);
    to_words[pixel] =
        vec4(mean / divisor, both ? halves_deviation(at, first, n - first, divisor) : 0.0);
    modulation_words[pixel] = vec4(divisor, both ? 1.0 : 0.0);
    picture_words[pixel] = vec4(mean, n);
}
