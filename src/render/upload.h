// Uploads the scene's arrays to device memory, in the form that kernels read.
#ifndef LAMPYRIS_RENDER_UPLOAD_H
#define LAMPYRIS_RENDER_UPLOAD_H

#include "render/memory_plan.h"
#include "render/tables/shading_tables.h"

struct upload_params {
    const struct scene *scene;
    const struct flat_scene *flat;
    const struct bvh *bvh;
    const struct specialization *specialization;
    const struct memory_plan *plan;
    const struct shading_tables *tables;
    const struct progress
        *progress; // phase "Uploading", reported for large scenes; NULL: no progress is reported
};

// Creates and fills those of buffers[BINDING_NODES … BINDING_TEXELS] that are planned. The caller
// finishes them, even after a failure.
bool upload_scene(struct gpu *gpu, const struct upload_params *params, struct gpu_buffer *buffers,
                  struct err *err);

#endif
