// Declarations shared by the files that upload a scene.
#ifndef LAMPYRIS_RENDER_UPLOAD_PARTS_H
#define LAMPYRIS_RENDER_UPLOAD_PARTS_H

#include "render/upload.h"

// Creates a buffer of the planned size.
bool upload_create(struct gpu *gpu, const struct upload_params *p, uint32_t binding,
                   struct gpu_buffer *buffers, struct err *err);

// Creates a buffer and uploads as many bytes as are planned for it.
bool upload_filled(struct gpu *gpu, const struct upload_params *p, uint32_t binding,
                   const void *data, struct gpu_buffer *buffers, struct err *err);

// Returns the index, class and alpha of a material as primitives store them.
uint32_t upload_material_word(const struct upload_params *p, uint32_t index);

// Returns, for each of `count` primitives whose words are `kind` with their index, its number among
// the emitters or NO_EMITTER. NULL when out of memory.
uint32_t *upload_emitter_numbers(const struct upload_params *p, uint32_t kind, uint32_t count,
                                 struct arena *scratch);

// Uploads the shapes' buffer: shapes, instances, distance fields, small triangles; see
// shared/types.h.
bool upload_shapes(struct gpu *gpu, const struct upload_params *p, struct gpu_buffer *buffers,
                   struct arena *scratch, struct err *err);

// Fills the section of instances, from its first word of four on.
void upload_fill_instances(const struct upload_params *p, uint32_t (*words)[4]);

// Fills the sections of distance fields: a record for each, and the programs of all.
void upload_fill_sdfs(const struct upload_params *p, uint32_t (*records)[4], uint32_t (*code)[4]);

// Fills the section of small triangles.
bool upload_fill_small_triangles(const struct upload_params *p, uint32_t (*words)[4],
                                 struct arena *scratch, struct err *err);

#endif
