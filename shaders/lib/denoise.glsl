// Declares the bindings of the denoiser's kernels, and assigns pixels to threads.
#ifndef DENOISE_GLSL
#define DENOISE_GLSL

#include "shared/denoise.h"
#include "lib/aliased.glsl"

layout(local_size_x = DENOISE_WORKGROUP) in;
layout(constant_id = DENOISE_CONSTANT_TEXEL) const uint TEXEL = 0u;

layout(push_constant) uniform push_block {
    gpu_denoise_push push;
};

layout(std140, set = 0, binding = UNIFORM_BINDING_FRAME) uniform denoise_block {
    gpu_denoise denoise;
};

// Defines uvec4 NAME_bits(uint pixel) and vec4 load_NAME(uint pixel).
#define DENOISE_READ(name, number)                                                                 \
    layout(std430, set = 0, binding = number) ALIASED readonly buffer name##_block {               \
        uvec4 name##_words[];                                                                      \
    };                                                                                             \
    ALIASED layout(set = 0, binding = TEXEL_BINDING(number)) uniform usamplerBuffer name##_texels; \
    uvec4 name##_bits(uint pixel)                                                                  \
    {                                                                                              \
        if (TEXEL != 0u)                                                                           \
            return texelFetch(name##_texels, int(pixel));                                          \
        return name##_words[pixel];                                                                \
    }                                                                                              \
    vec4 load_##name(uint pixel)                                                                   \
    {                                                                                              \
        return uintBitsToFloat(name##_bits(pixel));                                                \
    }

// Defines void store_NAME(uint pixel, vec4 value).
#define DENOISE_WRITE(name, number)                                                                \
    layout(std430, set = 0, binding = number) ALIASED buffer name##_block {                        \
        uvec4 name##_words[];                                                                      \
    };                                                                                             \
    void store_##name(uint pixel, vec4 value)                                                      \
    {                                                                                              \
        name##_words[pixel] = floatBitsToUint(value);                                              \
    }

// Workgroups process squares of pixels, row by row: neighbours in x are neighbours in a subgroup,
// and neighbours in y are in the cache. Returns false for threads outside the image.
bool find_pixel(out uvec2 pixel)
{
    uint across = (denoise.now.width + DENOISE_TILE - 1u) / DENOISE_TILE;
    uint tile = push.first_group + gl_WorkGroupID.x;
    uvec2 within = uvec2(gl_LocalInvocationIndex % DENOISE_TILE,
                         gl_LocalInvocationIndex / DENOISE_TILE);
    pixel = uvec2(tile % across, tile / across) * DENOISE_TILE + within;
    return pixel.x < denoise.now.width && pixel.y < denoise.now.height;
}

uint pixel_index(uvec2 pixel)
{
    return pixel.y * denoise.now.width + pixel.x;
}

bool is_inside(ivec2 pixel)
{
    return all(lessThan(uvec2(pixel), uvec2(denoise.now.width, denoise.now.height)));
}

// Returns the index of a neighbour, or of the pixel itself if the neighbour is outside the image.
uint neighbour_index(ivec2 pixel, ivec2 offset, out bool inside)
{
    ivec2 at = pixel + offset;
    inside = is_inside(at);
    return pixel_index(uvec2(inside ? at : pixel));
}

// The loops are written out, because some drivers do not unroll them, and their overhead exceeds
// the cost of their bodies.
#define DENOISE_ROW_3(tap, y) tap(-1, y) tap(0, y) tap(1, y)
#define DENOISE_SQUARE_3(tap) DENOISE_ROW_3(tap, -1) DENOISE_ROW_3(tap, 0) DENOISE_ROW_3(tap, 1)
#define DENOISE_ROW_5(tap, y) tap(-2, y) tap(-1, y) tap(0, y) tap(1, y) tap(2, y)
#define DENOISE_SQUARE_5(tap)                                                                      \
    DENOISE_ROW_5(tap, -2)                                                                         \
    DENOISE_ROW_5(tap, -1) DENOISE_ROW_5(tap, 0) DENOISE_ROW_5(tap, 1) DENOISE_ROW_5(tap, 2)

#endif
