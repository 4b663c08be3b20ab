// Uploads instances in the form that kernels read.
#include "render/upload_parts.h"

#include <string.h>

static void fill_instance(const struct upload_params *p, uint32_t index, struct gpu_instance *out)
{
    const struct flat_instance *instance = &p->flat->instances[index];
    memcpy(out->to_object, instance->to_object, sizeof out->to_object);
    memcpy(out->to_world, instance->to_world, sizeof out->to_world);
    for (int row = 0; row < 3; row++)
        out->to_object[row][3] = instance->to_world[row][3];
    out->root = p->bvh->roots[instance->mesh + 1];
    out->material = instance->material == SCENE_NONE ? NO_MATERIAL
                                                     : upload_material_word(p, instance->material);
    out->id = index;
    out->flags = instance->is_mirrored ? INSTANCE_MIRRORED : 0;
}

void upload_fill_instances(const struct upload_params *p, uint32_t (*words)[4])
{
    for (uint32_t i = 0; i < p->flat->placed_count; i++) {
        struct gpu_instance record;
        fill_instance(p, i, &record);
        memcpy(words[(uint64_t)i * INSTANCE_WORDS], &record, sizeof record);
    }
}
