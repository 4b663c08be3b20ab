// Helpers for the tests of the gpu layer: opening a device or skipping, the element-wise copy
// kernel between buffers, and a log sink that counts.
#ifndef LAMPYRIS_TESTS_GPU_FIXTURE_H
#define LAMPYRIS_TESTS_GPU_FIXTURE_H

#include "base/log.h"
#include "open_gpu.h"

#include "copy_test.spv.h" // needs stdint.h

#define GROUP 64u

struct copy_push {
    uint32_t count, addend;
};

static inline bool copy_kernel_create(struct gpu *gpu, uint32_t factor, bool texel,
                                      struct gpu_kernel *out, struct err *err)
{
    const uint32_t constants[] = {GROUP, factor, texel};
    const struct gpu_kernel_params params = {
        .name = "copy",
        .spirv = copy_spirv,
        .spirv_bytes = sizeof copy_spirv,
        .constants = constants,
        .constant_count = 3,
    };
    return gpu_kernel_create(gpu, &params, out, err);
}

// `from` is also bound as a texel buffer if it has a texel view.
static inline bool pair_bindings_create(struct gpu *gpu, const struct gpu_buffer *from,
                                        const struct gpu_buffer *to, struct gpu_bindings *out,
                                        struct err *err)
{
    const struct gpu_binding storage[GPU_MAX_STORAGE] = {{.buffer = from}, {.buffer = to}};
    const struct gpu_buffer *const texel[GPU_MAX_TEXEL] = {from->texel_view ? from : NULL};
    return gpu_bindings_create(gpu, storage, texel, NULL, out, err);
}

static inline uint32_t groups_for(uint32_t count)
{
    return (count + GROUP - 1) / GROUP;
}

static inline uint32_t element(uint32_t i)
{
    return i * 2654435761u; // Knuth's multiplicative hash, so that neighbours differ
}

static inline uint32_t *elements_new(uint32_t count)
{
    uint32_t *out = malloc(count * sizeof *out);
    for (uint32_t i = 0; out && i < count; i++)
        out[i] = element(i);
    return out;
}

#endif
