// Extensions of the metallic-roughness model of glTF 2.0: KHR_materials_* except those that replace
// it. docs/gltf.md describes the mapping of each.
#include "scene/gltf/gltf_material.h"

#include "scene/core/texture_load.h"
#include <math.h>

// One of these extensions in a material.
struct layer {
    struct gltf_material_reader *reader;
    struct json_node extensions, node; // node.value is NULL if the material lacks the extension
};

static bool open_layer(struct gltf_material_reader *reader, const char *name, struct layer *out,
                       struct err *err)
{
    out->reader = reader;
    return gltf_read_extension(reader->node, name, &out->extensions, &out->node, err);
}

static bool read_number(const struct layer *layer, const char *key, float *out, struct err *err)
{
    return gltf_read_float(&layer->node, key, gltf_unit, out, err);
}

// Reads a texture whose channel, 0 to 3, scales one parameter.
static bool read_channel(const struct layer *layer, const char *key, uint32_t parameter,
                         int channel, struct err *err)
{
    int channels[4] = {-1, -1, -1, -1};
    channels[parameter % 4] = channel;
    // For alpha, is_srgb has no effect on the values. It lets the texture share its image with a
    // texture of colours.
    const struct gltf_texture_use use = {
        .flags = texture_scales(parameter / 4, channels),
        .is_srgb = channel == 3,
    };
    return gltf_texture_read(layer->reader, &layer->node, key, &use, err);
}

static bool read_colors(const struct layer *layer, const char *key, uint32_t group, struct err *err)
{
    const struct gltf_texture_use use = {
        .flags = texture_scales(group, (const int[]){0, 1, 2, -1}),
        .is_srgb = true,
    };
    return gltf_texture_read(layer->reader, &layer->node, key, &use, err);
}

// --- layers above the base -----------------------------------------------------------------------

static bool read_clearcoat(struct gltf_material_reader *reader, struct err *err)
{
    struct material *material = reader->material;
    struct layer layer;
    struct json_node normal;
    if (!open_layer(reader, "KHR_materials_clearcoat", &layer, err))
        return false;
    if (!layer.node.value)
        return true;
    material->flags |= MATERIAL_COAT_GGX;
    if (!gltf_read_object(&layer.node, "clearcoatNormalTexture", &normal, err))
        return false;
    reader->load->tally.coat_normals += normal.value != NULL;
    return read_number(&layer, "clearcoatFactor", &material->clearcoat, err) &&
           read_channel(&layer, "clearcoatTexture", PARAMETER_CLEARCOAT, 0, err) &&
           read_number(&layer, "clearcoatRoughnessFactor", &material->clearcoat_roughness, err) &&
           read_channel(&layer, "clearcoatRoughnessTexture", PARAMETER_CLEARCOAT_ROUGHNESS, 1, err);
}

static bool read_sheen(struct gltf_material_reader *reader, struct err *err)
{
    struct material *material = reader->material;
    struct layer layer;
    return open_layer(reader, "KHR_materials_sheen", &layer, err) &&
           node_read_color(&layer.node, "sheenColorFactor", gltf_unit, material->sheen_color,
                           err) &&
           read_colors(&layer, "sheenColorTexture", GROUP_SHEEN, err) &&
           read_number(&layer, "sheenRoughnessFactor", &material->sheen_roughness, err) &&
           read_channel(&layer, "sheenRoughnessTexture", PARAMETER_SHEEN_ROUGHNESS, 3, err);
}

// Reads the film's thickness: without a texture, the maximum; with a texture, mix(minimum, maximum,
// green). With a texture, the parameter is the greater of the two, and green is converted to a
// factor on the parameter.
static bool read_film_thickness(const struct layer *layer, float *thickness, struct err *err)
{
    const struct range thicknesses = {0, 1e6, false}; // nm; the range of film_thickness
    static const char key[] = "iridescenceThicknessTexture";
    float minimum = 100, maximum = 400;
    if (!gltf_read_float(&layer->node, "iridescenceThicknessMinimum", thicknesses, &minimum, err) ||
        !gltf_read_float(&layer->node, "iridescenceThicknessMaximum", thicknesses, &maximum, err))
        return false;
    bool has_texture = node_member(&layer->node, key).value;
    *thickness = has_texture ? fmaxf(minimum, maximum) : maximum;
    if (*thickness == 0)
        return true;
    const struct gltf_texture_use use = {
        .flags = texture_scales(GROUP_FILM, (const int[]){-1, 1, -1, -1}),
        .green = {minimum / *thickness, maximum / *thickness},
    };
    return gltf_texture_read(layer->reader, &layer->node, key, &use, err);
}

