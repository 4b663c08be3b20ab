// Completes materials with information that depends on the meshes and images of a glTF document.
#include "scene/gltf/gltf_material.h"

// Returns whether one of the material's textures can make it less opaque.
static bool has_alpha_texture(const struct scene *scene, const struct material *material)
{
    for (uint32_t i = 0; i < material->texture_count; i++) {
        const struct texture *texture = &scene->textures[material->first_texture + i];
        if (texture_scales_parameter(texture, PARAMETER_OPACITY) &&
            scene->images[texture->image].has_alpha)
            return true;
    }
    return false;
}

static bool has_alpha_colors(const struct mesh *mesh)
{
    for (uint32_t i = 0; mesh->colors && i < mesh->vertex_count; i++)
        if (mesh->colors[i][3] < 1)
            return true;
    return false;
}

// Exporters often mark opaque materials as blended. If alpha is 1 everywhere, the flag is removed,
// so that rays need not test it.
static void drop_full_alpha(struct gltf_load *load, const bool *has_colors, uint32_t index)
{
    struct scene *scene = load->scene;
    struct material *material = &scene->materials[load->first_material + index];
    bool is_cut = (material->flags & MATERIAL_ALPHA_MASK) && material->alpha_cutoff > 1;
    if (material->opacity == 1 && !is_cut && !has_colors[index] &&
        !has_alpha_texture(scene, material))
        material->flags &= ~(MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND);
}

static bool lacks_coordinates(const struct scene *scene, const struct mesh *mesh,
                              const struct material *material)
{
    for (uint32_t i = 0; i < material->texture_count; i++) {
        uint32_t flags = scene->textures[material->first_texture + i].flags;
        if (!mesh->uvs[flags & TEXTURE_UV1 ? 1 : 0])
            return true;
    }
    return false;
}

bool gltf_materials_finish(struct gltf_load *load, struct err *err)
{
    struct scene *scene = load->scene;
    uint32_t count = load->document.counts[GLTF_MATERIALS];
    bool *has_colors = ARENA_NEW(&load->document.arena, bool, count);
    if (!has_colors)
        return gltf_no_memory(&load->document, "materials", count, err);
    for (uint32_t i = 0; i < scene->mesh_count; i++) {
        const struct mesh *mesh = &scene->meshes[i];
        // The difference wraps to a large number for materials of other files.
        uint32_t material = mesh->material - load->first_material;
        if (material >= count)
            continue;
        load->tally.meshes_without_texcoords +=
            lacks_coordinates(scene, mesh, &scene->materials[mesh->material]);
        has_colors[material] = has_colors[material] || has_alpha_colors(mesh);
    }
    for (uint32_t i = 0; i < count; i++)
        drop_full_alpha(load, has_colors, i);
    return true;
}
