// Creates compute pipelines.
#include "gpu/gpu_internal.h"
#include "gpu/spirv_bindings.h"
#include "gpu/spirv_rounding.h"
#include "gpu/spirv_trim.h"
#include <stdlib.h>
#include <string.h>

bool pipeline_cache_create(struct gpu *gpu, struct err *err)
{
    const VkPipelineCacheCreateInfo cache = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO,
    };
    return VK(gpu, err, vkCreatePipelineCache(gpu->device, &cache, NULL, &gpu->pipeline_cache));
}

static bool pipeline_create(struct gpu *gpu, const struct gpu_kernel_params *params,
                            VkShaderModule module, struct gpu_kernel *out, struct err *err)
{
    VkSpecializationMapEntry entries[GPU_MAX_CONSTANTS];
    for (uint32_t i = 0; i < params->constant_count; i++)
        entries[i] = (VkSpecializationMapEntry){
            .constantID = i,
            .offset = i * (uint32_t)sizeof(uint32_t),
            .size = sizeof(uint32_t),
        };
    const VkSpecializationInfo specialization = {
        .mapEntryCount = params->constant_count,
        .pMapEntries = entries,
        .dataSize = params->constant_count * sizeof(uint32_t),
        .pData = params->constants,
    };
    const VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage =
            {
                .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                .module = module,
                .pName = "main",
                .pSpecializationInfo = &specialization,
            },
        .layout = out->layout->pipeline,
        .flags = gpu->params.statistics ? VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR : 0,
    };
    return VK(
        gpu, err,
        vkCreateComputePipelines(gpu->device, gpu->pipeline_cache, 1, &info, NULL, &out->pipeline));
}

// Prepares the code for the device: removes unreachable code and sets the rounding mode. `trimmed`
// and `rounded` each have the code's size plus SPIRV_ROUNDING_BYTES. Without memory for trimming
// this fails, because the original code may declare more bindings than the device supports.
static bool code_prepare(const struct gpu *gpu, const struct gpu_kernel_params *params,
                         uint32_t *trimmed, uint32_t *rounded, VkShaderModuleCreateInfo *info,
                         struct err *err)
{
    size_t bytes = spirv_trim(params->spirv, params->spirv_bytes, params->constants,
                              params->constant_count, trimmed);
    if (bytes == SPIRV_TRIM_NO_MEMORY)
        return err_set(err, ERR_SYSTEM, "out of memory: %zu bytes of code cannot be trimmed",
                       params->spirv_bytes);
    if (bytes) {
        info->codeSize = bytes;
        info->pCode = trimmed;
    }
    bytes =
        gpu->rounds_to_nearest ? spirv_round_to_nearest(info->pCode, info->codeSize, rounded) : 0;
    if (bytes) {
        info->codeSize = bytes;
        info->pCode = rounded;
    }
    return true;
}

static bool pipeline_make(struct gpu *gpu, const struct gpu_kernel_params *params,
                          struct gpu_kernel *out, struct err *err)
{
    VkShaderModuleCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = params->spirv_bytes,
        .pCode = params->spirv,
    };
    size_t size = params->spirv_bytes + SPIRV_ROUNDING_BYTES;
    uint32_t *buffers = malloc(2 * size);
    if (!buffers)
        return err_set(err, ERR_SYSTEM, "out of memory: %zu bytes are needed to prepare the code",
                       2 * size);
    VkShaderModule module = VK_NULL_HANDLE;
    bool ok = code_prepare(gpu, params, buffers, buffers + size / sizeof *buffers, &info, err);
    out->layout = ok ? layout_find(gpu, spirv_bindings(info.pCode, info.codeSize), err) : NULL;
    ok = out->layout && VK(gpu, err, vkCreateShaderModule(gpu->device, &info, NULL, &module)) &&
         pipeline_create(gpu, params, module, out, err);
    vkDestroyShaderModule(gpu->device, module, NULL);
    free(buffers);
    return ok;
}

static bool same_code(const struct gpu_kernel *kernel, const struct gpu_kernel_params *params)
{
    const uint32_t *from = params->made_from ? params->made_from : params->spirv;
    return kernel->spirv == from && kernel->variant == params->variant &&
           kernel->constant_count == params->constant_count &&
           memcmp(kernel->constants, params->constants,
                  params->constant_count * sizeof *params->constants) == 0;
}

// Takes a kept pipeline with the same code and constants from the device. Returns false if there is
// none.
static bool take_kept(struct gpu *gpu, const struct gpu_kernel_params *params,
                      struct gpu_kernel *out)
{
    for (uint32_t i = 0; i < GPU_KEPT_KERNELS; i++) {
        struct gpu_kernel *kept = &gpu->kept[i];
        if (kept->pipeline && same_code(kept, params)) {
            out->pipeline = kept->pipeline;
            out->layout = kept->layout;
            *kept = (struct gpu_kernel){0};
            return true;
        }
    }
    return false;
}

bool gpu_kernel_create(struct gpu *gpu, const struct gpu_kernel_params *params,
                       struct gpu_kernel *out, struct err *err)
{
    *out = (struct gpu_kernel){
        .name = params->name,
        .spirv = params->made_from ? params->made_from : params->spirv,
        .variant = params->variant,
    };
    if (params->constant_count > GPU_MAX_CONSTANTS)
        return err_set(err, ERR_BUG, "kernel %s: %u specialization constants; expected at most %d",
                       params->name, params->constant_count, GPU_MAX_CONSTANTS);
    out->constant_count = params->constant_count;
    for (uint32_t i = 0; i < params->constant_count; i++)
        out->constants[i] = params->constants[i];
    if (!take_kept(gpu, params, out) && !pipeline_make(gpu, params, out, err))
        return err_prepend(err, "kernel %s", params->name);
    DEBUG_NAME(gpu, PIPELINE, out->pipeline, params->name);
    return true;
}

void gpu_kernel_finish(struct gpu *gpu, struct gpu_kernel *kernel)
{
    if (!kernel)
        return;
    if (kernel->pipeline) {
        struct gpu_kernel *oldest = &gpu->kept[gpu->kept_next++ % GPU_KEPT_KERNELS];
        if (!gpu->abandoned)
            vkDestroyPipeline(gpu->device, oldest->pipeline, NULL);
        *oldest = *kernel;
    }
    *kernel = (struct gpu_kernel){0};
}

void gpu_kernels_forget(struct gpu *gpu, const uint32_t *spirv)
{
    for (uint32_t i = 0; i < GPU_KEPT_KERNELS; i++)
        if (gpu->kept[i].spirv == spirv) {
            if (!gpu->abandoned)
                vkDestroyPipeline(gpu->device, gpu->kept[i].pipeline, NULL);
            gpu->kept[i] = (struct gpu_kernel){0};
        }
}

void kernels_destroy(struct gpu *gpu)
{
    for (uint32_t i = 0; i < GPU_KEPT_KERNELS; i++)
        vkDestroyPipeline(gpu->device, gpu->kept[i].pipeline, NULL);
    vkDestroyPipelineCache(gpu->device, gpu->pipeline_cache, NULL);
}
