// Materials of a scene file. material_parameters[] lists the parameters; this file adds choices,
// switches and alternative keys.
#include "scene/json/load_json.h"

#include "json/field_json.h"
#include "scene/json/scene_fields.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ONLY(model) (1u << (model))
#define ALL_MODELS ((1u << MATERIAL_MODEL_COUNT) - 1u)
#define THROUGH (ONLY(MATERIAL_PRINCIPLED) | ONLY(MATERIAL_DIELECTRIC))
#define SMITH_ONLY (THROUGH | ONLY(MATERIAL_CONDUCTOR))

// Keys that are not parameters.
static const struct {
    const char *name;
    uint32_t models; // bits 1 << MATERIAL_* of the models that use it
} other_keys[] = {
    {"type", ALL_MODELS},
    {"like", ALL_MODELS},
    {"alpha", ALL_MODELS},
    {"textures", ALL_MODELS},
    {"smoothness", ONLY(MATERIAL_PHONG) | ONLY(MATERIAL_BLINN_PHONG)},
    {"thin", THROUGH},
    {"absorption", THROUGH},
    {"extinction", THROUGH},
    {"priority", THROUGH},
    {"compensate", SMITH_ONLY},
    {"layers", ONLY(MATERIAL_PRINCIPLED)},
    {"specular_fresnel", ONLY(MATERIAL_PRINCIPLED)},
    {"coat_fresnel", ONLY(MATERIAL_PRINCIPLED)},
    {"masking", SMITH_ONLY | ONLY(MATERIAL_MICROFACET)},
    {"metal", ONLY(MATERIAL_CONDUCTOR)},
    {"distribution", ONLY(MATERIAL_MICROFACET)},
    {"fresnel", ONLY(MATERIAL_MICROFACET)},
    {"diffuse", ONLY(MATERIAL_MICROFACET)},
    {"phong_exponent", ONLY(MATERIAL_MICROFACET)},
};
#define OTHER_KEY_COUNT (sizeof other_keys / sizeof *other_keys)

// --- keys ----------------------------------------------------------------------------------------

// The names of the models in a mask of bits 1 << MATERIAL_*, such as "principled, dielectric".
struct model_list {
    char text[128];
};

static struct model_list list_models(uint32_t models)
{
    struct model_list list = {""};
    size_t length = 0;
    for (uint32_t i = 0; i < MATERIAL_MODEL_COUNT; i++) {
        if (!(models & ONLY(i)))
            continue;
        int written = snprintf(list.text + length, sizeof list.text - length, "%s%s",
                               length > 0 ? ", " : "", material_model_names[i]);
        length += (size_t)written;
    }
    return list;
}

// Checks that the key is absent, or that the material's model uses it.
static bool check_model(const struct json_node *material, const char *key, uint32_t model,
                        uint32_t models, struct err *err)
{
    const struct json_node node = node_member(material, key);
    if (!node.value || (models & ONLY(model)))
        return true;
    return node_fail(&node, err, "is not for \"type\": \"%s\"; it is for %s",
                     material_model_names[model], list_models(models).text);
}

// Checks that every key is known and used by the material's model.
static bool check_keys(const struct json_node *node, uint32_t *model, struct err *err)
{
    static const char *const none[] = {NULL};
    const char *known[PARAMETER_COUNT + OTHER_KEY_COUNT + 1] = {NULL};
    size_t count = 0;
    for (size_t i = 0; i < OTHER_KEY_COUNT; i++)
        known[count++] = other_keys[i].name;
    for (uint32_t i = 0; i < material_parameter_count; i++)
        known[count++] = material_parameters[i].name;
    if (!node_check_object(node, none, known, err) ||
        !node_read_choice(node, "type", material_model_names, model, err))
        return false;
    for (size_t i = 0; i < OTHER_KEY_COUNT; i++)
        if (!check_model(node, other_keys[i].name, *model, other_keys[i].models, err))
            return false;
    for (uint32_t i = 0; i < material_parameter_count; i++)
        if (!check_model(node, material_parameters[i].name, *model, material_parameters[i].models,
                         err))
            return false;
    return true;
}

