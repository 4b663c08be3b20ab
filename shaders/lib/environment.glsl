// What is around the scene: constant radiance, or a latitude-longitude image, sampled by
// importance. Reads the environment's buffer, see render/environment_table.h.
#ifndef ENVIRONMENT_GLSL
#define ENVIRONMENT_GLSL

#include "lib/angle.glsl"
#include "lib/buffers.glsl"

uvec2 environment_size()
{
    return uvec2(frame.environment_size & 0xffffu, frame.environment_size >> 16u);
}

// Index of the texel that a unit direction of the image sees; see scene/environment.h for the
// convention. Texels are constant patches. By the arctangent of the distance from the axis, since
// near a pole the height says little.
uint environment_texel(vec3 direction, uvec2 size)
{
    float u = 0.5 + atan_turns(direction.z, direction.x);
    float v = 2.0 * atan_turns(length(direction.xz), direction.y);
    uvec2 texel = min(uvec2(vec2(u, v) * vec2(size)), size - 1u);
    return texel.y * size.x + texel.x;
}

// Radiance that arrives from a unit direction, without the factor on all, and the density per solid
// angle with which sample_environment() chooses it: that of the texel's own probability, as it is
// after rounding.
vec4 load_environment_texel(vec3 direction)
{
    float c = frame.environment_cos, s = frame.environment_sin;
    vec3 turned = vec3(c * direction.x - s * direction.z, direction.y,
                       s * direction.x + c * direction.z);
    return load_environment_float(environment_texel(turned, environment_size()));
}

// What arrives from a unit direction.
vec3 environment_radiance(vec3 direction)
{
    if (!HAS(FEATURE_ENVIRONMENT_IMAGE))
        return frame.environment;
    return frame.environment * load_environment_texel(direction).rgb;
}

// Words of one level of a table of `count` thresholds: a word of the level below for each of four
// components.
uint table_level_words(uint count, uint level)
{
    uint shift = 2u * level + 2u;
    return ((count - 1u) >> shift) + 1u;
}

uint table_levels(uint count)
{
    return count > 1u ? uint(findMSB(count - 1u)) / 2u + 1u : 1u;
}

uint table_words(uint count)
{
    uint words = 0u;
    for (uint level = 0u; level < table_levels(count); level++)
        words += table_level_words(count, level);
    return words;
}

// The last of `count` bins whose threshold is at most u.x, of the table that begins at word `at`;
// where u is in it, from 0 to 1. u.y: the next 16 bits of u.x.
uint search_table(uint at, uint count, uvec2 u, out float within)
{
    uint bin = 0u, low = 0u, high = 0xffffffffu;
    for (uint level = table_levels(count); level-- > 0u;) {
        uvec4 thresholds = load_environment(at + bin);
        at += table_level_words(count, level);
        bvec3 above = greaterThanEqual(u.xxx, thresholds.yzw);
        low = above.z ? thresholds.w : above.y ? thresholds.z : above.x ? thresholds.y
                                                                        : thresholds.x;
        high = above.z ? high : above.y ? thresholds.w : above.x ? thresholds.z : thresholds.y;
        bin = 4u * bin + (above.z ? 3u : above.y ? 2u : above.x ? 1u : 0u);
    }
    within = (float(u.x - low) + (float(u.y) + 0.5) * 1.52587890625e-5) / float(high - low);
    return bin;
}

// A uniform of 24 bits and another with the bits that it lacks, as 32 bits and 16 more. The
// greatest number of 32 bits stands for the end of a table.
uvec2 long_uniform(float u, float extra)
{
    uint more = uint(extra * 16777216.0);
    return uvec2(min(uint(u * 16777216.0) << 8u | more >> 16u, 0xfffffffeu), more & 0xffffu);
}

// 1 - cos of an angle of at most half a turn; does not cancel.
float versine_turns(float turns)
{
    float s = sin_small(0.5 * turns);
    return 2.0 * s * s;
}

// A direction of the image: `within` parts of the way through a texel, evenly by solid angle.
vec3 environment_direction(uvec2 texel, vec2 within, uvec2 size)
{
    // From the nearer pole, where small angles have all their digits.
    bool below = 2u * texel.y >= size.y;
    uint row = below ? size.y - 1u - texel.y : texel.y;
    float part = below ? 1.0 - within.y : within.y;
    float inner = versine_turns(float(row) / float(2u * size.y));
    float outer = versine_turns(float(row + 1u) / float(2u * size.y));
    float versine = mix(inner, outer, part);
    float radius = sqrt(versine * (2.0 - versine));
    vec2 around = radius * cos_sin_turns((float(texel.x) + within.x) / float(size.x) - 0.5);
    return vec3(around.x, below ? versine - 1.0 : 1.0 - versine, around.y);
}

// A direction by the luminance of the image, from two uniforms and two more with the bits that they
// lack: first a row, then a texel of it, by inversion, which keeps the order of stratified numbers.
// Returns the density per solid angle; 0 where there is nothing to connect to.
float sample_environment(vec2 u, vec2 u_extra, out vec3 direction, out vec3 radiance)
{
    uvec2 size = environment_size(), texel;
    vec2 within;
    uint rows_at = size.x * size.y;
    texel.y = search_table(rows_at, size.y, long_uniform(u.x, u_extra.x), within.y);
    uint row_at = rows_at + table_words(size.y) + texel.y * table_words(size.x);
    texel.x = search_table(row_at, size.x, long_uniform(u.y, u_extra.y), within.x);
    vec3 d = environment_direction(texel, within, size);
    float c = frame.environment_cos, s = frame.environment_sin;
    direction = vec3(c * d.x + s * d.z, d.y, c * d.z - s * d.x);
    vec4 found = load_environment_float(texel.y * size.x + texel.x);
    radiance = frame.environment * found.rgb;
    return found.a;
}

#endif
