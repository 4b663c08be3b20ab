// The scene's arrays in the form that kernels read, in device memory.
#ifndef LAMPYRIS_RENDER_UPLOAD_H
#define LAMPYRIS_RENDER_UPLOAD_H

#include "memory_plan.h"

struct upload_params {
    const struct scene *scene;
    const struct flat_scene *flat;
    const struct bvh *bvh;
    const struct specialization *specialization;
    const struct memory_plan *plan;
};

// Creates and fills buffers[BINDING_NODES … BINDING_ENVIRONMENT] as far as they are planned. The
// caller finishes them, also on failure. *emitter_count: entries of the emitters' alias table.
bool upload_scene(struct gpu *gpu, const struct upload_params *params, struct gpu_buffer *buffers,
                  uint32_t *emitter_count, struct err *err);

// The octahedral code that shaders decode (lib/surface.glsl); never NORMAL_FLAT.
uint32_t encode_normal(const float n[3]);

#endif
