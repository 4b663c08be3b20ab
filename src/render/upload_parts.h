// What the parts of upload_scene() share.
#ifndef LAMPYRIS_RENDER_UPLOAD_PARTS_H
#define LAMPYRIS_RENDER_UPLOAD_PARTS_H

#include "render/upload.h"

// Creates a buffer of the size that is planned for it.
bool upload_create(struct gpu *gpu, const struct upload_params *p, uint32_t binding,
                   struct gpu_buffer *buffers, struct err *err);

// Creates a buffer and uploads as many bytes as are planned for it.
bool upload_filled(struct gpu *gpu, const struct upload_params *p, uint32_t binding,
                   const void *data, struct gpu_buffer *buffers, struct err *err);

// Index, class and alpha of a material, as primitives carry it.
uint32_t upload_material_word(const struct upload_params *p, uint32_t index);

// For each of `count` primitives, whose words are `kind` and their index, its number among the
// emitters, or NO_EMITTER. NULL when out of memory.
uint32_t *upload_emitter_numbers(const struct upload_params *p, uint32_t kind, uint32_t count,
                                 struct arena *scratch);

// The shapes' buffer: shapes, instances, distance fields, small triangles; see shared/types.h.
bool upload_shapes(struct gpu *gpu, const struct upload_params *p, struct gpu_buffer *buffers,
                   struct arena *scratch, struct err *err);

// The section of instances, from its first word of four on.
void upload_fill_instances(const struct upload_params *p, uint32_t (*words)[4]);

// The sections of distance fields: a record for each shape that is one, the programs of all.
void upload_fill_sdfs(const struct upload_params *p, uint32_t (*records)[4], uint32_t (*code)[4]);

// The section of small triangles.
bool upload_fill_small_triangles(const struct upload_params *p, uint32_t (*words)[4],
                                 struct arena *scratch, struct err *err);

#endif
