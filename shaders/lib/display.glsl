// Defines functions that the kernels of the displayed image share. Declares the bindings of their
// linear images.
#ifndef DISPLAY_GLSL
#define DISPLAY_GLSL

#include "shared/display.h"

layout(constant_id = DISPLAY_CONSTANT_SHOWN) const uint SHOWN = SHOWN_RADIANCE;
layout(constant_id = DISPLAY_CONSTANT_FLAGS) const uint FLAGS = 0u;
layout(constant_id = DISPLAY_CONSTANT_AOVS) const uint AOVS = 0u;
layout(constant_id = DISPLAY_CONSTANT_HALVES) const uint HALVES = HALVES_INDEPENDENT;
layout(constant_id = DISPLAY_CONSTANT_TONE) const uint TONE = DISPLAY_TONE_NONE;
layout(local_size_x_id = DISPLAY_CONSTANT_WORKGROUP) in;

#define HAS_FLAG(flag) ((FLAGS & (flag)) != 0u)
#define SHOWS(set) (((set) >> SHOWN & 1u) != 0u)

layout(push_constant) uniform push_block {
    gpu_display_push push;
};

// WORDS(name, binding) defines uvec4 name_word(uint index).
#define WORDS(name, number)                                                                        \
    layout(std430, set = 0, binding = number) readonly buffer name##_block {                       \
        uvec4 name##_words[];                                                                      \
    };                                                                                             \
    layout(set = 0, binding = TEXEL_BINDING(number)) uniform usamplerBuffer name##_texels;         \
    uvec4 name##_word(uint index)                                                                  \
    {                                                                                              \
        if (HAS_FLAG(DISPLAY_TEXELS))                                                              \
            return texelFetch(name##_texels, int(index));                                          \
        return name##_words[index];                                                                \
    }

// PICTURE(name, binding) defines vec4 load_name(uint pixel).
#define PICTURE(name, number)                                                                      \
    WORDS(name, number)                                                                            \
    vec4 load_##name(uint pixel)                                                                   \
    {                                                                                              \
        return uintBitsToFloat(name##_word(pixel));                                                \
    }

// Returns the column and row of an item of an image. Some devices divide integers slowly; the
// quotient of floats has an error of at most 1 here, because there are fewer than 2^22 rows.
uvec2 place_of(uint item, uint width)
{
    uint row = uint(float(item) / float(width));
    int column = int(item - row * width);
    if (column < 0)
        return uvec2(uint(column + int(width)), row - 1u);
    return uint(column) < width ? uvec2(column, row) : uvec2(uint(column) - width, row + 1u);
}

uint item_index()
{
    return push.first_item + gl_GlobalInvocationID.x;
}

#endif
