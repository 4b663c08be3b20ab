#include "render/tables/shading_tables.h"

#include "render/tables/albedo_tables.h"
#include "render/tables/camera_media.h"
#include "scene/core/environment.h"
#include "scene/core/light.h"
#include "scene/sky/ies.h"
#include <float.h>
#include <math.h>
#include <string.h>

struct media {
    struct gpu_medium records[MEDIA_MAX];
    uint32_t count;
};

// Returns the medium inside a material, with lengths in the flat scene's unit.
static struct gpu_medium inside_of(const struct material *material, const struct flat_scene *flat)
{
    struct gpu_medium medium = {
        .ior = material->ior,
        .priority = material->medium_priority,
        .dispersion = material->dispersion,
    };
    for (int c = 0; c < 3; c++)
        medium.extinction[c] =
            (float)fmin((double)material->extinction[c] / flat->scale, (double)FLT_MAX);
    return medium;
}

static bool same_medium(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct gpu_medium)) == 0;
}

// Returns the number of a medium, from 1 on; 0 if it is not listed.
static uint32_t medium_number(const struct media *media, const struct gpu_medium *medium)
{
    for (uint32_t i = 0; i < media->count; i++)
        if (same_medium(&media->records[i], medium))
            return i + 1;
    return 0;
}

// Lists the distinct media in ascending order of priority. If priorities are equal, the medium that
// is listed first counts as lower.
static bool list_media(const struct scene *scene, const struct flat_scene *flat,
                       struct media *media, struct err *err)
{
    for (uint32_t m = 0; m < scene->material_count; m++) {
        const struct material *material = &scene->materials[m];
        if (!flat->material_used[m] || !material_has_inside(material))
            continue;
        const struct gpu_medium medium = inside_of(material, flat);
        if (medium_number(media, &medium))
            continue;
        if (media->count == MEDIA_MAX)
            return err_set(err, ERR_INPUT,
                           "material \"%s\": its medium is one too many; expected at most %u "
                           "different media in a scene",
                           material->name, MEDIA_MAX);
        uint32_t at = media->count++;
        for (; at > 0 && media->records[at - 1].priority > medium.priority; at--)
            media->records[at] = media->records[at - 1];
        media->records[at] = medium;
    }
    return true;
}

static uint32_t derived_flags(const struct scene *scene, const struct material *material)
{
    uint32_t flags = material_shading_model(material) | (material->flags & ~MATERIAL_MODEL_MASK);
    flags |= material_has_inside(material) ? MATERIAL_MEDIUM : 0u;
    flags |= material_emits(material) ? MATERIAL_EMITS : 0u;
    for (uint32_t i = 0; i < material->texture_count; i++) {
        uint32_t use = scene->textures[material->first_texture + i].flags >> TEXTURE_USE_SHIFT & 3u;
        flags |= use == TEXTURE_USE_NORMAL ? MATERIAL_NORMAL_MAP : 0u;
    }
    return flags;
}

static void fill_materials(const struct shading_tables_params *p, const struct emitters *emitters,
                           const struct media *media, struct gpu_material *records)
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
        const struct gpu_medium inside = inside_of(material, p->flat);
        if (material_has_inside(material))
            record->medium = medium_number(media, &inside);
    }
}

// Offsets of the sections of the materials' buffer.
struct sections {
    uint64_t materials, textures, lights, suns, media, profiles, albedos, end; // in uvec4 words
};

static uint32_t count_suns(const struct scene *scene)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->light_count; i++)
        count += light_is_sun(&scene->lights[i]);
    return count;
}

static struct gpu_sun sun_record(const struct light *light, float pick_probability)
{
    struct gpu_sun sun = {.versine = (float)versine(light->angular_radius),
                          .pick_probability = pick_probability};
    for (int c = 0; c < 3; c++) {
        sun.direction[c] = (float)-light->direction[c];
        sun.radiance[c] =
            (float)environment_sun_radiance((double)light->radiant[c], light->angular_radius);
    }
    return sun;
}