static bool read_iridescence(struct gltf_material_reader *reader, struct err *err)
{
    const struct range iors = {1, 100, false}; // the range of film_ior
    struct material *material = reader->material;
    struct layer layer;
    if (!open_layer(reader, "KHR_materials_iridescence", &layer, err))
        return false;
    material->film_ior = 1.3f;
    return read_number(&layer, "iridescenceFactor", &material->iridescence, err) &&
           read_channel(&layer, "iridescenceTexture", PARAMETER_IRIDESCENCE, 0, err) &&
           gltf_read_float(&layer.node, "iridescenceIor", iors, &material->film_ior, err) &&
           read_film_thickness(&layer, &material->film_thickness, err);
}

// --- the base's reflection -----------------------------------------------------------------------

// An index of 0 stands for infinity, so that only KHR_materials_specular limits the reflectance.
// Exporters convert specular-glossiness materials to this form. The material gets the index 1.5,
// and read_specular() makes the colour relative to its reflectance.
static bool read_ior(struct gltf_material_reader *reader, bool *is_infinite, struct err *err)
{
    const struct range iors = {0, 100, false};
    struct material *material = reader->material;
    struct layer layer;
    float ior = 1.5f;
    if (!open_layer(reader, "KHR_materials_ior", &layer, err) ||
        !gltf_read_float(&layer.node, "ior", iors, &ior, err))
        return false;
    const struct json_node node = node_member(&layer.node, "ior");
    *is_infinite = ior == 0;
    if (ior > 0 && ior < 1)
        return node_fail(&node, err, "%g is between 0 and 1; expected 0 or at least 1",
                         (double)ior);
    material->ior = *is_infinite ? 1.5f : ior;
    return true;
}

static bool read_specular(struct gltf_material_reader *reader, struct err *err)
{
    struct material *material = reader->material;
    struct layer layer;
    bool is_infinite;
    if (!read_ior(reader, &is_infinite, err))
        return false;
    // The range limits the parameter to 1000.
    const struct range colors = {0, is_infinite ? 1e3 * (double)GLTF_REFLECTANCE : 1e3, false};
    if (!open_layer(reader, "KHR_materials_specular", &layer, err) ||
        !node_read_color(&layer.node, "specularColorFactor", colors, material->specular_color,
                         err) ||
        !read_colors(&layer, "specularColorTexture", GROUP_SPECULAR, err) ||
        !read_number(&layer, "specularFactor", &material->specular_weight, err) ||
        !read_channel(&layer, "specularTexture", PARAMETER_SPECULAR_WEIGHT, 3, err))
        return false;
    for (int c = 0; c < 3 && is_infinite; c++)
        material->specular_color[c] /= GLTF_REFLECTANCE;
    return true;
}

// The extension widens the lobe along the tangent, alpha_t = mix(alpha, 1, strength^2), and keeps
// alpha_b = alpha. This program's model has alpha_t = a / aspect and alpha_b = a aspect, where a =
// roughness^2 and aspect^2 = 1 - 0.9 anisotropic (Burley 2012, addendum). With a^2 = alpha_t
// alpha_b and aspect^2 = alpha_b / alpha_t, the two forms agree, unless the ratio is below 1 / 10
// or a texture scales the factors.
static bool read_anisotropy(struct gltf_material_reader *reader, struct err *err)
{
    const struct range turns = {-1e6, 1e6, false}; // radians; larger angles lose precision
    static const char key[] = "anisotropyTexture";
    struct material *material = reader->material;
    struct layer layer;
    float strength = 0;
    double rotation = 0;
    if (!open_layer(reader, "KHR_materials_anisotropy", &layer, err) ||
        !read_number(&layer, "anisotropyStrength", &strength, err) ||
        !node_read_number(&layer.node, "anisotropyRotation", turns, &rotation, err))
        return false;
    if (strength == 0)
        return true;
    double alpha = (double)material->roughness * (double)material->roughness;
    double along = alpha + (1 - alpha) * (double)strength * (double)strength;
    double ratio = alpha / along; // `along` > 0, as strength is
    bool is_textured =
        node_member(&layer.node, key).value || gltf_texture_scales(reader, PARAMETER_ROUGHNESS);
    reader->load->tally.anisotropic += ratio < 0.1 || is_textured;
    material->anisotropic = (float)fmin(1, (1 - ratio) / 0.9);
    material->roughness = (float)pow(alpha * along, 0.25);
    material->anisotropic_rotation = (float)(fmod(rotation, 2 * M_PI) / (2 * M_PI));
    return gltf_texture_read(reader, &layer.node, key,
                             &(struct gltf_texture_use){
                                 .flags = TEXTURE_USE_ANISOTROPY << TEXTURE_USE_SHIFT,
                             },
                             err);
}

