// Creates descriptor sets. Each set has the buffers of a struct gpu_bindings that the kernels of
// one layout use.
#include "gpu/gpu_internal.h"
#include <stdlib.h>

// The number of descriptor sets per pool.
#define POOL_SETS 8

struct gpu_sets {
    VkDescriptorPool pool;
    struct {
        const struct gpu_layout *layout;
        VkDescriptorSet handle;
        bool is_written; // the set refers to the current buffers
    } list[POOL_SETS];
    uint32_t count;
    struct gpu_sets *next;
};

static void set_write(struct gpu *gpu, const struct gpu_bindings *bindings, uint64_t wanted,
                      VkDescriptorSet set)
{
    VkWriteDescriptorSet writes[GPU_MAX_BINDINGS];
    uint32_t count = 0;
    for (uint32_t i = 0; i < GPU_MAX_BINDINGS; i++) {
        if (!(wanted >> i & 1))
            continue;
        VkWriteDescriptorSet *write = &writes[count++];
        *write = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = set,
            .dstBinding = i,
            .descriptorCount = 1,
            .descriptorType = binding_type(i),
        };
        if (i < GPU_FIRST_STORAGE)
            write->pBufferInfo = &bindings->storage[i];
        else if (i < GPU_UNIFORM_BINDING)
            write->pTexelBufferView = &bindings->texel[i - GPU_FIRST_STORAGE];
        else if (i == GPU_UNIFORM_BINDING)
            write->pBufferInfo = &bindings->uniform;
        else
            write->pBufferInfo = &bindings->storage[i - GPU_MAX_TEXEL - 1];
    }
    vkUpdateDescriptorSets(gpu->device, count, writes, 0, NULL);
}

static bool sets_create(struct gpu *gpu, struct gpu_bindings *bindings, struct err *err)
{
    const VkDescriptorPoolSize sizes[] = {
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, POOL_SETS * GPU_MAX_STORAGE},
        {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, POOL_SETS * GPU_MAX_TEXEL},
        {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, POOL_SETS},
    };
    const VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = POOL_SETS,
        .poolSizeCount = 3,
        .pPoolSizes = sizes,
    };
    struct gpu_sets *sets = calloc(1, sizeof *sets);
    if (!sets)
        return err_memory(err, "descriptor sets", sizeof *sets);
    if (!VK(gpu, err, vkCreateDescriptorPool(gpu->device, &pool, NULL, &sets->pool))) {
        free(sets);
        return false;
    }
    sets->next = bindings->sets;
    bindings->sets = sets;
    return true;
}

static bool set_create(struct gpu *gpu, struct gpu_bindings *bindings,
                       const struct gpu_layout *layout, VkDescriptorSet *out, struct err *err)
{
    bool is_full = !bindings->sets || bindings->sets->count == POOL_SETS;
    if (is_full && !sets_create(gpu, bindings, err))
        return false;
    struct gpu_sets *sets = bindings->sets;
    const VkDescriptorSetAllocateInfo set = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = sets->pool,
        .descriptorSetCount = 1,
        .pSetLayouts = &layout->set,
    };
    if (!VK(gpu, err, vkAllocateDescriptorSets(gpu->device, &set, out)))
        return false;
    set_write(gpu, bindings, layout->bindings, *out);
    sets->list[sets->count].layout = layout;
    sets->list[sets->count].handle = *out;
    sets->list[sets->count++].is_written = true;
    return true;
}

bool sets_find(struct gpu *gpu, struct gpu_bindings *bindings, const struct gpu_layout *layout,
               VkDescriptorSet *out, struct err *err)
{
    for (struct gpu_sets *sets = bindings->sets; sets; sets = sets->next)
        for (uint32_t i = 0; i < sets->count; i++) {
            if (sets->list[i].layout != layout)
                continue;
            *out = sets->list[i].handle;
            if (!sets->list[i].is_written)
                set_write(gpu, bindings, layout->bindings, *out);
            sets->list[i].is_written = true;
            return true;
        }
    return set_create(gpu, bindings, layout, out, err);
}

void sets_expire(struct gpu_sets *sets)
{
    for (; sets; sets = sets->next)
        for (uint32_t i = 0; i < sets->count; i++)
            sets->list[i].is_written = false;
}

void sets_destroy(struct gpu *gpu, struct gpu_sets *sets)
{
    while (sets) {
        struct gpu_sets *next = sets->next;
        if (!gpu->abandoned)
            vkDestroyDescriptorPool(gpu->device, sets->pool, NULL); // frees the sets
        free(sets);
        sets = next;
    }
}
