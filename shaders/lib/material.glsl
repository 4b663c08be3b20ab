// Reads materials.
#ifndef MATERIAL_GLSL
#define MATERIAL_GLSL

#include "lib/material_header.glsl"

// A material's parameters in groups, as they are in the buffer, or multiplied by textures. Groups
// that no code uses are never read.
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

// Macros for access to parameters: functions would copy the material.
#define material_base_color(m) (m).group[GROUP_BASE].rgb
#define material_emission(m) (m).group[GROUP_EMISSION].rgb
#define material_pick_density(m) (m).group[GROUP_EMISSION].a
#define material_anisotropic(m) (m).group[GROUP_METAL].r
#define material_roughness(m) (m).group[GROUP_METAL].g
#define material_metallic(m) (m).group[GROUP_METAL].b
#define material_anisotropic_rotation(m) (m).group[GROUP_METAL].a
#define material_specular_color(m) (m).group[GROUP_SPECULAR].rgb
#define material_specular_weight(m) (m).group[GROUP_SPECULAR].a
#define material_transmission(m) (m).group[GROUP_INTERFACE].r
#define material_ior(m) (m).group[GROUP_INTERFACE].g
#define material_specular(m) (m).group[GROUP_INTERFACE].b
#define material_specular_tint(m) (m).group[GROUP_INTERFACE].a
#define material_clearcoat(m) (m).group[GROUP_CLEARCOAT].r
#define material_clearcoat_roughness(m) (m).group[GROUP_CLEARCOAT].g
#define material_clearcoat_gloss(m) (m).group[GROUP_CLEARCOAT].b
#define material_normal_scale(m) (m).group[GROUP_CLEARCOAT].a
#define material_sheen_color(m) (m).group[GROUP_SHEEN].rgb
#define material_sheen_roughness(m) (m).group[GROUP_SHEEN].a
#define material_subsurface(m) (m).group[GROUP_DIFFUSE].r
#define material_sheen(m) (m).group[GROUP_DIFFUSE].g
#define material_sheen_tint(m) (m).group[GROUP_DIFFUSE].b
#define material_diffuse_transmission(m) (m).group[GROUP_DIFFUSE].a
#define material_iridescence(m) (m).group[GROUP_FILM].r
#define material_film_thickness(m) (m).group[GROUP_FILM].g
#define material_film_ior(m) (m).group[GROUP_FILM].b
#define material_conductor_eta(m) (m).group[GROUP_CONDUCTOR].rgb
#define material_exponent(m) (m).group[GROUP_CONDUCTOR].a
#define material_conductor_k(m) (m).group[GROUP_CONDUCTOR_K].rgb

#define LOAD_GROUP(number) m.group[number] = load_materials_float(at + 1u + uint(number))

// word: a material word, which each primitive has.
material load_material(uint word)
{
    uint at = material_at(word);
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
