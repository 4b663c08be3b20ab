// Declares what the files that upload a scene share.
#ifndef LAMPYRIS_RENDER_UPLOAD_PARTS_H
#define LAMPYRIS_RENDER_UPLOAD_PARTS_H

#include "render/upload.h"

// Creates a buffer of the planned size.
bool upload_create(struct gpu *gpu, const struct upload_params *p, uint32_t binding,
                   struct gpu_buffer *buffers, struct err *err);

// Creates a buffer of the planned size, and uploads that many bytes.
bool upload_filled(struct gpu *gpu, const struct upload_params *p, uint32_t binding,
                   const void *data, struct gpu_buffer *buffers, struct err *err);

// Returns the index, class and alpha mode of a material, packed as primitives store them.
uint32_t upload_material_word(const struct upload_params *p, uint32_t index);

// Returns, for each of `count` primitives, its emitter number or NO_EMITTER. The primitives' words
// are `kind` combined with an index below `count`. NULL when out of memory.
uint32_t *upload_emitter_numbers(const struct upload_params *p, uint32_t kind, uint32_t count,
                                 struct arena *scratch);

// Uploads the buffer that has shapes, instances, distance fields and small triangles; see
// shared/types.h.
bool upload_shapes(struct gpu *gpu, const struct upload_params *p, struct gpu_buffer *buffers,
                   struct arena *scratch, struct err *err);

// Fills the section of instances; `words` is its beginning.
void upload_fill_instances(const struct upload_params *p, uint32_t (*words)[4]);

// Fills the sections of distance fields: a record for each field, and the programs of all fields.
void upload_fill_sdfs(const struct upload_params *p, uint32_t (*records)[4], uint32_t (*code)[4]);

// Fills the section of small triangles.
bool upload_fill_small_triangles(const struct upload_params *p, uint32_t (*words)[4],
                                 struct arena *scratch, struct err *err);

#endif
