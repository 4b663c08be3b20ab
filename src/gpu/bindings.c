// Descriptor sets: the buffers that kernels see.
#include "gpu/gpu_internal.h"

static bool set_create(struct gpu *gpu, struct gpu_bindings *out, struct err *err)
{
    const VkDescriptorPoolSize sizes[] = {
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, gpu->storage_count},
        {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, GPU_MAX_TEXEL},
        {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1},
    };
    const VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = 1,
        .poolSizeCount = 3,
        .pPoolSizes = sizes,
    };
    if (!VK(gpu, err, vkCreateDescriptorPool(gpu->device, &pool, NULL, &out->pool)))
        return false;
    const VkDescriptorSetAllocateInfo set = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = out->pool,
        .descriptorSetCount = 1,
        .pSetLayouts = &gpu->set_layout,
    };
    return VK(gpu, err, vkAllocateDescriptorSets(gpu->device, &set, &out->set));
}

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
                       "buffer %s: a range of %llu bytes at %llu, expected one inside its %llu "
                       "bytes at a multiple of %llu",
                       buffer->name, (unsigned long long)binding->bytes,
                       (unsigned long long)binding->offset, (unsigned long long)buffer->bytes,
                       (unsigned long long)gpu->storage_alignment);
    uint64_t bytes = binding->bytes ? binding->bytes : buffer->bytes - binding->offset;
    if (bytes > gpu->max_storage_range)
        return err_set(err, ERR_GPU,
                       "buffer %s: a storage range of %llu bytes is above the device's limit of "
                       "%llu (maxStorageBufferRange)",
                       buffer->name, (unsigned long long)bytes,
                       (unsigned long long)gpu->max_storage_range);
    *out = (VkDescriptorBufferInfo){buffer->handle, binding->offset, bytes};
    return true;
}

static bool texel_view(const struct gpu_buffer *buffer, const struct gpu_buffer *dummy,
                       VkBufferView *out, struct err *err)
{
    if (buffer && !buffer->texel_view)
        return err_set(err, ERR_BUG, "buffer %s: bound without a texel view", buffer->name);
    *out = buffer ? buffer->texel_view : dummy->texel_view;
    return true;
}

bool gpu_bindings_write(struct gpu *gpu, const struct gpu_binding storage[GPU_MAX_STORAGE],
                        const struct gpu_buffer *const texel[GPU_MAX_TEXEL],
                        const struct gpu_buffer *uniform, struct gpu_bindings *out, struct err *err)
{
    VkDescriptorBufferInfo ranges[GPU_MAX_STORAGE];
    VkBufferView views[GPU_MAX_TEXEL];
    const struct gpu_buffer *constants = uniform ? uniform : &out->dummy;
    const VkDescriptorBufferInfo uniform_range = {constants->handle, 0, constants->bytes};
    for (uint32_t i = 0; i < gpu->storage_count; i++)
        if (!storage_range(gpu, storage ? &storage[i] : &(struct gpu_binding){0}, &out->dummy,
                           &ranges[i], err))
            return false;
    for (uint32_t i = 0; i < GPU_MAX_TEXEL; i++)
        if (!texel_view(texel ? texel[i] : NULL, &out->dummy, &views[i], err))
            return false;

    // A write runs on over the following bindings of the same type and stages.
    const VkWriteDescriptorSet writes[] = {
        {
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = out->set,
            .dstBinding = 0,
            .descriptorCount = GPU_MIN_STORAGE,
            .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
            .pBufferInfo = ranges,
        },
        {
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = out->set,
            .dstBinding = GPU_MIN_STORAGE,
            .descriptorCount = GPU_MAX_TEXEL,
            .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER,
            .pTexelBufferView = views,
        },
        {
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = out->set,
            .dstBinding = GPU_UNIFORM_BINDING,
            .descriptorCount = 1,
            .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
            .pBufferInfo = &uniform_range,
        },
        {
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = out->set,
            .dstBinding = GPU_UNIFORM_BINDING + 1,
            .descriptorCount = gpu->storage_count - GPU_MIN_STORAGE,
            .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
            .pBufferInfo = &ranges[GPU_MIN_STORAGE],
        },
    };
    bool has_more = gpu->storage_count > GPU_MIN_STORAGE;
    vkUpdateDescriptorSets(gpu->device, has_more ? 4 : 3, writes, 0, NULL);
    return true;
}

bool gpu_bindings_create(struct gpu *gpu, const struct gpu_binding storage[GPU_MAX_STORAGE],
                         const struct gpu_buffer *const texel[GPU_MAX_TEXEL],
                         const struct gpu_buffer *uniform, struct gpu_bindings *out,
                         struct err *err)
{
    *out = (struct gpu_bindings){0};
    // One texel: within every device's limits, and a view is needed even where none is used.
    if (buffer_allocate(gpu, "dummy", 16, GPU_DEVICE, true, &out->dummy, err) &&
        buffer_zero(gpu, &out->dummy, err) && set_create(gpu, out, err) &&
        gpu_bindings_write(gpu, storage, texel, uniform, out, err))
        return true;
    gpu_bindings_finish(gpu, out);
    return false;
}

void gpu_bindings_finish(struct gpu *gpu, struct gpu_bindings *bindings)
{
    if (!bindings)
        return;
    if (bindings->pool && !gpu->abandoned)
        vkDestroyDescriptorPool(gpu->device, bindings->pool, NULL); // frees the set
    gpu_buffer_finish(gpu, &bindings->dummy);
    *bindings = (struct gpu_bindings){0};
}
