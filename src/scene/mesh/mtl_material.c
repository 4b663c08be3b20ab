// Makes a material from the statements of an MTL file.
//
// MTL describes shaders of 1995, and exporters express physically based materials in its terms. The
// mapping follows today's exporters (Blender 3.6, after its manual), so that a material survives
// export and import:
//   Pr, Pm, Ps, Pc, aniso, map_Pr or map_Pm: principled, with these and Pcr, Kd, Ks, Ni
//   illum 5, and 3 with a black Kd: a perfect mirror of reflectance Ks
//   illum 4, 6, 7, 9: glass of index Ni and colour Tf
//   illum 3: a metal of colour Kd, weighted by Ka, with the roughness that follows from Ns
//   illum 2 and a Ks: principled, specular = the mean of Ks, with the roughness from Ns
//   all others: Lambert of reflectance Kd
//
// Here roughness = 1 - sqrt(Ns / 1000), Ns at most 1000. d below 1, or map_d, is an opacity. A
// principled material with Ks 0 reflects only as a metal, because neither the shaders of 1995 nor
// Blender's principled material have a highlight then, even at grazing angles. The diffuse part of
// a principled material is Lambert's, and its layers are mixed as in glTF.
#include "scene/mesh/mesh_loader.h"

#include "base/file.h"
#include "base/log.h"
#include "scene/core/texture_load.h"

#include <math.h>
#include <string.h>

void mtl_statements_init(struct mtl_statements *statements, const char *name)
{
    *statements = (struct mtl_statements){
        .name = name,
        .diffuse = {0.5f, 0.5f, 0.5f},
        .specular = {-1, -1, -1},
        .ambient = {-1, -1, -1},
        .filter = {1, 1, 1},
        .exponent = -1,
        .opacity = 1,
        .ior = -1,
        .roughness = -1,
        .metallic = -1,
        .sheen = -1,
        .coat = -1,
        .coat_roughness = -1,
        .anisotropy = -1,
        .anisotropy_rotation = -1,
        .illumination_model = -1,
    };
}

static bool is_black(const float color[3])
{
    return color[0] == 0.0f && color[1] == 0.0f && color[2] == 0.0f;
}

static float mean_of(const float color[3])
{
    return (color[0] + color[1] + color[2]) / 3.0f;
}

static float given(float value, float fallback)
{
    return value >= 0.0f ? value : fallback;
}

static float roughness_of(const struct mtl_statements *read)
{
    const float sharpest = 1000.0f;
    float exponent = fminf(given(read->exponent, 0.0f), sharpest);
    return given(read->roughness, 1.0f - sqrtf(exponent / sharpest));
}

// Returns the index of refraction; that of glass if the file gives 0 or none.
static float ior_of(const struct mtl_statements *read)
{
    return read->ior > 0.01f ? read->ior : 1.5f;
}

static void make_principled(const struct mtl_statements *read, struct material *out)
{
    out->model = MATERIAL_PRINCIPLED;
    out->flags |= MATERIAL_GLTF_LAYERS;
    out->roughness = roughness_of(read);
    out->ior = ior_of(read);
    out->specular = read->specular[0] >= 0.0f ? mean_of(read->specular) : 0.5f;
    out->specular_weight = out->specular > 0.0f ? 1.0f : 0.0f;
    out->metallic = given(read->metallic, 0.0f);
    out->sheen = given(read->sheen, 0.0f);
    out->clearcoat = given(read->coat, 0.0f);
    out->clearcoat_roughness = given(read->coat_roughness, 0.0f);
    out->flags |= out->clearcoat > 0.0f ? MATERIAL_COAT_GGX : 0u;
    out->anisotropic = given(read->anisotropy, 0.0f);
    out->anisotropic_rotation = given(read->anisotropy_rotation, 0.0f);
}

static void make_glass(const struct mtl_statements *read, struct material *out)
{
    make_principled(read, out);
    out->roughness = given(read->roughness, 0.0f);
    out->specular = 0.5f;
    out->specular_weight = 1.0f;
    out->transmission = 1.0f;
    memcpy(out->base_color, read->filter, sizeof out->base_color);
}

void mtl_material_make(const struct mtl_statements *read, struct material *out)
{
    bool is_principled = read->roughness >= 0.0f || read->metallic >= 0.0f || read->sheen >= 0.0f ||
                         read->coat >= 0.0f || read->anisotropy >= 0.0f ||
                         read->maps[MTL_MAP_ROUGHNESS].path || read->maps[MTL_MAP_METALLIC].path;
    int64_t model = read->illumination_model;
    material_init(out);
    out->name = read->name;
    memcpy(out->base_color, read->diffuse, sizeof out->base_color);
    memcpy(out->emission, read->emission, sizeof out->emission);
    out->opacity = read->opacity;
    if (model == 5 || (model == 3 && is_black(read->diffuse))) {
        out->model = MATERIAL_MIRROR;
        for (int c = 0; c < 3; c++)
            out->base_color[c] = given(read->specular[c], 1.0f);
    } else if (model == 4 || model == 6 || model == 7 || model == 9) {
        make_glass(read, out);
        out->opacity = 1.0f; // for glass, d is not an opacity
    } else if (is_principled || (model == 2 && mean_of(read->specular) > 0.0f)) {
        make_principled(read, out);
    } else if (model == 3) {
        make_principled(read, out);
        out->metallic = read->ambient[0] >= 0.0f ? mean_of(read->ambient) : 1.0f;
    }
    if (out->opacity < 1.0f)
        out->flags |= MATERIAL_ALPHA_BLEND;
}

// --- textures ------------------------------------------------------------------------------------

