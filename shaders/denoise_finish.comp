// One thread makes one pixel of the picture: as much of the filtered light as the variance bears out,
// in the colours of its surface.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/denoise.glsl"
#include "lib/denoise_weights.glsl"

DENOISE_READ(blended, DENOISE_BLENDED)
DENOISE_READ(from, DENOISE_FROM)
DENOISE_READ(modulation, DENOISE_MODULATION)
DENOISE_READ(emission, DENOISE_EMISSION)
DENOISE_WRITE(picture, DENOISE_PICTURE)

// What two independent variances of 25 degrees of freedom each, the pixels of the window, differ by
// in one of 20 cases (Fisher's F distribution).
const float FISHER_25_25 = 1.955;

void add_judgement(inout vec2 sum, ivec2 pixel, ivec2 offset)
{
    bool inside;
    uint packed = floatBitsToUint(load_from(neighbour_index(pixel, offset, inside)).w);
    vec2 moved_variance =
        vec2(uintBitsToFloat(packed & 0xffff0000u), uintBitsToFloat(packed << 16u));
    sum += inside ? moved_variance : vec2(0.0);
}

// Filtering moves a pixel by its noise and by its own bias: over the window the squares have the
// mean V + b^2. The mix lambda f + (1 - lambda) p of the filtered light f and the pixel p has the
// error lambda^2 b^2 + (1 - lambda)^2 V, least with lambda = V / (V + b^2) and there below both. What
// chance explains is no bias.
float trust(ivec2 pixel)
{
    vec2 sum = vec2(0.0); // squares of movements; variances
#define ADD_JUDGEMENT(x, y) add_judgement(sum, pixel, ivec2(x, y));
    DENOISE_SQUARE_5(ADD_JUDGEMENT)
    float bias = max(0.0, sum.x - FISHER_25_25 * sum.y);
    return bias > 0.0 ? sum.y / (sum.y + bias) : 1.0;
}

void main()
{
    uvec2 pixel;
    if (!find_pixel(pixel))
        return;
    uint index = pixel_index(pixel);
    vec3 before = load_blended(index).rgb;
    vec3 divisor = load_modulation(index).rgb;
    vec3 emission = load_emission(index).rgb;
    vec3 film = picture_words[index].rgb;
    vec3 light = before + trust(ivec2(pixel)) * (load_from(index).rgb - before);
    // Where nothing was moved these are the film's own bits, without the rounding of two divisions.
    bvec3 same = equal(light, (film - emission) / divisor);
    picture_words[index].rgb = mix(light * divisor + emission, film, same);
}
