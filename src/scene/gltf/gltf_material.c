// Converts materials (glTF 2.0, section 3.9) to the principled model: metallic-roughness, normals,
// emission and alpha, or the models that replace these. Back faces are not culled. Both sides have
// the same material, whatever "doubleSided" says.
#include "scene/gltf/gltf_material.h"

#include "scene/core/texture_load.h"
#include <math.h>

// --- readers -------------------------------------------------------------------------------------

#define OPAQUE_MASK (MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND)

// The keys of a colour (with alpha if the material is not opaque), and of the texture that scales
// it.
struct color_keys {
    const char *factor, *texture;
};

static bool read_color_and_alpha(struct gltf_material_reader *reader,
                                 const struct json_node *object, struct color_keys keys,
                                 struct err *err)
{
    struct material *material = reader->material;
    const bool has_alpha = material->flags & OPAQUE_MASK;
    const struct json_node factor = node_member(object, keys.factor);
    double values[4] = {1, 1, 1, 1};
    if (factor.value && !node_numbers(&factor, 4, gltf_unit, values, err))
        return false;
    for (int c = 0; c < 3; c++)
        material->base_color[c] = (float)values[c];
    material->opacity = has_alpha ? (float)values[3] : 1.0f;
    return gltf_texture_read(
        reader, object, keys.texture,
        &(struct gltf_texture_use){
            .flags = texture_scales(GROUP_BASE, (const int[]){0, 1, 2, has_alpha ? 3 : -1}),
            .is_srgb = true,
        },
        err);
}

// --- the base ------------------------------------------------------------------------------------

static const struct color_keys metallic_keys = {"baseColorFactor", "baseColorTexture"};

static bool read_metallic_roughness(struct gltf_material_reader *reader, struct err *err)
{
    struct material *material = reader->material;
    struct json_node pbr;
    material->metallic = 1;
    material->roughness = 1;
    return gltf_read_object(reader->node, "pbrMetallicRoughness", &pbr, err) &&
           read_color_and_alpha(reader, &pbr, metallic_keys, err) &&
           gltf_read_float(&pbr, "metallicFactor", gltf_unit, &material->metallic, err) &&
           gltf_read_float(&pbr, "roughnessFactor", gltf_unit, &material->roughness, err) &&
           gltf_texture_read(reader, &pbr, "metallicRoughnessTexture",
                             &(struct gltf_texture_use){
                                 .flags = texture_scales(GROUP_METAL, (const int[]){-1, 1, 2, -1}),
                             },
                             err);
}

// KHR_materials_pbrSpecularGlossiness (archived) replaces metallic-roughness: a dielectric whose
// reflectance at normal incidence is the specular colour, over a diffuse base that receives the
// remaining light. specular_color is relative to the reflectance of the material's index of
// refraction, 1.5.
static bool read_specular_glossiness(struct gltf_material_reader *reader,
                                     const struct json_node *object, struct err *err)
{
    static const struct color_keys keys = {"diffuseFactor", "diffuseTexture"};
    static const char texture[] = "specularGlossinessTexture";
    struct material *material = reader->material;
    float specular[3] = {1, 1, 1}, glossiness = 1;
    if (!read_color_and_alpha(reader, object, keys, err) ||
        !node_read_color(object, "specularFactor", gltf_unit, specular, err) ||
        !gltf_read_float(object, "glossinessFactor", gltf_unit, &glossiness, err))
        return false;
    reader->load->tally.specular_glossy++;
    material->metallic = 0;
    material->roughness = 1 - glossiness;
    for (int c = 0; c < 3; c++)
        material->specular_color[c] = specular[c] / GLTF_REFLECTANCE;
    // Alpha scales the glossiness, which is 1 - roughness.
    const struct gltf_texture_use color = {
        .flags = texture_scales(GROUP_SPECULAR, (const int[]){0, 1, 2, -1}),
        .is_srgb = true,
    };
    const struct gltf_texture_use gloss = {
        .flags = texture_scales(GROUP_METAL, (const int[]){-1, 3, -1, -1}) |
                 1u << (TEXTURE_INVERT_SHIFT + PARAMETER_ROUGHNESS % 4),
        .is_srgb = true,
    };
    return gltf_texture_read(reader, object, texture, &color, err) &&
           gltf_texture_read(reader, object, texture, &gloss, err);
}

static bool read_base(struct gltf_material_reader *reader, struct err *err)
{
    struct json_node extensions, glossiness;
    if (!gltf_read_extension(reader->node, "KHR_materials_pbrSpecularGlossiness", &extensions,
                             &glossiness, err))
        return false;
    return glossiness.value ? read_specular_glossiness(reader, &glossiness, err)
                            : read_metallic_roughness(reader, err);
}

