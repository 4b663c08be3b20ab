// Creates the bindings of kernels: the buffers that they read and write.
#include "gpu/gpu_internal.h"

#include "base/memory.h"

static bool storage_range(const struct gpu *gpu, const struct gpu_binding *binding,
                          const struct gpu_buffer *dummy, VkDescriptorBufferInfo *out,
                          struct err *err)
{
    const struct gpu_buffer *buffer = binding->buffer;
    if (!buffer) {
        *out = (VkDescriptorBufferInfo){dummy->handle, 0, dummy->bytes};
        return true;
    }
    if (binding->offset >= buffer->bytes || binding->bytes > buffer->bytes - binding->offset ||
        binding->offset % gpu->storage_alignment != 0)
        return err_set(err, ERR_BUG,
                       "buffer %s: a range of %llu bytes at offset %llu; expected a range inside "
                       "its %llu bytes at a multiple of %llu",
                       buffer->name, (unsigned long long)binding->bytes,
                       (unsigned long long)binding->offset, (unsigned long long)buffer->bytes,
                       (unsigned long long)gpu->storage_alignment);
    uint64_t bytes = binding->bytes ? binding->bytes : buffer->bytes - binding->offset;
    if (bytes > gpu->max_storage_range)
        return err_set(err, ERR_GPU,
                       "buffer %s: a storage range of %s is above the device's limit of %s "
                       "(maxStorageBufferRange)",
                       buffer->name, memory_print(bytes).text,
                       memory_print(gpu->max_storage_range).text);
    *out = (VkDescriptorBufferInfo){buffer->handle, binding->offset, bytes};
    return true;
}

static bool texel_view(const struct gpu_buffer *buffer, const struct gpu_buffer *dummy,
                       VkBufferView *out, struct err *err)
{
    if (buffer && !buffer->texel_view)
        return err_set(err, ERR_BUG,
                       "buffer %s: it is bound as a texel buffer but has no texel view",
                       buffer->name);
    *out = buffer ? buffer->texel_view : dummy->texel_view;
    return true;
}

bool gpu_bindings_write(struct gpu *gpu, const struct gpu_binding storage[GPU_MAX_STORAGE],
                        const struct gpu_buffer *const texel[GPU_MAX_TEXEL],
                        const struct gpu_buffer *uniform, struct gpu_bindings *out, struct err *err)
{
    const struct gpu_buffer *constants = uniform ? uniform : &out->dummy;
    out->uniform = (VkDescriptorBufferInfo){constants->handle, 0, constants->bytes};
    for (uint32_t i = 0; i < GPU_MAX_STORAGE; i++)
        if (!storage_range(gpu, storage ? &storage[i] : &(struct gpu_binding){0}, &out->dummy,
                           &out->storage[i], err))
            return false;
    for (uint32_t i = 0; i < GPU_MAX_TEXEL; i++)
        if (!texel_view(texel ? texel[i] : NULL, &out->dummy, &out->texel[i], err))
            return false;
    sets_expire(out->sets);
    return true;
}

bool gpu_bindings_create(struct gpu *gpu, const struct gpu_binding storage[GPU_MAX_STORAGE],
                         const struct gpu_buffer *const texel[GPU_MAX_TEXEL],
                         const struct gpu_buffer *uniform, struct gpu_bindings *out,
                         struct err *err)
{
    *out = (struct gpu_bindings){0};
    // One texel is within every device's limit. The dummy needs a texel view because every binding
    // must be valid, even one that no kernel uses.
    if (buffer_allocate(gpu, "dummy", 16, GPU_DEVICE, true, &out->dummy, err) &&
        buffer_zero(gpu, &out->dummy, err) &&
        gpu_bindings_write(gpu, storage, texel, uniform, out, err))
        return true;
    gpu_bindings_finish(gpu, out);
    return false;
}

void gpu_bindings_finish(struct gpu *gpu, struct gpu_bindings *bindings)
{
    if (!bindings)
        return;
    sets_destroy(gpu, bindings->sets);
    gpu_buffer_finish(gpu, &bindings->dummy);
    *bindings = (struct gpu_bindings){0};
}