// --- parameters ----------------------------------------------------------------------------------

static bool read_parameters(const struct json_node *node, struct material *material,
                            struct err *err)
{
    for (uint32_t i = 0; i < material_parameter_count; i++) {
        const struct field parameter = scene_parameter_field(i);
        if (!field_read(&parameter, node, material, err))
            return false;
    }
    return true;
}

// Sets the defaults that depend on the model: a mirror reflects everything, glass and metal are
// smooth. The other defaults are in the table.
static void set_fallbacks(struct material *material)
{
    if (material->model == MATERIAL_MIRROR)
        for (int c = 0; c < 3; c++)
            material->base_color[c] = 1.0f;
    if (material->model == MATERIAL_DIELECTRIC || material->model == MATERIAL_CONDUCTOR)
        material->roughness = 0.0f;
}

// Reads "smoothness" s, which sets the exponent of the classical models to 1000^(s^2). On this
// scale, the highlight's width changes perceptually evenly.
static bool read_smoothness(const struct json_node *node, struct material *material,
                            struct err *err)
{
    const struct json_node smoothness = node_member(node, "smoothness");
    double s = 0;
    if (!smoothness.value)
        return true;
    if (node_member(node, "exponent").value)
        return node_fail(node, err, "both \"smoothness\" and \"exponent\" are given; expected one");
    if (!node_read_number(node, "smoothness", RANGE_UNIT, &s, err))
        return false;
    material->exponent = (float)pow(1000, s * s);
    return true;
}

// The complex indices of refraction of copper, gold and silver for red, green and blue, measured by
// P. B. Johnson and R. W. Christy, "Optical Constants of the Noble Metals", Physical Review B 6
// (1972), 4370-4379, at 616.8, 548.6 and 450.9 nm (2.01, 2.26 and 2.75 eV).
static const struct {
    float eta[3], k[3];
} metals[] = {
    {{0.30f, 1.02f, 1.24f}, {3.205f, 2.577f, 2.397f}},
    {{0.21f, 0.43f, 1.38f}, {3.272f, 2.455f, 1.914f}},
    {{0.06f, 0.06f, 0.04f}, {4.152f, 3.586f, 2.657f}},
};

static bool read_metal(const struct json_node *node, struct material *material, struct err *err)
{
    static const char *const names[] = {"copper", "gold", "silver", NULL};
    const struct json_node metal = node_member(node, "metal");
    uint32_t choice = 0;
    if (!metal.value)
        return true;
    if (node_member(node, "conductor_eta").value || node_member(node, "conductor_k").value)
        return node_fail(node, err,
                         "both \"metal\" and \"conductor_eta\" or \"conductor_k\" are given; "
                         "expected one");
    if (!node_choice(&metal, names, &choice, err))
        return false;
    memcpy(material->conductor_eta, metals[choice].eta, sizeof metals[choice].eta);
    memcpy(material->conductor_k, metals[choice].k, sizeof metals[choice].k);
    return true;
}

// --- choices -------------------------------------------------------------------------------------

// Reads "alpha". Materials that may be transparent blend by default.
static bool read_alpha(const struct scene *scene, const struct json_node *node,
                       struct material *material, struct err *err)
{
    static const char *const modes[] = {"opaque", "mask", "blend", NULL};
    static const uint32_t flags[] = {0, MATERIAL_ALPHA_MASK, MATERIAL_ALPHA_BLEND};
    uint32_t mode =
        material->opacity < 1.0f || scene_parameter_is_textured(scene, material, PARAMETER_OPACITY)
            ? 2
            : 0;
    if (!node_read_choice(node, "alpha", modes, &mode, err))
        return false;
    const struct json_node cutoff = node_member(node, "alpha_cutoff");
    if (cutoff.value && flags[mode] != MATERIAL_ALPHA_MASK)
        return node_fail(&cutoff, err, "requires \"alpha\": \"mask\"");
    material->flags |= flags[mode];
    return true;
}

