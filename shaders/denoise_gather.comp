// One thread computes the filter's input for one pixel of the film: the reflected light divided by
// the surface's colour, the variance according to the half-buffers, and the first surface as guide.
// DENOISE_GATHER_* selects which of these are written.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "shared/aov.h"
#include "lib/denoise.glsl"
#include "lib/denoise_view.glsl"
#include "lib/denoise_weights.glsl"
#include "lib/film_sums.glsl"

layout(constant_id = DENOISE_CONSTANT_AOVS) const uint AOVS = 0u;
layout(constant_id = DENOISE_CONSTANT_GATHER) const uint GATHERED = DENOISE_GATHER_ALL;

layout(std430, set = 0, binding = DENOISE_FILM) readonly buffer film_block {
    uvec4 film_words[]; // gpu_film_pixel and AOVs, see shared/aov.h
};
DENOISE_WRITE(guides, DENOISE_GUIDES)
DENOISE_WRITE(to, DENOISE_TO)
DENOISE_WRITE(modulation, DENOISE_MODULATION)
DENOISE_WRITE(picture, DENOISE_PICTURE)
DENOISE_WRITE(emission, DENOISE_EMISSION)

const uint SUM_WORDS = AOV_SUM_WORDS(AOVS);

// The least albedo by which light is divided. A dielectric surface without colour, with an index of
// refraction of 1.5, still reflects ((1.5 - 1) / (1.5 + 1))^2 at normal incidence (Fresnel). A
// smaller divisor would amplify light reflected above dark paint, and the filter would spread it
// over brighter paint next to it.
const float LEAST_ALBEDO = 0.04;

// The means of all AOVs, which are read once.
float aov_means[4u * SUM_WORDS];

void read_aovs(uint at, float samples)
{
    for (uint word = 0u; word < SUM_WORDS; word++) {
        uint group = at + AOV_FILM_DIGITS_AT(AOVS) + word / FILM_GROUPS_A_WORD;
        uint digits = film_words[group][word % FILM_GROUPS_A_WORD];
        for (uint c = 0u; c < 4u; c++)
            aov_means[4u * word + c] = film_mean(film_words[at + FILM_WORDS + 4u * word + c],
                                                 film_top_digit(digits, c), samples);
    }
}

vec3 aov_vector(uint place)
{
    return vec3(aov_means[place], aov_means[place + 1u], aov_means[place + 2u]);
}

// Returns the sum of half-buffer 0 or 1.
vec3 half_sum(uint at, uint number)
{
    uvec4 head = film_words[at];
    float factor = film_sum_factors(head.w, head.x)[number];
    uint sums = at + 1u + FILM_HALF_WORDS * number;
    vec3 sum;
    for (uint c = 0u; c < 3u; c++) {
        uvec4 bins = film_words[sums + c];
        sum[c] = head.z == FILM_HAS_FLOATS
                     ? uintBitsToFloat(bins.x) * factor
                     : film_mean(bins, film_top_digit(head[2u + number], c), 1.0);
    }
    return sum;
}

// lib/halves.glsl has this function for the kernels that render. That file cannot be included here,
// because it reads the uniform block of those kernels.
uint samples_of_first_half(uint samples)
{
    return denoise.halves == HALVES_CONTIGUOUS ? min(samples, denoise.first_half)
                                               : samples - samples / 2u;
}

vec4 make_guide(float alpha, uint pixel)
{
    if (alpha == 0.0)
        return vec4(0.0);
    vec2 middle = vec2(pixel % denoise.now.width, pixel / denoise.now.width) + 0.5;
    float t = aov_means[AOV_SCALAR_AT(AOVS, AOV_DEPTH)] / alpha;
    vec3 normal = aov_vector(AOV_VECTOR_AT(AOVS, AOV_NORMAL));
    float squared = dot(normal, normal);
    // The mean of different normals may be 0; the pixel's normal then points to the camera.
    view_ray ray = ray_through(denoise.now, middle);
    normal = squared > 0.0 ? normal * inversesqrt(squared) : -ray.direction;
    return vec4(normal, guide_depth(denoise.now, t, ray.cosine));
}

// Returns the sum of squared deviations of luminance between the half-buffers, whose expectation is
// the variance of one sample (Chan, Golub and LeVeque 1979). It includes emission, so it is too
// large at the edges of emitters.
float halves_deviation(uint at, float a, float b, vec3 divisor)
{
    float difference = luminance(half_sum(at, 0u) / (a * divisor)) -
                       luminance(half_sum(at, 1u) / (b * divisor));
    return difference * difference * (a * b / (a + b));
}

// Returns 1 + the index of the motion of the object that the pixel's first sample hit; 0 if that
// object did not move.
float find_motion(uint at)
{
    uvec4 ids = film_words[at + AOV_FILM_WORDS(AOVS) - 1u];
    for (uint i = 0u; i < denoise.motion_count; i++) {
        gpu_denoise_motion motion = denoise.motions[i];
        if (ids.y == motion.instance &&
            ids.x - 1u - motion.first_primitive < motion.primitive_count)
            return float(i + 1u);
    }
    return 0.0;
}

void store_filtered(uint pixel, vec4 guide, vec4 light, vec4 modulation)
{
    if ((GATHERED & DENOISE_GATHER_LIGHT) != 0u) {
        store_guides(pixel, guide);
        store_to(pixel, light);
        store_modulation(pixel, modulation);
    }
}

void store_seen(uint pixel, vec4 picture, vec4 emission)
{
    if ((GATHERED & DENOISE_GATHER_PICTURE) != 0u) {
        store_picture(pixel, picture);
        store_emission(pixel, emission);
    }
}

void main()
{
    uint item = (push.first_group + gl_WorkGroupID.x) * DENOISE_WORKGROUP + gl_LocalInvocationIndex;
    if (item >= push.pixel_count)
        return;
    uint pixel = push.first_pixel + item;
    uint at = item * AOV_FILM_WORDS(AOVS);
    uint samples = film_words[at].x;
    if (samples == 0u) {
        store_filtered(pixel, vec4(0.0, 0.0, 0.0, DENOISE_EMPTY), vec4(0.0), vec4(1.0));
        store_seen(pixel, vec4(0.0), vec4(0.0));
        return;
    }
    float n = float(samples);
    read_aovs(at, n);
    vec3 mean = (half_sum(at, 0u) + half_sum(at, 1u)) / n;
    float alpha = aov_means[AOV_SCALAR_AT(AOVS, AOV_ALPHA)];
    vec3 emission = aov_vector(AOV_VECTOR_AT(AOVS, AOV_EMISSION));
    // Samples that hit nothing contribute no reflected light and no albedo, so at silhouettes the
    // fraction of samples that hit a surface cancels.
    vec3 albedo = aov_vector(AOV_VECTOR_AT(AOVS, AOV_ALBEDO));
    vec3 divisor = alpha > 0.0 ? max(albedo, vec3(LEAST_ALBEDO * alpha)) : vec3(1.0);
    float first = float(samples_of_first_half(samples));
    bool both = first > 0.0 && first < n;
    float deviation = both ? halves_deviation(at, first, n - first, divisor) : 0.0;
    store_filtered(pixel, make_guide(alpha, pixel), vec4((mean - emission) / divisor, deviation),
                   vec4(divisor, both ? 1.0 : 0.0));
    store_seen(pixel, vec4(mean, n), vec4(emission, find_motion(at)));
}
