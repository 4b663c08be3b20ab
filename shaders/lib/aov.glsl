// Stores the AOVs of the first surface that a camera ray hits, in the slot's record.
#ifndef AOV_GLSL
#define AOV_GLSL

#include "lib/material.glsl"
#include "lib/surface.glsl"

// Returns the surface's colour: the base colour; white for dielectrics; the reflectance at normal
// incidence for conductors.
vec3 albedo_color(material m)
{
    if (material_model(m) == MATERIAL_DIELECTRIC)
        return vec3(1.0);
    if (material_model(m) == MATERIAL_CONDUCTOR) {
        vec3 eta = material_conductor_eta(m);
        vec3 k2 = material_conductor_k(m) * material_conductor_k(m);
        return material_specular_color(m) * ((eta - 1.0) * (eta - 1.0) + k2) /
               ((eta + 1.0) * (eta + 1.0) + k2);
    }
    return material_base_color(m);
}

// `m` and `s` are the material and surface after textures; t is the distance of the hit. Both
// normals face the camera. Lengths are stored in metres, positions relative to the flat scene's
// origin.
void store_first_hit(uint slot, surface s, material m, uint primitive, uint instance, float t)
{
    if (HAS_AOV(AOV_ALBEDO))
        store_aov_vector(slot, AOV_ALBEDO, albedo_color(m));
    if (HAS_AOV(AOV_NORMAL))
        store_aov_vector(slot, AOV_NORMAL, s.normal_shading);
    if (HAS_AOV(AOV_NORMAL_GEOMETRIC))
        store_aov_vector(slot, AOV_NORMAL_GEOMETRIC, s.normal_geometric);
    if (HAS_AOV(AOV_POSITION))
        store_aov_vector(slot, AOV_POSITION, s.position * frame.metre);
    if (HAS_AOV(AOV_DEPTH))
        store_aov_scalar(slot, AOV_DEPTH, t * frame.metre);
    if (HAS_AOV(AOV_ALPHA))
        store_aov_scalar(slot, AOV_ALPHA, 1.0);
    if (HAS_AOV(AOV_IDS)) {
        bool is_shape = (primitive & PRIMITIVE_SHAPE) != 0u;
        uint number = is_shape ? primitive : load_triangles(primitive * 3u).w;
        radiance_words[slot * SLOT_WORDS + SLOT_WORDS - 1u] =
            uvec4(number + 1u, instance + 1u, (s.material & MATERIAL_INDEX_MASK) + 1u, 0u);
    }
}

#endif
