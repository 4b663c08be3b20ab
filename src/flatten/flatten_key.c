// Hashes everything that determines the result of flattening.
#include "base/hash.h"
#include "flatten/flatten_census.h"

static uint64_t add(uint64_t key, const void *data, size_t count, size_t size)
{
    const struct hash128 hash = hash128_bytes(data, count * size);
    return hash_bytes(key, &hash, sizeof hash);
}

uint64_t flatten_key(const struct flatten_params *params)
{
    const struct scene *scene = params->scene;
    uint64_t key = hash_bytes(HASH_INIT, &params->instancing, sizeof params->instancing);
    for (uint32_t i = 0; i < scene->material_count; i++) {
        const uint32_t said[3] = {
            flatten_emits(scene, i),
            attributes_of_material(scene, i),
            scene->materials[i].texture_count > 0,
        };
        key = hash_bytes(key, said, sizeof said);
    }
    key = add(key, scene->meshes, scene->mesh_count, sizeof *scene->meshes);
    for (uint32_t i = 0; i < scene->mesh_count; i++) {
        const struct mesh *mesh = &scene->meshes[i];
        if (mesh->triangle_material)
            key = add(key, mesh->triangle_material, mesh->triangle_count,
                      sizeof *mesh->triangle_material);
    }
    key = add(key, scene->instances, scene->instance_count, sizeof *scene->instances);
    return add(key, scene->shapes, scene->shape_count, sizeof *scene->shapes);
}