// Reads the masking function: Smith's joint or separable function, or for the microfacet model, one
// of several others.
static bool read_masking(const struct json_node *node, struct material *material, struct err *err)
{
    static const char *const names[] = {
        "smith",   "separable",        "schlick_ggx",        "lh", "rational",
        "schlick", "schlick_remapped", "rational_unbounded", NULL};
    static const uint32_t flags[] = {
        MASKING_SMITH << MATERIAL_MASKING_SHIFT,
        MASKING_SMITH << MATERIAL_MASKING_SHIFT | MATERIAL_SEPARABLE,
        MASKING_SCHLICK_GGX << MATERIAL_MASKING_SHIFT,
        MASKING_LH << MATERIAL_MASKING_SHIFT,
        MASKING_RATIONAL << MATERIAL_MASKING_SHIFT,
        MASKING_SCHLICK << MATERIAL_MASKING_SHIFT,
        MASKING_SCHLICK_REMAPPED << MATERIAL_MASKING_SHIFT,
        MASKING_RATIONAL_UNBOUNDED << MATERIAL_MASKING_SHIFT,
    };
    static const char *const smith_names[] = {"smith", "separable", NULL};
    bool has_all = material->model == MATERIAL_MICROFACET;
    uint32_t choice = 0;
    if (!node_read_choice(node, "masking", has_all ? names : smith_names, &choice, err))
        return false;
    material->flags |= flags[choice];
    return true;
}

// Reads the coat. "clearcoat_roughness" selects glTF's coat instead of Burley's.
static bool read_coat(const struct json_node *node, struct material *material, struct err *err)
{
    if (!node_member(node, "clearcoat_roughness").value)
        return true;
    if (node_member(node, "clearcoat_gloss").value)
        return node_fail(node, err,
                         "both \"clearcoat_roughness\" and \"clearcoat_gloss\" are given; expected "
                         "one, which chooses the coat");
    material->flags |= MATERIAL_COAT_GGX;
    return true;
}

// Reads the exponent of Phong's distribution of normals, which replaces the roughness.
static bool read_phong_exponent(const struct json_node *node, struct material *material,
                                struct err *err)
{
    const struct json_node exponent = node_member(node, "phong_exponent");
    double n = 0;
    if (!exponent.value)
        return true;
    if (node_member(node, "roughness").value)
        return node_fail(node, err,
                         "both \"phong_exponent\" and \"roughness\" are given; expected one");
    if ((material->flags >> MATERIAL_DISTRIBUTION_SHIFT & 3u) != DISTRIBUTION_PHONG)
        return node_fail(&exponent, err, "requires \"distribution\": \"phong\"");
    if (!node_number(&exponent, (struct range){0, 1e6, false}, &n, err))
        return false;
    material->roughness = (float)material_phong_roughness(n);
    return true;
}

