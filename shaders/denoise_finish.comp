// One thread computes one pixel of the denoised image: blends filtered and unfiltered light as the
// variance justifies, and multiplies by the colours of the surface.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/denoise.glsl"
#include "lib/denoise_view.glsl"
#include "lib/denoise_weights.glsl"

DENOISE_READ(blended, DENOISE_BLENDED)
DENOISE_READ(from, DENOISE_FROM)
DENOISE_READ(modulation, DENOISE_MODULATION)
DENOISE_READ(emission, DENOISE_EMISSION)
DENOISE_WRITE(picture, DENOISE_PICTURE)

// The 95 % quantile of Fisher's F distribution: the ratio of two independent variances exceeds it
// in one of 20 cases. Both have 13 degrees of freedom, 1 / (sum of the squares of the window's
// weights).
const float FISHER_13_13 = 2.58;
// Up to this many samples per pixel, differences within the limits FISHER_13_13 and RARE_SHARE are
// attributed to chance, because noise is the greater problem. With more samples there is less
// noise, and the limits are lower.
const float SAMPLES_FEW = 16.0;
// A single pixel has one degree of freedom; the distribution F(1, 1) exceeds x in a fraction 2 /
// (pi sqrt(x)) of all cases. This fraction is 1/500 with few samples and grows with their number,
// so that finally each pixel shows its own samples.
const float RARE_SHARE = 1.0 / 500.0;

vec2 unpack_judgement(uint packed)
{
    return vec2(uintBitsToFloat(packed & 0xffff0000u), uintBitsToFloat(packed << 16u));
}

// The third component of `sum` adds, for each pixel, the variance of a single sample: the pixel's
// variance times its number of samples.
void add_judgement(inout vec3 sum, ivec2 pixel, ivec2 offset)
{
    bool inside;
    uint index = neighbour_index(pixel, offset, inside);
    float weight = inside ? spline(abs(offset.x)) * spline(abs(offset.y)) : 0.0;
    vec2 judgement = unpack_judgement(from_bits(index).w);
    sum += weight * vec3(judgement, judgement.y * load_blended(index).w);
}

// Returns the weight of the filtered light, 0 to 1, judged by the surrounding pixels together and
// by the pixel alone. Let f be the filtered light, with bias b, and p the unfiltered light, with
// variance V. The mean of (f - p)^2 over the surrounding pixels is V + b^2, which gives b. `worth`
// is this pixel's number of samples, including those of the history; a pixel that has just come
// into view has few. V is scaled to this number.
float trust(ivec2 pixel, vec2 own, float samples, float worth)
{
    vec3 sum = vec3(0.0);
#define ADD_JUDGEMENT(x, y) add_judgement(sum, pixel, ivec2(x, y));
    DENOISE_SQUARE_5(ADD_JUDGEMENT)
    float many = max(samples / SAMPLES_FEW, 1.0);
    float rare = 2.0 / (PI * RARE_SHARE * many);
    // Both half-buffers of a dark pixel may still be black. So the variance of the surrounding
    // pixels is added, with a weight that decreases with the number of samples.
    float variance = own.y + sum.y / (many * many);
    float chance = 1.0 + (FISHER_13_13 - 1.0) / many;
    float expected = worth > 0.0 ? sum.z / worth : 0.0;
    return min(best_part(expected, sum.x - chance * sum.y),
               best_part(variance, own.x - rare * rare * variance));
}

void main()
{
    uvec2 pixel;
    if (!find_pixel(pixel))
        return;
    uint index = pixel_index(pixel);
    vec3 filtered = load_from(index).rgb;
    vec4 before = load_blended(index);
    vec3 divisor = load_modulation(index).rgb;
    vec3 emission = load_emission(index).rgb;
    vec4 film = uintBitsToFloat(picture_words[index]);
    vec2 own = unpack_judgement(from_bits(index).w);
    float part = trust(ivec2(pixel), own, film.w, before.w);
    vec3 light = before.rgb + part * (filtered - before.rgb);
    // Unfiltered pixels get the bits of the film, without the rounding of the two divisions.
    bvec3 same = equal(light, (film.rgb - emission) / divisor);
    store_picture(index, vec4(mix(light * divisor + emission, film.rgb, same), film.w));
}
