// Reads materials: what a surface is made of.
#ifndef MATERIAL_GLSL
#define MATERIAL_GLSL

#include "lib/buffers.glsl"

// The groups of parameters as they are in the buffer, or after textures scaled them. What no code
// asks for is never read.
struct material {
    uint model_flags;
    uint first_texture;
    uint texture_count;
    uint medium;
    vec4 group[GROUP_COUNT];
};

uint material_model(material m)
{
    return m.model_flags & MATERIAL_MODEL_MASK;
}

bool material_has(material m, uint flag)
{
    return (m.model_flags & flag) != 0u;
}

#define LOAD_GROUP(number) m.group[number] = load_materials_float(at + 1u + uint(number))

// `word` is a material word: what a primitive carries.
material load_material(uint word)
{
    uint at = MATERIAL_HEADER_WORDS + (word & MATERIAL_INDEX_MASK) * MATERIAL_WORDS;
    uvec4 head = load_materials(at);
    material m;
    m.model_flags = head.x;
    m.first_texture = head.y;
    m.texture_count = head.z;
    m.medium = head.w;
    LOAD_GROUP(GROUP_BASE);
    LOAD_GROUP(GROUP_EMISSION);
    LOAD_GROUP(GROUP_METAL);
    LOAD_GROUP(GROUP_SPECULAR);
    LOAD_GROUP(GROUP_INTERFACE);
    LOAD_GROUP(GROUP_CLEARCOAT);
    LOAD_GROUP(GROUP_SHEEN);
    LOAD_GROUP(GROUP_DIFFUSE);
    LOAD_GROUP(GROUP_FILM);
    LOAD_GROUP(GROUP_CONDUCTOR);
    LOAD_GROUP(GROUP_CONDUCTOR_K);
    return m;
}

#endif