static bool load_image(struct scene *scene, const struct mtl_material *wanted,
                       const struct mtl_map *map, bool is_srgb, bool allow_outside, uint32_t *index,
                       struct err *err)
{
    char *folder = path_folder(&scene->arena, wanted->file);
    if (!folder)
        return err_memory(err, "a path", strlen(wanted->file) + 1);
    const struct file_reference reference = {.folder = folder, .allow_outside = allow_outside};
    const char *path = file_resolve(&scene->arena, &reference, map->path, err);
    const struct texture_source source = {.path = path, .is_srgb = is_srgb};
    return path && texture_image_load(scene, &source, index, err);
}

// Returns whether a bump map contains tangent-space normals, as many exporters write them, rather
// than heights. Normals point outwards on average.
static bool holds_normals(const struct texture_image *image)
{
    return fabsf(image->mean[0] - 0.5f) < 0.2f && fabsf(image->mean[1] - 0.5f) < 0.2f &&
           image->mean[2] > 0.75f;
}

// Applies a map to the material. Returns false if it has no effect.
static bool use_map(enum mtl_map_kind kind, const struct mtl_map *map,
                    const struct texture_image *image, struct material *material,
                    struct texture *texture)
{
    static const struct {
        uint32_t group;
        int channel[4];
    } scales[MTL_MAP_COUNT] = {
        [MTL_MAP_DIFFUSE] = {GROUP_BASE, {0, 1, 2, -1}},
        [MTL_MAP_EMISSION] = {GROUP_EMISSION, {0, 1, 2, -1}},
        [MTL_MAP_ROUGHNESS] = {GROUP_METAL, {-1, 0, -1, -1}},
        [MTL_MAP_METALLIC] = {GROUP_METAL, {-1, -1, 0, -1}},
    };
    const int opacity[4] = {-1, -1, -1, image->has_alpha ? 3 : 0};
    switch (kind) {
    case MTL_MAP_OPACITY:
        texture->flags = texture_scales(GROUP_BASE, opacity);
        material->flags |= MATERIAL_ALPHA_BLEND;
        return true;
    case MTL_MAP_BUMP:
    case MTL_MAP_NORMAL:
        if (kind == MTL_MAP_BUMP && !holds_normals(image))
            return false;
        texture->flags = TEXTURE_USE_NORMAL << TEXTURE_USE_SHIFT;
        material->normal_scale = map->bump_scale;
        return true;
    default:
        texture->flags = texture_scales(scales[kind].group, scales[kind].channel);
        return true;
    }
}

// Sets a black colour or a zero metallic to 1 if a map scales it, because it would otherwise hide
// the map.
static void free_scaled(enum mtl_map_kind kind, struct material *material)
{
    float *color = kind == MTL_MAP_DIFFUSE    ? material->base_color
                   : kind == MTL_MAP_EMISSION ? material->emission
                                              : NULL;
    for (int c = 0; color && is_black(color) && c < 3; c++)
        color[c] = 1.0f;
    if (kind == MTL_MAP_METALLIC && material->metallic == 0.0f)
        material->metallic = 1.0f;
}

static bool add_map(struct scene *scene, const struct mtl_material *wanted, enum mtl_map_kind kind,
                    bool allow_outside, struct material *material, struct err *err)
{
    const struct mtl_map *map = &wanted->maps[kind];
    bool is_color = kind == MTL_MAP_DIFFUSE || kind == MTL_MAP_EMISSION;
    uint32_t image;
    struct err reason = {0};
    if (!load_image(scene, wanted, map, is_color, allow_outside, &image, &reason)) {
        if (reason.code != ERR_INPUT)
            return err_set(err, reason.code, "%s", reason.msg);
        err_prepend(&reason, "%s:%llu", wanted->file, (unsigned long long)map->line);
        struct texture texture = {.flags = texture_scales(GROUP_BASE, (const int[4]){0, 1, 2, -1})};
        return texture_image_missing(scene, &reason, &texture.image, err) &&
               material_add_texture(scene, material, &texture, err);
    }
    // MTL's v points up: t = 1 - (scale v + offset).
    struct texture texture = {
        .image = image,
        .transform = {{map->scale[0], 0, map->offset[0]},
                      {0, map->scale[1], 1.0f - map->scale[1] - map->offset[1]}},
    };
    if (!use_map(kind, map, &scene->images[image], material, &texture)) {
        log_warn("%s:%llu: \"%s\" holds heights; bump maps of heights are not read", wanted->file,
                 (unsigned long long)map->line, map->path);
        return true;
    }
    free_scaled(kind, material);
    uint32_t wrap = map->is_clamped ? TEXTURE_WRAP_CLAMP : TEXTURE_WRAP_REPEAT;
    texture.flags |= wrap << TEXTURE_WRAP_S_SHIFT | wrap << TEXTURE_WRAP_T_SHIFT;
    return material_add_texture(scene, material, &texture, err);
}

bool mtl_material_add(struct scene *scene, struct mtl_material *wanted, bool allow_outside,
                      struct err *err)
{
    struct material *added = scene_add_material(scene, &wanted->scene_index);
    if (!added)
        return err_memory(err, "a material", sizeof *added);
    *added = wanted->material;
    added->name = arena_strdup(&scene->arena, wanted->material.name);
    if (!added->name)
        return err_memory(err, "a material's name", strlen(wanted->material.name) + 1);
    for (int kind = 0; kind < MTL_MAP_COUNT; kind++)
        if (wanted->maps[kind].path &&
            !add_map(scene, wanted, (enum mtl_map_kind)kind, allow_outside, added, err))
            return false;
    return true;
}
