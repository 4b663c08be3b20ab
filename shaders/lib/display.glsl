// What the kernels that make a picture to look at have in common. Owns their linear pictures'
// bindings.
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

// PICTURE(name, binding): vec4 load_name(uint pixel).
#define PICTURE(name, number)                                                                      \
    layout(std430, set = 0, binding = number) buffer name##_block {                                \
        uvec4 name##_words[];                                                                      \
    };                                                                                             \
    layout(set = 0, binding = TEXEL_BINDING(number)) uniform usamplerBuffer name##_texels;         \
    vec4 load_##name(uint pixel)                                                                   \
    {                                                                                              \
        if (HAS_FLAG(DISPLAY_TEXELS))                                                              \
            return uintBitsToFloat(texelFetch(name##_texels, int(pixel)));                         \
        return uintBitsToFloat(name##_words[pixel]);                                               \
    }

uint item_index()
{
    return push.first_item + gl_GlobalInvocationID.x;
}

#endif
