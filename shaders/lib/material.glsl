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
    for (uint i = 0u; i < GROUP_COUNT; i++)
        m.group[i] = load_materials_float(at + 1u + i);
    return m;
}

uint material_class(uint word)
{
    return word >> MATERIAL_CLASS_SHIFT & MATERIAL_CLASS_MASK;
}

// The first word of four of the materials' buffer.
uvec4 load_material_sections()
{
    return load_materials(0u);
}

#endif