// --- through the surface -------------------------------------------------------------------------

static bool read_transmission(struct gltf_material_reader *reader, struct err *err)
{
    struct layer layer;
    return open_layer(reader, "KHR_materials_transmission", &layer, err) &&
           read_number(&layer, "transmissionFactor", &reader->material->transmission, err) &&
           read_channel(&layer, "transmissionTexture", PARAMETER_TRANSMISSION, 0, err);
}

static bool is_same_color(const float a[3], const float b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

// Diffusely transmitted light has the base colour here, while the extension has a separate colour
// for it.
static bool read_diffuse_transmission(struct gltf_material_reader *reader, struct err *err)
{
    static const char key[] = "diffuseTransmissionColorTexture";
    struct material *material = reader->material;
    struct layer layer;
    float color[3] = {1, 1, 1};
    if (!open_layer(reader, "KHR_materials_diffuse_transmission", &layer, err) ||
        !read_number(&layer, "diffuseTransmissionFactor", &material->diffuse_transmission, err) ||
        !read_channel(&layer, "diffuseTransmissionTexture", PARAMETER_DIFFUSE_TRANSMISSION, 3,
                      err) ||
        !node_read_color(&layer.node, "diffuseTransmissionColorFactor", gltf_unit, color, err))
        return false;
    if (material->diffuse_transmission > 0)
        reader->load->tally.translucent += node_member(&layer.node, key).value ||
                                           gltf_texture_scales(reader, PARAMETER_BASE_COLOR) ||
                                           !is_same_color(color, material->base_color);
    return true;
}

// With a thickness, the surface is the boundary of a medium, and rays find the actual thickness.
// Without one, the surface is a thin sheet that does not refract.
static bool read_volume(struct gltf_material_reader *reader, struct err *err)
{
    const struct range lengths = {0, SCENE_COORDINATE_MAX, false};
    const struct range distances = {0, INFINITY, true};
    struct material *material = reader->material;
    struct layer layer;
    float thickness = 0, color[3] = {1, 1, 1}, distance = INFINITY;
    if (!open_layer(reader, "KHR_materials_volume", &layer, err) ||
        !gltf_read_float(&layer.node, "thicknessFactor", lengths, &thickness, err) ||
        !gltf_read_float(&layer.node, "attenuationDistance", distances, &distance, err) ||
        !node_read_color(&layer.node, "attenuationColor", gltf_unit, color, err))
        return false;
    if (material->transmission == 0 && material->diffuse_transmission == 0)
        return true;
    if (thickness == 0) {
        material->flags |= MATERIAL_THIN;
        return true;
    }
    if (distance < INFINITY)
        material_set_absorption(material, color, distance);
    reader->load->tally.translucent_volumes += material->diffuse_transmission > 0;
    return true;
}

static bool read_dispersion(struct gltf_material_reader *reader, struct err *err)
{
    const struct range dispersions = {0, 10, false}; // the range of dispersion
    struct layer layer;
    return open_layer(reader, "KHR_materials_dispersion", &layer, err) &&
           gltf_read_float(&layer.node, "dispersion", dispersions, &reader->material->dispersion,
                           err);
}

bool gltf_material_read_layers(struct gltf_material_reader *reader, struct err *err)
{
    // Each surface that light crosses, entering or leaving, multiplies it by the base colour.
    reader->material->flags |= MATERIAL_TINT_EACH;
    return read_clearcoat(reader, err) && read_sheen(reader, err) &&
           read_iridescence(reader, err) && read_specular(reader, err) &&
           read_anisotropy(reader, err) && read_transmission(reader, err) &&
           read_diffuse_transmission(reader, err) && read_volume(reader, err) &&
           read_dispersion(reader, err);
}
