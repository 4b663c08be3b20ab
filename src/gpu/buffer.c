// Creates buffers. Each has a memory allocation of its own.
#include "gpu/gpu_internal.h"

#include "base/memory.h"
#include <stdio.h>
#include <string.h>

#define TEXEL_BYTES 16 // RGBA32_UINT

#define HOST_FLAGS (VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT)
#define MAPPED_FLAGS (HOST_FLAGS | VK_MEMORY_PROPERTY_HOST_CACHED_BIT)

// Rounds up to whole texels, so that the last one can be read, and to whole words, as
// vkCmdFillBuffer requires. Returns 0 on overflow.
static uint64_t padded_bytes(uint64_t bytes)
{
    return (bytes + (TEXEL_BYTES - 1)) & ~(uint64_t)(TEXEL_BYTES - 1);
}

bool gpu_texel_fits(const struct gpu *gpu, uint64_t bytes)
{
    return gpu->max_texel_elements > 0 && bytes <= UINT64_MAX - TEXEL_BYTES &&
           padded_bytes(bytes) / TEXEL_BYTES <= gpu->max_texel_elements;
}

// Returns the first memory type that has all required flags and the most preferred ones; among
// equal types the specification lists faster ones first. Skips types with other flags (protected,
// lazily allocated, vendor-specific), which need features that are not enabled. Returns UINT32_MAX
// if there is none.
static uint32_t memory_type_find(const struct gpu *gpu, uint32_t allowed_types,
                                 VkMemoryPropertyFlags required, VkMemoryPropertyFlags preferred,
                                 VkMemoryPropertyFlags *flags)
{
    const VkMemoryPropertyFlags known = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | MAPPED_FLAGS;
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(gpu->physical, &memory);
    uint32_t best = UINT32_MAX;
    int best_score = -1;
    for (uint32_t i = 0; i < memory.memoryTypeCount; i++) {
        VkMemoryPropertyFlags has = memory.memoryTypes[i].propertyFlags;
        int score = __builtin_popcount(has & preferred);
        if ((allowed_types >> i & 1) && (has & required) == required && !(has & ~known) &&
            score > best_score) {
            best = i;
            best_score = score;
            *flags = has;
        }
    }
    return best;
}

// Host-visible memory of a discrete GPU is accessed over the bus: reads are slow, and there may be
// little of it. So only memory that the device shares with the host is mapped.
static VkMemoryPropertyFlags preferred_flags(const struct gpu *gpu, enum gpu_memory memory)
{
    if (memory == GPU_READBACK)
        return VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    return VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | (gpu->info.shares_memory ? MAPPED_FLAGS : 0);
}

static VkResult memory_call(struct gpu *gpu, uint64_t bytes, uint32_t type, VkDeviceMemory *out)
{
    uint64_t most = gpu->params.limits.memory;
    bool is_refused =
        most && bytes > most - (gpu->allocated_bytes < most ? gpu->allocated_bytes : most);
    if (++gpu->allocation_count == gpu->params.fail_allocation || is_refused)
        return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    const VkMemoryAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = bytes,
        .memoryTypeIndex = type,
    };
    return vkAllocateMemory(gpu->device, &info, NULL, out);
}

void memory_count(struct gpu *gpu, uint64_t bytes)
{
    gpu->allocated_bytes += bytes;
    if (gpu->allocated_bytes > gpu->peak_bytes)
        gpu->peak_bytes = gpu->allocated_bytes;
}

static bool too_large(struct err *err)
{
    return err_set(err, ERR_GPU, "the size is above the device's limit of one allocation");
}

bool memory_allocate(struct gpu *gpu, const VkMemoryRequirements *needs, enum gpu_memory memory,
                     VkMemoryPropertyFlags *flags, VkDeviceMemory *out, struct err *err)
{
    if (needs->size > gpu->max_allocation)
        return too_large(err);
    uint32_t type =
        memory_type_find(gpu, needs->memoryTypeBits, memory == GPU_READBACK ? HOST_FLAGS : 0,
                         preferred_flags(gpu, memory), flags);
    if (type == UINT32_MAX)
        return err_set(err, ERR_GPU, "no memory type of the device has the required properties");
    VkResult result = memory_call(gpu, needs->size, type, out);
    return result == VK_SUCCESS || gpu_fail(gpu, "vkAllocateMemory", result, err);
}

