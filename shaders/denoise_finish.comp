// One thread makes one pixel of the picture: as much of the filtered light as the variance bears
// out, in the colours of its surface.
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

// Two independent variances with as many degrees of freedom as the window's weights leave, 1 / (sum
// of their squares) = 13, have a greater ratio than this in one of 20 cases (Fisher's F
// distribution).
const float FISHER_13_13 = 2.58;
// Up to so many samples that much is put down to chance: noise is what disturbs then. With more of
// them there is less of it to lose, and less is put down to chance.
const float SAMPLES_FEW = 16.0;
// A single pixel has one degree of freedom, and F(1, 1) is above x in 2 / (pi sqrt(x)) of all
// cases. That share may be a 500th with few samples and grows with them, so that in the end each
// pixel is what its own samples say.
const float RARE_SHARE = 1.0 / 500.0;

vec2 unpack_judgement(uint packed)
{
    return vec2(uintBitsToFloat(packed & 0xffff0000u), uintBitsToFloat(packed << 16u));
}

// The third sum is of the variances times the numbers of samples: of one sample.
void add_judgement(inout vec3 sum, ivec2 pixel, ivec2 offset)
{
    bool inside;
    uint index = neighbour_index(pixel, offset, inside);
    float weight = inside ? spline(abs(offset.x)) * spline(abs(offset.y)) : 0.0;
    vec2 judgement = unpack_judgement(from_bits(index).w);
    sum += weight * vec3(judgement, judgement.y * load_blended(index).w);
}

// Returns how far to go from the unfiltered light (0) to the filtered one (1), judged by the
// surrounding pixels together and by the pixel alone. The mean of (f - p)^2 is V + b^2, from which
// the surrounding pixels give the bias b. The variance is that which they would have with as many
// samples (`worth` includes the history's) as the pixel has: one that has just come into view has
// fewer.
float trust(ivec2 pixel, vec2 own, float samples, float worth)
{
    vec3 sum = vec3(0.0);
#define ADD_JUDGEMENT(x, y) add_judgement(sum, pixel, ivec2(x, y));
    DENOISE_SQUARE_5(ADD_JUDGEMENT)
    float many = max(samples / SAMPLES_FEW, 1.0);
    float rare = 2.0 / (PI * RARE_SHARE * many);
    // Both halves of a dark pixel may have found nothing yet: what the pixels around say counts to
    // its variance, and with more samples less.
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
    // Where nothing was filtered these are the film's own bits, without the rounding of two
    // divisions.
    bvec3 same = equal(light, (film.rgb - emission) / divisor);
    store_picture(index, vec4(mix(light * divisor + emission, film.rgb, same), film.w));
}