// Reads the choices and switches that material_flags[] describes completely.
static bool read_flags(const struct json_node *node, struct material *material, struct err *err)
{
    static const char *const keys[] = {"layers",  "thin",    "compensate",       "distribution",
                                       "fresnel", "diffuse", "specular_fresnel", "coat_fresnel"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        if (!field_read(material_flag(keys[i]), node, material, err))
            return false;
    return true;
}

// --- the medium ----------------------------------------------------------------------------------

static bool read_absorption(const struct json_node *node, struct material *material,
                            struct err *err)
{
    static const char *const none[] = {NULL};
    static const char *const required[] = {"color", "distance", NULL};
    float color[3];
    double distance = 0;
    if (!node_check_object(node, required, none, err) ||
        !node_read_color(node, "color", RANGE_UNIT, color, err) ||
        !node_read_number(node, "distance", RANGE_RADIUS, &distance, err))
        return false;
    material_set_absorption(material, color, (float)distance);
    return true;
}

static bool read_inside(const struct json_node *node, struct material *material, struct err *err)
{
    const struct json_node absorption = node_member(node, "absorption");
    const struct json_node extinction = node_member(node, "extinction");
    const struct json_node priority = node_member(node, "priority");
    const struct json_node *given[] = {&absorption, &extinction, &priority};
    if (absorption.value && extinction.value)
        return node_fail(node, err,
                         "both \"absorption\" and \"extinction\" are given; expected one");
    for (size_t i = 0; i < sizeof given / sizeof *given; i++)
        if (given[i]->value && (material->flags & MATERIAL_THIN))
            return node_fail(given[i], err, "a \"thin\" material has no inside");
    uint64_t number = material->medium_priority;
    if ((absorption.value && !read_absorption(&absorption, material, err)) ||
        !node_read_color(node, "extinction", RANGE_RADIANCE, material->extinction, err) ||
        !node_read_integer(node, "priority", 1, 255, &number, err))
        return false;
    material->medium_priority = (uint32_t)number;
    return true;
}

// --- the list ------------------------------------------------------------------------------------

static bool read_material(struct json_loader *loader, const struct json_node *node,
                          struct material *material, struct err *err)
{
    if (!check_keys(node, &material->model, err))
        return false;
    set_fallbacks(material);
    return read_parameters(node, material, err) && read_smoothness(node, material, err) &&
           read_metal(node, material, err) && load_json_textures(loader, node, material, err) &&
           read_alpha(loader->scene, node, material, err) && read_coat(node, material, err) &&
           read_flags(node, material, err) && read_masking(node, material, err) &&
           read_phong_exponent(node, material, err) && read_inside(node, material, err);
}

// If a material is "like" an earlier one, adds the earlier material's keys that it does not set
// itself. The values are shared, so that paths in them stay trusted if the user gave them.
static bool inherit(struct json_loader *loader, const struct json_node *materials,
                    struct json_node *node, struct err *err)
{
    const char *other = NULL;
    if (!json_is_object(node->value))
        return true; // reported later
    if (!node_read_string(node, "like", &other, err))
        return false;
    if (!other)
        return true;
    const struct json_node like = node_member(node, "like");
    if (!json_object_get(loader->material_names, other))
        return node_fail(&like, err, "there is no earlier material %s%s",
                         node_describe(like.value).text,
                         node_suggest_key(other, loader->material_names).text);
    json_t *merged = json_copy(json_object_get(materials->value, other));
    bool ok = merged && json_object_update(merged, node->value) == 0 &&
              json_object_set(materials->value, node->key, merged) == 0;
    node->value = merged;
    json_decref(merged); // the document now owns it
    return ok || err_memory(err, "a material's keys", sizeof *merged);
}

bool load_json_materials(struct json_loader *loader, const struct json_node *materials,
                         struct err *err)
{
    if (!json_is_object(materials->value))
        return node_unexpected(materials, "an object of materials by name", err);
    struct scene *scene = loader->scene;
    const char *name;
    json_t *value;
    json_object_foreach(materials->value, name, value)
    {
        if (strcmp(name, "comment") == 0)
            continue;
        struct json_node node = node_member(materials, name);
        if (!inherit(loader, materials, &node, err))
            return false;
        uint32_t index;
        struct material *material = scene_add_material(scene, &index);
        if (!material || !(material->name = arena_strdup(&scene->arena, name)) ||
            json_object_set_new(loader->material_names, name, json_integer(index)) != 0)
            return err_memory(err, "a material", sizeof *material);
        if (!node_check_name(&node, name, err) || !read_material(loader, &node, material, err))
            return false;
    }
    return true;
}