static bool memory_create(struct gpu *gpu, struct gpu_buffer *buffer, enum gpu_memory memory,
                          struct err *err)
{
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(gpu->device, buffer->handle, &needs);
    VkMemoryPropertyFlags flags = 0;
    if (!memory_allocate(gpu, &needs, memory, &flags, &buffer->memory, err) ||
        !VK(gpu, err, vkBindBufferMemory(gpu->device, buffer->handle, buffer->memory, 0)))
        return false;
    bool map = memory == GPU_READBACK ||
               ((flags & MAPPED_FLAGS) == MAPPED_FLAGS && !gpu->params.limits.no_mapped_device);
    return !map ||
           VK(gpu, err,
              vkMapMemory(gpu->device, buffer->memory, 0, VK_WHOLE_SIZE, 0, &buffer->mapped));
}

static bool texel_view_create(struct gpu *gpu, struct gpu_buffer *buffer, struct err *err)
{
    const VkBufferViewCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
        .buffer = buffer->handle,
        .format = VK_FORMAT_R32G32B32A32_UINT,
        .range = VK_WHOLE_SIZE,
    };
    return VK(gpu, err, vkCreateBufferView(gpu->device, &info, NULL, &buffer->texel_view));
}

static bool handle_create(struct gpu *gpu, struct gpu_buffer *buffer, struct err *err)
{
    const VkBufferUsageFlags drawn =
        VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT;
    const VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = padded_bytes(buffer->bytes),
        .usage = (gpu->params.graphics ? drawn : 0) | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                 VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                 VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                 VK_BUFFER_USAGE_TRANSFER_DST_BIT,
        .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
    };
    return VK(gpu, err, vkCreateBuffer(gpu->device, &info, NULL, &buffer->handle));
}

static void handles_destroy(struct gpu *gpu, struct gpu_buffer *buffer)
{
    if (!gpu->abandoned) {
        vkDestroyBufferView(gpu->device, buffer->texel_view, NULL);
        vkDestroyBuffer(gpu->device, buffer->handle, NULL);
        vkFreeMemory(gpu->device, buffer->memory, NULL); // unmaps the memory, too
    }
    *buffer = (struct gpu_buffer){0};
}

bool buffer_allocate(struct gpu *gpu, const char *name, uint64_t bytes, enum gpu_memory memory,
                     bool texel, struct gpu_buffer *out, struct err *err)
{
    *out = (struct gpu_buffer){.bytes = bytes ? bytes : TEXEL_BYTES, .name = name};
    // Sizes above the limits are rejected here, because drivers differ in what Vulkan calls do with
    // them.
    bool fits = out->bytes <= gpu->max_allocation && out->bytes <= UINT64_MAX - TEXEL_BYTES;
    if (!(fits || too_large(err)) || !handle_create(gpu, out, err) ||
        !memory_create(gpu, out, memory, err) || (texel && !texel_view_create(gpu, out, err))) {
        err_prepend(err, "buffer %s, %s (in use: %s; largest allocation: %s)", name,
                    memory_print(out->bytes).text, memory_print(gpu->allocated_bytes).text,
                    memory_print(gpu->max_allocation).text);
        handles_destroy(gpu, out);
        return false;
    }
    DEBUG_NAME(gpu, BUFFER, out->handle, name);
    memory_count(gpu, padded_bytes(out->bytes));
    return true;
}

bool gpu_buffer_create(struct gpu *gpu, const char *name, uint64_t bytes, enum gpu_memory memory,
                       bool texel, struct gpu_buffer *out, struct err *err)
{
    *out = (struct gpu_buffer){0};
    if (texel && !gpu_texel_fits(gpu, bytes))
        return err_set(err, ERR_GPU,
                       "buffer %s: %s are above the device's limit of %llu texels of %d bytes "
                       "(maxTexelBufferElements)",
                       name, memory_print(bytes).text, (unsigned long long)gpu->max_texel_elements,
                       TEXEL_BYTES);
    if (!buffer_allocate(gpu, name, bytes, memory, texel, out, err))
        return false;
    if (!buffer_zero(gpu, out, err)) {
        gpu_buffer_finish(gpu, out);
        return false;
    }
    return true;
}

void gpu_buffer_finish(struct gpu *gpu, struct gpu_buffer *buffer)
{
    if (!buffer || !buffer->handle)
        return;
    gpu->allocated_bytes -= padded_bytes(buffer->bytes);
    handles_destroy(gpu, buffer);
}