static void fill_suns(const struct scene *scene, const struct gpu_light *lights,
                      struct gpu_sun *suns)
{
    for (uint32_t i = 0; i < scene->light_count; i++)
        if (light_is_sun(&scene->lights[i]))
            *suns++ = sun_record(&scene->lights[i], lights[i].pick_probability);
}

static uint64_t profile_words(const struct light_profile *profile)
{
    uint64_t values = (uint64_t)profile->vertical_count + profile->horizontal_count +
                      (uint64_t)profile->vertical_count * profile->horizontal_count;
    return 1 + (values + 3) / 4;
}

static uint64_t count_profile_words(const struct scene *scene)
{
    uint64_t words = 0;
    for (const struct light_profile *p = scene->profiles; p; p = p->next)
        words += profile_words(p);
    return words;
}

// Writes a profile in the form that lib/profile.glsl reads.
static void fill_profile(const struct light_profile *profile, char *bytes)
{
    uint32_t v = profile->vertical_count, h = profile->horizontal_count;
    const uint32_t head[4] = {v, h, 0, 0};
    float *values = (float *)(bytes + sizeof head);
    memcpy(bytes, head, sizeof head);
    memcpy(values, profile->vertical, v * sizeof *values);
    if (h > 1)
        memcpy(values + v, profile->horizontal, h * sizeof *values);
    memcpy(values + v + h, profile->relative, (size_t)v * h * sizeof *values);
}

// Fills the section of profiles, which begins at word `first`, and the members of lights that refer
// to profiles.
static void fill_profiles(const struct scene *scene, uint64_t first, char *bytes,
                          struct gpu_light *lights)
{
    for (const struct light_profile *p = scene->profiles; p; p = p->next) {
        fill_profile(p, bytes + first * 16u);
        for (uint32_t i = 0; i < scene->light_count; i++) {
            if (scene->lights[i].profile != p || scene->lights[i].hidden)
                continue;
            lights[i].profile = (uint32_t)first;
            for (int c = 0; c < 3; c++)
                lights[i].profile_x[c] = (float)scene->lights[i].profile_x[c];
        }
        first += profile_words(p);
    }
}

static struct sections lay_out(const struct scene *scene, uint32_t medium_count,
                               uint64_t albedo_words)
{
    struct sections s = {.materials = MATERIAL_HEADER_WORDS};
    s.textures = s.materials + (uint64_t)scene->material_count * MATERIAL_WORDS;
    s.lights = s.textures + (uint64_t)scene->texture_count * TEXTURE_WORDS;
    s.suns = s.lights + (uint64_t)scene->light_count * LIGHT_WORDS;
    s.media = s.suns + (uint64_t)count_suns(scene) * SUN_WORDS;
    s.profiles = s.media + (uint64_t)medium_count * MEDIUM_WORDS;
    s.albedos = s.profiles + count_profile_words(scene);
    s.end = s.albedos + albedo_words;
    return s;
}

// Returns whether energy compensation applies to this material's transmission by microfacets.
static bool is_compensated_glass(const struct material *m)
{
    bool through = m->model == MATERIAL_DIELECTRIC ||
                   (m->model == MATERIAL_PRINCIPLED && m->transmission > 0.0f);
    bool is_rough = m->roughness * m->roughness >= MATERIAL_SMALLEST_ALPHA || m->texture_count > 0;
    return through && is_rough && (m->flags & MATERIAL_COMPENSATE) != 0u;
}

