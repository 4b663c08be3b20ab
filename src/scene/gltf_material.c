// Materials, glTF 2.0, section 3.9: their base colour and emission, as diffuse surfaces.
#include "gltf_load.h"

#include <string.h>

static const struct range unit_interval = {0, 1, false};

// A colour of `count` components of which the first three count; alpha is checked and left.
static bool read_factor(const struct json_node *object, const char *key, size_t count,
                        float color[3], struct err *err)
{
    const struct json_node node = node_member(object, key);
    double values[4];
    if (!node.value)
        return true;
    if (!node_numbers(&node, count, unit_interval, values, err))
        return false;
    for (int i = 0; i < 3; i++)
        color[i] = (float)values[i];
    return true;
}

static bool read_metallic_roughness(const struct json_node *node, struct material *material,
                                    struct gltf_tally *tally, struct err *err)
{
    struct json_node pbr;
    double metallic = 1;
    if (!gltf_read_object(node, "pbrMetallicRoughness", &pbr, err))
        return false;
    if (!pbr.value)
        return true;
    if (!read_factor(&pbr, "baseColorFactor", 4, material->base_color, err) ||
        !node_read_number(&pbr, "metallicFactor", unit_interval, &metallic, err))
        return false;
    tally->metallic += metallic > 0;
    return true;
}

// KHR_materials_pbrSpecularGlossiness, archived: its diffuse colour replaces the base colour.
static bool read_specular_glossiness(const struct json_node *node, struct material *material,
                                     struct gltf_tally *tally, struct err *err)
{
    struct json_node extensions, glossiness;
    if (!gltf_read_extension(node, "KHR_materials_pbrSpecularGlossiness", &extensions, &glossiness,
                             err))
        return false;
    if (!glossiness.value)
        return true;
    tally->specular_glossy++;
    for (int i = 0; i < 3; i++)
        material->base_color[i] = 1;
    return read_factor(&glossiness, "diffuseFactor", 4, material->base_color, err);
}

// Emission is in candela per square metre in the file and in W/(sr m^2) in the scene; the numbers
// are taken as they are, since neither says which spectrum is meant.
static bool read_emission(const struct json_node *node, struct material *material,
                          struct gltf_tally *tally, struct err *err)
{
    struct json_node extensions, emissive, texture;
    double strength = 1;
    const struct range strengths = {0, SCENE_RADIANCE_MAX, false};
    if (!read_factor(node, "emissiveFactor", 3, material->emission, err) ||
        !gltf_read_extension(node, "KHR_materials_emissive_strength", &extensions, &emissive,
                             err) ||
        !node_read_number(&emissive, "emissiveStrength", strengths, &strength, err) ||
        !gltf_read_object(node, "emissiveTexture", &texture, err))
        return false;
    // Most of an emissive texture is black: without it the whole surface would glow.
    tally->emissive_textures += texture.value != NULL;
    for (int i = 0; i < 3; i++)
        material->emission[i] =
            texture.value ? 0 : (float)((double)material->emission[i] * strength);
    return true;
}

static bool read_kind(const struct json_node *node, struct gltf_tally *tally, struct err *err)
{
    static const char *const alpha_modes[] = {"OPAQUE", "MASK", "BLEND", NULL};
    struct json_node extensions, unlit;
    uint32_t alpha_mode = 0;
    if (!node_read_choice(node, "alphaMode", alpha_modes, &alpha_mode, err) ||
        !gltf_read_extension(node, "KHR_materials_unlit", &extensions, &unlit, err))
        return false;
    tally->transparent += alpha_mode != 0;
    tally->unlit += unlit.value != NULL;
    return true;
}

static bool load_material(struct gltf_load *load, uint32_t index, struct err *err)
{
    const struct json_node node = gltf_item(&load->document, GLTF_MATERIALS, index);
    struct material *material = scene_add_material(load->scene, NULL);
    if (!material)
        return gltf_no_memory(&load->document, "materials", sizeof *material, err);
    material->model = MATERIAL_LAMBERT;
    for (int i = 0; i < 3; i++)
        material->base_color[i] = 1; // the specification's default
    struct gltf_tally *tally = &load->tally;
    return gltf_read_name(&node, &load->scene->arena, &material->name, err) &&
           read_metallic_roughness(&node, material, tally, err) &&
           read_specular_glossiness(&node, material, tally, err) &&
           read_emission(&node, material, tally, err) && read_kind(&node, tally, err);
}

bool gltf_materials_load(struct gltf_load *load, struct err *err)
{
    load->first_material = load->scene->material_count;
    for (uint32_t i = 0; i < load->document.counts[GLTF_MATERIALS]; i++)
        if (!load_material(load, i, err))
            return false;
    return true;
}
