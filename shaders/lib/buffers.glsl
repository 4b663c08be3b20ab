// Declares the bindings. All reads of scene data and path state use load_*(), which is specialized
// to read a storage buffer or to fetch the same four words as a texel.
#ifndef BUFFERS_GLSL
#define BUFFERS_GLSL

#include "shared/aov.h"
#include "shared/types.h"
#include "lib/aliased.glsl"
#include "lib/constants.glsl"
#include "lib/parts.glsl"

layout(push_constant) uniform push_block {
    gpu_push push;
};

layout(std140, set = 0, binding = UNIFORM_BINDING_FRAME) uniform frame_block {
    gpu_frame frame;
};

// READABLE(name, binding, access, texel feature, number of further parts, index of the first one)
// defines uvec4 load_name(uint index), with an index in uvec4 words.
#define READABLE(name, number, access, feature, parts, first)                                      \
    layout(std430, set = 0, binding = number) access buffer name##_block {                         \
        uvec4 name##_words[];                                                                      \
    };                                                                                             \
    ALIASED layout(set = 0, binding = TEXEL_BINDING(number)) uniform usamplerBuffer name##_texels; \
    uvec4 load_##name(uint index)                                                                  \
    {                                                                                              \
        if (HAS(feature))                                                                          \
            return texelFetch(name##_texels, int(index));                                          \
        if ((parts) > 0u) {                                                                        \
            if (index >> PART_SHIFT > 0u)                                                          \
                return load_part((first) + (index >> PART_SHIFT) - 1u,                             \
                                 index & ((1u << PART_SHIFT) - 1u));                               \
        }                                                                                          \
        return name##_words[index];                                                                \
    }                                                                                              \
    vec4 load_##name##_float(uint index)                                                           \
    {                                                                                              \
        return uintBitsToFloat(load_##name(index));                                                \
    }

#define SCENE(name, number)                                                                        \
    READABLE(name, number, ALIASED readonly, FEATURE_TEXEL_SCENE, PARTS_OF(PARTS, number),         \
             PARTS_BEFORE(number))
#define STATE(name, number) READABLE(name, number, ALIASED, FEATURE_TEXEL_STATE, 0u, 0u)

SCENE(nodes, BINDING_NODES)
SCENE(triangles, BINDING_TRIANGLES)
SCENE(attributes, BINDING_ATTRIBUTES)
SCENE(shapes, BINDING_SHAPES)
SCENE(materials, BINDING_MATERIALS)
SCENE(emitters, BINDING_EMITTERS)
SCENE(environment, BINDING_ENVIRONMENT)
SCENE(texels, BINDING_TEXELS)
STATE(paths, BINDING_PATHS)
STATE(shadow_rays, BINDING_SHADOW_RAYS)
STATE(radiance, BINDING_RADIANCE)

// All queues share one buffer: Vulkan permits devices with only 4 storage buffers per stage, and
// shading also writes to paths, shadow rays and radiance.
layout(std430, set = 0, binding = BINDING_QUEUES) buffer queues_block {
    gpu_counters counters;
    uint queue_slots[]; // wave_slots entries for each queue that is needed
};

void store_path(uint slot, uint word, uvec4 value)
{
    paths_words[slot * PATH_WORDS + word] = value;
}

uvec4 load_path(uint slot, uint word)
{
    return load_paths(slot * PATH_WORDS + word);
}

// A slot has room for LIGHT_RAYS shadow rays.
void store_shadow_ray(uint slot, uint ray, uint word, uvec4 value)
{
    shadow_rays_words[(slot * LIGHT_RAYS + ray) * SHADOW_WORDS + word] = value;
}

uvec4 load_shadow_ray(uint slot, uint ray, uint word)
{
    return load_shadow_rays((slot * LIGHT_RAYS + ray) * SHADOW_WORDS + word);
}

// A wave takes 2^sample_shift samples of each of its items. Items are consecutive pixels; if tiles
// have sample counts of their own, the host lists the items behind the last queue: first the
// pixels, then the first sample number of each.
uint listed(uint row, uint item)
{
    return queue_slots[(uint(bitCount(QUEUES)) + row) * frame.wave_slots + item];
}

uint item_pixel(uint item)
{
    return HAS(FEATURE_TILES) ? listed(0u, item) : push.first_pixel + item;
}

uint item_first_sample(uint item)
{
    return HAS(FEATURE_TILES) ? listed(1u, item) : push.first_sample;
}

// Returns the number of slots of a sample: one, or with FEATURE_SPLIT_LOBES one for each branch of
// its path. The slots are adjacent.
uint slots_a_sample()
{
    return HAS(FEATURE_SPLIT_LOBES) ? 1u << frame.split_lobes : 1u;
}

uint first_slot(uint sample_of_wave)
{
    return HAS(FEATURE_SPLIT_LOBES) ? sample_of_wave << frame.split_lobes : sample_of_wave;
}

uint sample_of_slot(uint slot)
{
    return HAS(FEATURE_SPLIT_LOBES) ? slot >> frame.split_lobes : slot;
}

// Returns an offset that separates the dimensions of a branch's random numbers from those of the
// sample's other branches. Offsets are multiples of 2^32 divided by the golden ratio, which are far
// apart (Knuth 1973, section 6.4).
uint slot_stream(uint slot)
{
    if (!HAS(FEATURE_SPLIT_LOBES))
        return 0u;
    return (slot & (slots_a_sample() - 1u)) * 0x9e3779b9u;
}

// Returns the number in the picture of a pixel of the film, which may be a window of the picture.
// Random numbers depend on it, so that a window has the bits of the whole picture.
uint picture_pixel(uint pixel)
{
    if (WINDOW == 0u)
        return pixel;
    uint row = pixel / frame.width;
    return frame.window_first + row * frame.picture_width + (pixel - row * frame.width);
}

// The next two functions return the picture's pixel and the sample number of a slot.
uint slot_pixel(uint slot)
{
    return picture_pixel(item_pixel(sample_of_slot(slot) >> push.sample_shift));
}

uint slot_sample(uint slot)
{
    uint item = sample_of_slot(slot);
    return item_first_sample(item >> push.sample_shift) + (item & ((1u << push.sample_shift) - 1u));
}

// The length of a slot's record in the radiance buffer, in uvec4 words: the radiance, then AOVs.
const uint SLOT_WORDS = AOV_SLOT_WORDS(AOVS);

// Stores one component; `place` must be a constant. See shared/aov.h.
void store_aov_float(uint slot, uint place, float value)
{
    radiance_words[slot * SLOT_WORDS + 1u + (place >> 2u)][place & 3u] = floatBitsToUint(value);
}

float stored_aov_float(uint slot, uint place)
{
    return uintBitsToFloat(radiance_words[slot * SLOT_WORDS + 1u + (place >> 2u)][place & 3u]);
}

void store_aov_vector(uint slot, const uint aov, vec3 value)
{
    for (uint c = 0u; c < 3u; c++)
        store_aov_float(slot, AOV_VECTOR_AT(AOVS, aov) + c, value[c]);
}

void store_aov_scalar(uint slot, const uint aov, float value)
{
    store_aov_float(slot, AOV_SCALAR_AT(AOVS, aov), value);
}

void add_aov_scalar(uint slot, const uint aov, float value)
{
    uint place = AOV_SCALAR_AT(AOVS, aov);
    store_aov_float(slot, place, stored_aov_float(slot, place) + value);
}

void add_aov_vector(uint slot, const uint aov, vec3 value)
{
    for (uint c = 0u; c < 3u; c++) {
        uint place = AOV_VECTOR_AT(AOVS, aov) + c;
        store_aov_float(slot, place, stored_aov_float(slot, place) + value[c]);
    }
}

// Tests the bit pattern, because drivers may assume that floats are finite.
bool is_finite(vec3 v)
{
    uvec3 exponent = floatBitsToUint(v) & 0x7f800000u;
    return all(notEqual(exponent, uvec3(0x7f800000u)));
}

// Counts a contribution that is left out, marks its sample, and records the data that reproduce it.
void report_nonfinite(uint slot, uint site)
{
    radiance_words[slot * SLOT_WORDS].w = floatBitsToUint(1.0);
    atomicAdd(counters.nonfinite[site], 1u);
    uint record = atomicAdd(counters.nonfinite_records, 1u);
    if (record < NONFINITE_RECORDS) {
        counters.nonfinite_record[record * 4u + 0u] = slot_pixel(slot);
        counters.nonfinite_record[record * 4u + 1u] = slot_sample(slot);
        counters.nonfinite_record[record * 4u + 2u] = site;
        counters.nonfinite_record[record * 4u + 3u] = push.bounce;
    }
}

#endif
