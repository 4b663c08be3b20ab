#include "render/tables/texture_set.h"

#include <string.h>

static uint64_t padded_bytes(const struct texture_image *image)
{
    return (texture_image_bytes(image) + 15u) / 16u * 16u;
}

static bool is_same(const struct texture_image *a, const struct texture_image *b)
{
    return a->hash == b->hash && a->width == b->width && a->height == b->height &&
           !a->values == !b->values;
}

// Returns the offset of an image. Adds the image unless the set already has it, or one with equal
// content.
static uint64_t place_image(const struct scene *scene, struct texture_set *set, uint32_t index)
{
    for (uint32_t i = 0; i < set->image_count; i++)
        if (set->images[i] == index ||
            is_same(&scene->images[set->images[i]], &scene->images[index]))
            return set->offsets[i];
    set->images[set->image_count] = index;
    set->offsets[set->image_count] = set->texel_bytes / 16u;
    set->texel_bytes += padded_bytes(&scene->images[index]);
    return set->offsets[set->image_count++];
}

static uint32_t decoding_flags(const struct texture_image *image)
{
    if (!image->values)
        return TEXTURE_FLOAT;
    return (image->is_srgb ? TEXTURE_SRGB : 0u) | (image->green[1] != 1.0f ? TEXTURE_GREEN : 0u);
}

bool texture_set_build(const struct scene *scene, const struct flat_scene *flat,
                       struct arena *arena, struct texture_set *out, struct err *err)
{
    *out = (struct texture_set){
        .records = ARENA_NEW(arena, struct gpu_texture, scene->texture_count),
        .images = ARENA_NEW(arena, uint32_t, scene->image_count),
        .offsets = ARENA_NEW(arena, uint64_t, scene->image_count),
    };
    if (!out->records || !out->images || !out->offsets)
        return err_memory(err, "textures", scene->texture_count * sizeof *out->records);
    uint64_t all_bytes = 0;
    for (uint32_t i = 0; i < scene->image_count; i++)
        all_bytes += padded_bytes(&scene->images[i]);
    for (uint32_t m = 0; m < scene->material_count; m++) {
        const struct material *material = &scene->materials[m];
        for (uint32_t i = 0; flat->material_used[m] && i < material->texture_count; i++) {
            const struct texture *texture = &scene->textures[material->first_texture + i];
            const struct texture_image *image = &scene->images[texture->image];
            struct gpu_texture *record = &out->records[material->first_texture + i];
            uint64_t offset = place_image(scene, out, texture->image);
            if (offset > UINT32_MAX)
                return err_set(
                    err, ERR_INPUT,
                    "%s: textures take more than 64 GiB; expected fewer or smaller textures",
                    scene->path ? scene->path : "scene");
            record->texels = (uint32_t)offset;
            record->size = image->width | image->height << 16;
            record->flags = texture->flags | decoding_flags(image);
            for (int row = 0; row < 2; row++) {
                memcpy(record->transform[row], texture->transform[row],
                       sizeof texture->transform[row]);
                record->transform[row][3] = image->green[row];
            }
        }
    }
    out->saved_bytes = all_bytes - out->texel_bytes;
    return true;
}

bool texture_set_upload(struct gpu *gpu, const struct scene *scene, const struct texture_set *set,
                        struct gpu_buffer *buffer, struct err *err)
{
    for (uint32_t i = 0; i < set->image_count; i++) {
        const struct texture_image *image = &scene->images[set->images[i]];
        if (!gpu_upload(gpu, buffer, set->offsets[i] * 16u, image->texels,
                        texture_image_bytes(image), err))
            return false;
    }
    return true;
}
