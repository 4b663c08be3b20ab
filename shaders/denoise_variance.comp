// One thread estimates the variance of one pixel's luminance from the half-buffers and the history
// of similar neighbours or, if these have too few samples, from the differences between the
// neighbours (Schied et al. 2017, section 4.2).
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/denoise.glsl"
#include "lib/denoise_view.glsl"
#include "lib/denoise_weights.glsl"

DENOISE_READ(guides, DENOISE_GUIDES)
DENOISE_READ(blended, DENOISE_BLENDED)
DENOISE_READ(records, DENOISE_RECORDS)
DENOISE_WRITE(to, DENOISE_TO)

const int SPATIAL_RADIUS = 3;
// With fewer degrees of freedom than this the spatial variance of the neighbours is used, as Schied
// et al. 2017 do with fewer than 4 frames (section 4.2).
const float FREEDOM_ENOUGH = 4.0;

// Returns the similarity of a neighbour, by geometry only; 0 outside the image.
float likeness(depth_plane plane, ivec2 pixel, ivec2 offset, out uint index)
{
    bool inside;
    index = neighbour_index(pixel, offset, inside);
    float weight = surface_weight(plane, load_guides(index), vec2(offset), 0.0);
    return inside ? weight : 0.0;
}

// Adds a neighbour's squared deviations in x and its degrees of freedom in y. The variance of one
// sample is x / y.
void pool(inout vec2 sum, depth_plane plane, ivec2 pixel, ivec2 offset)
{
    uint index;
    float weight = likeness(plane, pixel, offset, index);
    sum += weight * load_records(index).zw;
}

vec2 pool_deviations(depth_plane plane, ivec2 pixel)
{
    vec2 sum = vec2(0.0);
#define POOL(x, y) pool(sum, plane, pixel, ivec2(x, y));
    DENOISE_SQUARE_5(POOL)
    return sum;
}

// Returns the variance of the neighbours' means. The means are taken relative to this pixel's mean,
// which avoids cancellation. radius: -1 if the result is not needed, so that the loop ends at once.
float spatial_variance(depth_plane plane, ivec2 pixel, float luminance_here, int radius)
{
    vec3 sum = vec3(0.0);
    for (int y = -radius; y <= radius; y++)
        for (int x = -radius; x <= radius; x++) {
            uint index;
            float weight = likeness(plane, pixel, ivec2(x, y), index);
            float away = luminance(load_blended(index).rgb) - luminance_here;
            sum += weight * vec3(1.0, away, away * away);
        }
    if (!(sum.x > 1.0))
        return 0.0; // no similar neighbour, so the filter will not mix anything with this pixel
    float mean = sum.y / sum.x;
    return max(sum.z / sum.x - mean * mean, 0.0) * (sum.x / (sum.x - 1.0));
}

void main()
{
    uvec2 pixel;
    if (!find_pixel(pixel))
        return;
    uint index = pixel_index(pixel);
    vec4 light = load_blended(index);
    vec4 record = load_records(index);
    vec4 guide = load_guides(index);
    depth_plane plane =
        make_plane(guide, record.xy, ray_length_change(denoise.now, vec2(pixel) + 0.5));
    bool empty = is_empty(guide);

    vec2 pooled = pool_deviations(plane, ivec2(pixel));
    bool enough = pooled.y >= FREEDOM_ENOUGH;
    float spatial = spatial_variance(plane, ivec2(pixel), luminance(light.rgb),
                                     enough || empty ? -1 : SPATIAL_RADIUS);
    float variance = enough ? pooled.x / (pooled.y * light.w) : spatial;
    store_to(index, vec4(light.rgb, empty ? 0.0 : variance));
}
