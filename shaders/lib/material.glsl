// Owns nothing but reads materials: what a surface is made of.
#ifndef MATERIAL_GLSL
#define MATERIAL_GLSL

#include "lib/buffers.glsl"

struct material {
    vec3 base_color;
    uint kind;
    vec3 emission;
    float pick_density; // a unit area; see struct gpu_material
};

material load_material(uint index)
{
    uvec4 w0 = load_materials(index * 2u);
    vec4 w1 = load_materials_float(index * 2u + 1u);
    return material(uintBitsToFloat(w0.xyz), w0.w, w1.xyz, w1.w);
}

#endif