static bool read_normal(struct gltf_material_reader *reader, struct err *err)
{
    const struct range scales = {-1e3, 1e3, false}; // the range of normal_scale
    struct json_node normal;
    return gltf_read_object(reader->node, "normalTexture", &normal, err) &&
           gltf_read_float(&normal, "scale", scales, &reader->material->normal_scale, err) &&
           gltf_texture_read(reader, reader->node, "normalTexture",
                             &(struct gltf_texture_use){
                                 .flags = TEXTURE_USE_NORMAL << TEXTURE_USE_SHIFT,
                             },
                             err);
}

// --- light and alpha -----------------------------------------------------------------------------

static const struct gltf_texture_use emission_texture = {
    .flags = GROUP_EMISSION << TEXTURE_GROUP_SHIFT | 7u << TEXTURE_MASK_SHIFT |
             1u << (TEXTURE_CHANNELS_SHIFT + 2) | 2u << (TEXTURE_CHANNELS_SHIFT + 4),
    .is_srgb = true,
};

// Emission is in candela per square metre in the file, and in W/(sr m^2) in the scene. The numbers
// are not converted, because the spectrum is not specified.
static bool read_emission(struct gltf_material_reader *reader, struct err *err)
{
    struct material *material = reader->material;
    struct json_node extensions, emissive;
    float strength = 1;
    const struct range strengths = {0, SCENE_RADIANCE_MAX, false};
    if (!node_read_color(reader->node, "emissiveFactor", gltf_unit, material->emission, err) ||
        !gltf_read_extension(reader->node, "KHR_materials_emissive_strength", &extensions,
                             &emissive, err) ||
        !gltf_read_float(&emissive, "emissiveStrength", strengths, &strength, err))
        return false;
    for (int c = 0; c < 3; c++)
        material->emission[c] *= strength;
    return gltf_texture_read(reader, reader->node, "emissiveTexture", &emission_texture, err);
}

static bool read_alpha(struct gltf_material_reader *reader, struct err *err)
{
    static const char *const modes[] = {"OPAQUE", "MASK", "BLEND", NULL};
    static const uint32_t flags[] = {0, MATERIAL_ALPHA_MASK, MATERIAL_ALPHA_BLEND};
    const struct range cutoffs = {0, 1e3, false}; // the range of alpha_cutoff
    uint32_t mode = 0;
    if (!node_read_choice(reader->node, "alphaMode", modes, &mode, err) ||
        !gltf_read_float(reader->node, "alphaCutoff", cutoffs, &reader->material->alpha_cutoff,
                         err))
        return false;
    reader->material->flags |= flags[mode];
    return true;
}

// KHR_materials_unlit displays the base colour; of the other parameters only alpha has an effect.
static bool read_unlit(struct gltf_material_reader *reader, struct err *err)
{
    struct material *material = reader->material;
    struct json_node pbr;
    if (!gltf_read_object(reader->node, "pbrMetallicRoughness", &pbr, err) ||
        !read_color_and_alpha(reader, &pbr, metallic_keys, err) ||
        !gltf_texture_read(reader, &pbr, metallic_keys.texture, &emission_texture, err))
        return false;
    material->model = MATERIAL_LAMBERT;
    material->flags |= MATERIAL_UNLIT;
    for (int c = 0; c < 3; c++) {
        material->emission[c] = material->base_color[c];
        material->base_color[c] = 0;
    }
    return true;
}

// --- materials -----------------------------------------------------------------------------------

static bool read_material(struct gltf_material_reader *reader, struct err *err)
{
    struct json_node extensions, unlit;
    if (!gltf_read_name(reader->node, &reader->load->scene->arena, &reader->material->name, err) ||
        !gltf_read_extension(reader->node, "KHR_materials_unlit", &extensions, &unlit, err) ||
        !read_alpha(reader, err))
        return false;
    if (unlit.value)
        return read_unlit(reader, err);
    return read_base(reader, err) && read_normal(reader, err) && read_emission(reader, err) &&
           gltf_material_read_layers(reader, err);
}

static bool load_material(struct gltf_load *load, uint32_t index, struct err *err)
{
    const struct json_node node = gltf_item(&load->document, GLTF_MATERIALS, index);
    struct material *material = scene_add_material(load->scene, NULL);
    if (!material)
        return gltf_no_memory(&load->document, "materials", sizeof *material, err);
    material->model = MATERIAL_PRINCIPLED;
    material->flags |= MATERIAL_GLTF_LAYERS;
    struct gltf_material_reader reader = {
        .load = load,
        .node = &node,
        .state = &load->materials[index],
        .material = material,
    };
    return read_material(&reader, err);
}

bool gltf_materials_load(struct gltf_load *load, struct err *err)
{
    uint32_t count = load->document.counts[GLTF_MATERIALS];
    load->first_material = load->scene->material_count;
    load->materials = ARENA_NEW(&load->document.arena, struct gltf_material, count);
    if (!load->materials)
        return gltf_no_memory(&load->document, "materials", count * sizeof *load->materials, err);
    for (uint32_t i = 0; i < count; i++)
        if (!load_material(load, i, err))
            return false;
    return true;
}
