#include "render/upload_parts.h"

// The minimum size of a buffer, in bytes: one zeroed record. Kernels compiled with a feature that
// the scene lacks may read the record, and multiply its values by 0.
#define SMALLEST_BUFFER 64

bool upload_create(struct gpu *gpu, const struct upload_params *p, uint32_t binding,
                   struct gpu_buffer *buffers, struct err *err)
{
    uint64_t bytes = p->plan->buffers[binding].bytes;
    if (bytes < SMALLEST_BUFFER)
        bytes = SMALLEST_BUFFER;
    bool texel = p->specialization->features & FEATURE_TEXEL_SCENE;
    return gpu_buffer_create(gpu, binding_name(binding), bytes, GPU_DEVICE, texel,
                             &buffers[binding], err);
}

bool upload_filled(struct gpu *gpu, const struct upload_params *p, uint32_t binding,
                   const void *data, struct gpu_buffer *buffers, struct err *err)
{
    uint64_t bytes = p->plan->buffers[binding].bytes;
    return upload_create(gpu, p, binding, buffers, err) &&
           (bytes == 0 || gpu_upload(gpu, &buffers[binding], 0, data, bytes, err));
}

uint32_t upload_material_word(const struct upload_params *p, uint32_t index)
{
    const struct material *material = &p->scene->materials[index];
    bool alpha = material->flags & (MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND);
    return index | material_class(material) << MATERIAL_CLASS_SHIFT |
           (alpha ? MATERIAL_WORD_ALPHA : 0u);
}

uint32_t *upload_emitter_numbers(const struct upload_params *p, uint32_t kind, uint32_t count,
                                 struct arena *scratch)
{
    const struct emitters *emitters = &p->tables->emitters;
    uint32_t *numbers = ARENA_NEW(scratch, uint32_t, count);
    for (uint32_t i = 0; numbers && i < count; i++)
        numbers[i] = NO_EMITTER;
    for (uint32_t n = 0; numbers && n < emitters->surface_count; n++)
        if ((emitters->primitives[n] & PRIMITIVE_SHAPE) == kind)
            numbers[emitters->primitives[n] & ~PRIMITIVE_SHAPE] = n;
    return numbers;
}
