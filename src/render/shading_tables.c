#include "shading_tables.h"

#include <math.h>
#include <string.h>

struct media {
    struct gpu_medium records[MEDIA_MAX];
    uint32_t count;
};

// The number of a material's inside, 1 and up; equal media share one.
static bool add_medium(const struct material *material, struct media *media, uint32_t *number,
                       struct err *err)
{
    struct gpu_medium medium = {
        .ior = material->ior,
        .priority = material->medium_priority,
        .dispersion = material->dispersion,
    };
    for (int c = 0; c < 3; c++)
        medium.extinction[c] = fminf(material->extinction[c], 3.4e38f);
    for (uint32_t i = 0; i < media->count; i++) {
        *number = i + 1;
        if (memcmp(&media->records[i], &medium, sizeof medium) == 0)
            return true;
    }
    if (media->count == MEDIA_MAX)
        return err_set(err, ERR_INPUT, "material \"%s\": more than %u different media in a scene",
                       material->name, MEDIA_MAX);
    media->records[media->count++] = medium;
    *number = media->count;
    return true;
}

static uint32_t derived_flags(const struct scene *scene, const struct material *material)
{
    uint32_t flags = material->model | (material->flags & ~MATERIAL_MODEL_MASK);
    flags |= material_has_inside(material) ? MATERIAL_MEDIUM : 0u;
    flags |= material_emits(material) ? MATERIAL_EMITS : 0u;
    for (uint32_t i = 0; i < material->texture_count; i++) {
        uint32_t use = scene->textures[material->first_texture + i].flags >> TEXTURE_USE_SHIFT & 3u;
        flags |= use == TEXTURE_USE_NORMAL ? MATERIAL_NORMAL_MAP : 0u;
    }
    return flags;
}

static bool fill_materials(const struct shading_tables_params *p, const struct emitters *emitters,
                           struct gpu_material *records, struct media *media, struct err *err)
{
    for (uint32_t i = 0; i < p->scene->material_count; i++) {
        const struct material *material = &p->scene->materials[i];
        struct gpu_material *record = &records[i];
        record->model_flags = derived_flags(p->scene, material);
        record->first_texture = material->first_texture;
        record->texture_count = material->texture_count;
        memcpy(record->parameter, material->parameters, sizeof record->parameter);
        record->parameter[PARAMETER_PICK_DENSITY] =
            emitters_pick_density(emitters, p->scene, material);
        if (p->flat->material_used[i] && material_has_inside(material) &&
            !add_medium(material, media, &record->medium, err))
            return false;
    }
    return true;
}

// Sections of the materials' buffer, each of `count` records.
struct sections {
    uint64_t materials, textures, lights, media, albedos, end; // in words of four
};

static struct sections lay_out(const struct scene *scene, uint32_t medium_count,
                               uint64_t albedo_words)
{
    struct sections s = {.materials = MATERIAL_HEADER_WORDS};
    s.textures = s.materials + (uint64_t)scene->material_count * MATERIAL_WORDS;
    s.lights = s.textures + (uint64_t)scene->texture_count * TEXTURE_WORDS;
    s.media = s.lights + (uint64_t)scene->light_count * LIGHT_WORDS;
    s.albedos = s.media + (uint64_t)medium_count * MEDIUM_WORDS;
    s.end = s.albedos + albedo_words;
    return s;
}

bool shading_tables_build(const struct shading_tables_params *p, struct arena *arena,
                          struct shading_tables *out, struct err *err)
{
    *out = (struct shading_tables){0};
    if (!emitters_build(p->scene, p->flat, p->bvh, arena, &out->emitters, err) ||
        !texture_set_build(p->scene, p->flat, arena, &out->textures, err))
        return false;

    struct media media = {0};
    struct gpu_material *materials =
        ARENA_NEW(arena, struct gpu_material, p->scene->material_count);
    if (!materials)
        return err_memory(err, "materials", p->scene->material_count * sizeof *materials);
    if (!fill_materials(p, &out->emitters, materials, &media, err))
        return false;

    struct sections s = lay_out(p->scene, media.count, 0);
    out->material_bytes = s.end * 16u;
    char *bytes = out->materials = arena_alloc(arena, s.end, 16);
    if (!bytes)
        return err_memory(err, "materials", out->material_bytes);
    struct gpu_material_header header = {
        .textures = (uint32_t)s.textures,
        .lights = (uint32_t)s.lights,
        .media = (uint32_t)s.media,
        .albedos = (uint32_t)s.albedos,
        .camera_ior = 1.0f,
    };
    memcpy(bytes, &header, sizeof header);
    memcpy(bytes + s.materials * 16u, materials, p->scene->material_count * sizeof *materials);
    if (p->scene->texture_count > 0)
        memcpy(bytes + s.textures * 16u, out->textures.records,
               p->scene->texture_count * sizeof *out->textures.records);
    if (out->emitters.lights)
        memcpy(bytes + s.lights * 16u, out->emitters.lights,
               p->scene->light_count * sizeof *out->emitters.lights);
    if (media.count > 0)
        memcpy(bytes + s.media * 16u, media.records, media.count * sizeof *media.records);
    return true;
}
