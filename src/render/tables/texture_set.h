// Lists the textures that the materials in use read. Equal images are uploaded only once, and
// unused ones not at all.
#ifndef LAMPYRIS_RENDER_TABLES_TEXTURE_SET_H
#define LAMPYRIS_RENDER_TABLES_TEXTURE_SET_H

#include "flatten/flatten.h"
#include "gpu/gpu.h"
#include "scene/core/scene.h"
#include "shared/types.h"

struct texture_set {
    struct gpu_texture *records; // one for each of scene->textures; zeroed if unused
    uint32_t *images;            // indices of the scene's images to upload, in the order of upload
    uint64_t *offsets;           // offsets of these images, in units of 16 bytes
    uint32_t image_count;
    uint64_t texel_bytes; // bytes of all uploaded images
    uint64_t saved_bytes; // bytes of images that are unused or equal to others
};

// Builds the set in `arena`. Fails with ERR_INPUT if there are more texels than a 32-bit offset can
// address.
bool texture_set_build(const struct scene *scene, const struct flat_scene *flat,
                       struct arena *arena, struct texture_set *out, struct err *err);
bool texture_set_upload(struct gpu *gpu, const struct scene *scene, const struct texture_set *set,
                        struct gpu_buffer *buffer, struct err *err);

#endif
