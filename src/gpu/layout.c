// Creates descriptor set layouts. Each has only the bindings that its kernels use, because a Vulkan
// device may support as few as 4 storage buffers at once.
#include "gpu/gpu_internal.h"
#include <stdlib.h>

VkDescriptorType binding_type(uint32_t binding)
{
    if (binding < GPU_FIRST_STORAGE || binding > GPU_UNIFORM_BINDING)
        return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    return binding < GPU_UNIFORM_BINDING ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER
                                         : VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
}

static bool set_layout_create(struct gpu *gpu, struct gpu_layout *layout, struct err *err)
{
    VkDescriptorSetLayoutBinding bindings[GPU_MAX_BINDINGS];
    uint32_t count = 0;
    for (uint32_t i = 0; i < GPU_MAX_BINDINGS; i++)
        if (layout->bindings >> i & 1)
            bindings[count++] = (VkDescriptorSetLayoutBinding){
                .binding = i,
                .descriptorType = binding_type(i),
                .descriptorCount = 1,
                .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
            };
    const VkDescriptorSetLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = count,
        .pBindings = bindings,
    };
    return VK(gpu, err, vkCreateDescriptorSetLayout(gpu->device, &info, NULL, &layout->set));
}

static bool pipeline_layout_create(struct gpu *gpu, struct gpu_layout *layout, struct err *err)
{
    const VkPushConstantRange push = {
        .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        .size = GPU_PUSH_BYTES,
    };
    const VkPipelineLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = 1,
        .pSetLayouts = &layout->set,
        .pushConstantRangeCount = 1,
        .pPushConstantRanges = &push,
    };
    return VK(gpu, err, vkCreatePipelineLayout(gpu->device, &info, NULL, &layout->pipeline));
}

static void layout_destroy(struct gpu *gpu, struct gpu_layout *layout)
{
    if (!gpu->abandoned) {
        vkDestroyPipelineLayout(gpu->device, layout->pipeline, NULL);
        vkDestroyDescriptorSetLayout(gpu->device, layout->set, NULL);
    }
    free(layout);
}

static uint32_t count_bindings(uint64_t bindings, VkDescriptorType type)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < GPU_MAX_BINDINGS; i++)
        count += (bindings >> i & 1) && binding_type(i) == type;
    return count;
}

static bool check_count(const struct gpu *gpu, uint64_t bindings, VkDescriptorType type,
                        uint32_t most, const char *kind, const char *limit, struct err *err)
{
    uint32_t count = count_bindings(bindings, type);
    return count <= most ||
           err_set(err, ERR_GPU, "it binds %u %s at once; the limit of %s is %u (%s)", count, kind,
                   gpu->info.name, most, limit);
}

static const struct gpu_layout *layout_create(struct gpu *gpu, uint64_t bindings, struct err *err)
{
    if (!check_count(gpu, bindings, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, gpu->storage_count,
                     "storage buffers", "maxPerStageDescriptorStorageBuffers", err) ||
        !check_count(gpu, bindings, VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, gpu->texel_count,
                     "texel buffers", "maxPerStageDescriptorSampledImages", err))
        return NULL;
    struct gpu_layout *layout = calloc(1, sizeof *layout);
    if (!layout) {
        err_memory(err, "a layout of bindings", sizeof *layout);
        return NULL;
    }
    layout->bindings = bindings;
    if (!set_layout_create(gpu, layout, err) || !pipeline_layout_create(gpu, layout, err)) {
        layout_destroy(gpu, layout);
        return NULL;
    }
    layout->next = gpu->layouts;
    gpu->layouts = layout;
    return layout;
}

const struct gpu_layout *layout_find(struct gpu *gpu, uint64_t bindings, struct err *err)
{
    for (const struct gpu_layout *layout = gpu->layouts; layout; layout = layout->next)
        if (layout->bindings == bindings)
            return layout;
    return layout_create(gpu, bindings, err);
}

bool layouts_create(struct gpu *gpu, struct err *err)
{
    return layout_find(gpu, 0, err);
}

void layouts_destroy(struct gpu *gpu)
{
    while (gpu->layouts) {
        struct gpu_layout *layout = gpu->layouts;
        gpu->layouts = layout->next;
        layout_destroy(gpu, layout);
    }
}