// Returns how many words of the albedo tables are read to shade a material.
static uint32_t albedo_words_of(const struct material *m)
{
    bool is_principled = material_shading_model(m) == MATERIAL_PRINCIPLED;
    bool is_turned = is_principled && m->anisotropic > 0.0f;
    bool refracts = is_compensated_glass(m) && !(m->flags & MATERIAL_THIN);
    if (is_turned)
        return refracts ? ALBEDO_WORDS : ALBEDO_WORDS_TURNED;
    if (refracts)
        return ALBEDO_WORDS_GLASS;
    if (is_compensated_glass(m))
        return ALBEDO_WORDS_ISOTROPIC;
    bool is_compensated_conductor =
        m->model == MATERIAL_CONDUCTOR && (m->flags & MATERIAL_COMPENSATE) != 0u;
    return is_principled || is_compensated_conductor ? ALBEDO_WORDS_ISOTROPIC : 0u;
}

static uint32_t count_albedo_words(const struct shading_tables_params *p)
{
    uint32_t words = 0;
    for (uint32_t i = 0; i < p->scene->material_count; i++)
        if (p->flat->material_used[i]) {
            uint32_t of_this = albedo_words_of(&p->scene->materials[i]);
            words = of_this > words ? of_this : words;
        }
    return words;
}

bool shading_tables_build(const struct shading_tables_params *p, struct arena *arena,
                          struct shading_tables *out, struct err *err)
{
    *out = (struct shading_tables){0};
    if (!emitters_build(p, arena, &out->emitters, err) ||
        !texture_set_build(p->scene, p->flat, arena, &out->textures, err))
        return false;

    if (progress_should_stop(p->progress))
        return err_set(err, ERR_STOPPED, "stopped while preparing the scene");
    struct media media = {0};
    struct gpu_material *materials =
        ARENA_NEW(arena, struct gpu_material, p->scene->material_count);
    if (!materials)
        return err_memory(err, "materials", p->scene->material_count * sizeof *materials);
    if (!list_media(p->scene, p->flat, &media, err))
        return false;
    fill_materials(p, &out->emitters, &media, materials);

    uint32_t albedo_words = count_albedo_words(p);
    struct sections s = lay_out(p->scene, media.count, albedo_words);
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
        .suns = (uint32_t)s.suns,
        .sun_count = count_suns(p->scene),
    };
    memcpy(bytes, &header, sizeof header);
    memcpy(bytes + s.materials * 16u, materials, p->scene->material_count * sizeof *materials);
    if (p->scene->texture_count > 0)
        memcpy(bytes + s.textures * 16u, out->textures.records,
               p->scene->texture_count * sizeof *out->textures.records);
    if (out->emitters.lights)
        fill_profiles(p->scene, s.profiles, bytes, out->emitters.lights);
    if (out->emitters.lights)
        memcpy(bytes + s.lights * 16u, out->emitters.lights,
               p->scene->light_count * sizeof *out->emitters.lights);
    if (out->emitters.lights)
        fill_suns(p->scene, out->emitters.lights, (struct gpu_sun *)(bytes + s.suns * 16u));
    if (media.count > 0)
        memcpy(bytes + s.media * 16u, media.records, media.count * sizeof *media.records);
    if (albedo_words > 0)
        memcpy(bytes + s.albedos * 16u, albedo_tables, albedo_words * sizeof *albedo_tables);
    out->medium_count = media.count;
    shading_tables_place_camera(p, out);
    return true;
}

bool shading_tables_place_camera(const struct shading_tables_params *p,
                                 struct shading_tables *tables)
{
    if (tables->medium_count == 0)
        return false;
    struct gpu_material_header *header = tables->materials;
    char *bytes = tables->materials;
    const void *materials = bytes + MATERIAL_HEADER_WORDS * 16u;
    const void *media = bytes + header->media * 16u;
    uint32_t stack = camera_media_find(p, materials), highest = 0;
    bool is_other = stack != header->camera_media;
    for (uint32_t shift = 0; shift < 32; shift += 8) {
        uint32_t number = stack >> shift & 255u;
        highest = number > highest ? number : highest;
    }
    header->camera_media = stack;
    header->camera_ior = highest > 0 ? ((const struct gpu_medium *)media)[highest - 1].ior : 1.0f;
    return is_other;
}
