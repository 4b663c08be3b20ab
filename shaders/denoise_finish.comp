// One thread makes one pixel of the picture: as much of the filtered light as the variance bears out,
// in the colours of its surface.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/denoise.glsl"
#include "lib/denoise_weights.glsl"

DENOISE_READ(blended, DENOISE_BLENDED)
DENOISE_READ(from, DENOISE_FROM)
DENOISE_READ(modulation, DENOISE_MODULATION)
DENOISE_WRITE(picture, DENOISE_PICTURE)

const int RADIUS = 2;
// What two independent variances of 25 degrees of freedom each, the pixels of the window, differ by
// in one of 20 cases (Fisher's F distribution).
const float FISHER_25_25 = 1.955;

// Filtering moves a pixel by its noise and by its own bias: over the window the squares have the
// mean V + b^2. The mix lambda f + (1 - lambda) p of the filtered light f and the pixel p has the
// error lambda^2 b^2 + (1 - lambda)^2 V, least with lambda = V / (V + b^2) and there below both. What
// chance explains is no bias.
float trust(ivec2 pixel)
{
    float moved = 0.0, variance = 0.0;
    for (int y = -RADIUS; y <= RADIUS; y++)
        for (int x = -RADIUS; x <= RADIUS; x++) {
            ivec2 at = pixel + ivec2(x, y);
            bool inside = is_inside(at);
            uint packed = floatBitsToUint(load_from(pixel_index(uvec2(inside ? at : pixel))).w);
            moved += inside ? uintBitsToFloat(packed & 0xffff0000u) : 0.0;
            variance += inside ? uintBitsToFloat(packed << 16u) : 0.0;
        }
    float bias = max(0.0, moved - FISHER_25_25 * variance);
    return bias > 0.0 ? variance / (variance + bias) : 1.0;
}

void main()
{
    uvec2 pixel;
    if (!find_pixel(pixel))
        return;
    uint index = pixel_index(pixel);
    vec3 before = load_blended(index).rgb;
    vec3 divisor = load_modulation(index).rgb;
    vec4 film = picture_words[index];
    vec3 light = before + trust(ivec2(pixel)) * (load_from(index).rgb - before);
    // Where nothing was moved these are the film's own bits, without the rounding of two divisions.
    picture_words[index].rgb = mix(light * divisor, film.rgb, equal(light, film.rgb / divisor));
}
