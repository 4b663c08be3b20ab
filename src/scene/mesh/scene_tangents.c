// Finds the meshes of a scene that need tangents, and the set of texture coordinates for them.
#include "scene/mesh/tangents.h"

#define NO_SET 2u            // no texture coordinates
#define LOOKS_PER_POLL 65536 // materials between two polls for a stop

// Returns the set of texture coordinates that tangents must follow: the set of the normal map, else
// of the anisotropy texture, else set 0 if the material is anisotropic. Returns NO_SET if the
// material needs no tangents.
static uint32_t material_uv_set(const struct scene *scene, uint32_t index)
{
    const struct material *material = &scene->materials[index];
    uint32_t set = material->anisotropic > 0 ? 0 : NO_SET;
    for (uint32_t i = 0; i < material->texture_count; i++) {
        uint32_t flags = scene->textures[material->first_texture + i].flags;
        uint32_t use = flags >> TEXTURE_USE_SHIFT & 3, its_set = flags & TEXTURE_UV1 ? 1 : 0;
        if (use == TEXTURE_USE_NORMAL)
            return its_set;
        if (use == TEXTURE_USE_ANISOTROPY && material->anisotropic > 0)
            set = its_set;
    }
    return set;
}

// Returns the set of the first material among the instance's triangles that needs tangents.
static uint32_t instance_uv_set(const struct scene *scene, const struct instance *instance)
{
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    if (instance->material != SCENE_NONE)
        return material_uv_set(scene, instance->material);
    if (!mesh->triangle_material)
        return material_uv_set(scene, mesh->material);
    uint32_t set = NO_SET, last = SCENE_NONE;
    for (uint32_t t = 0; t < mesh->triangle_count && set == NO_SET; t++) {
        if (mesh->triangle_material[t] != last)
            set = material_uv_set(scene, mesh->triangle_material[t]);
        last = mesh->triangle_material[t];
    }
    return set;
}

bool scene_generate_tangents(struct scene *scene, struct err *err)
{
    uint64_t looked_at = 0;
    for (uint32_t i = 0; i < scene->instance_count; i++) {
        struct mesh *mesh = &scene->meshes[scene->instances[i].mesh];
        if (mesh->tangents || mesh->triangle_count == 0)
            continue;
        looked_at += mesh->triangle_material ? mesh->triangle_count : 1;
        if (looked_at > LOOKS_PER_POLL) {
            looked_at = 0;
            if (!scene_goes_on(scene, 0, err))
                return false;
        }
        uint32_t set = instance_uv_set(scene, &scene->instances[i]);
        if (set != NO_SET && mesh->uvs[set] &&
            !mesh_generate_tangents(mesh, set, scene->progress, &scene->arena, err))
            return err_prepend(err, "%s", scene->path ? scene->path : "scene");
    }
    return true;
}
