// Reads the driver's statistics of compiled kernels (VK_KHR_pipeline_executable_properties).
#include "gpu/gpu_internal.h"
#include <stdio.h>

static double value_of(const VkPipelineExecutableStatisticKHR *statistic)
{
    switch (statistic->format) {
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_BOOL32_KHR:
        return statistic->value.b32 ? 1.0 : 0.0;
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_INT64_KHR:
        return (double)statistic->value.i64;
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_UINT64_KHR:
        return (double)statistic->value.u64;
    default:
        return statistic->value.f64;
    }
}

bool gpu_kernel_statistics(struct gpu *gpu, const struct gpu_kernel *kernel,
                           struct gpu_statistic out[GPU_MAX_STATISTICS], uint32_t *count,
                           struct err *err)
{
    PFN_vkGetPipelineExecutableStatisticsKHR read =
        (PFN_vkGetPipelineExecutableStatisticsKHR)gpu_function(
            gpu, "vkGetPipelineExecutableStatisticsKHR");
    if (!gpu->params.statistics || !read)
        return err_set(err, ERR_BUG, "%s: the device was not opened for statistics", kernel->name);
    VkPipelineExecutableStatisticKHR found[GPU_MAX_STATISTICS];
    for (uint32_t i = 0; i < GPU_MAX_STATISTICS; i++)
        found[i] = (VkPipelineExecutableStatisticKHR){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR,
        };
    // A compute pipeline has one executable.
    const VkPipelineExecutableInfoKHR executable = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR,
        .pipeline = kernel->pipeline,
    };
    *count = GPU_MAX_STATISTICS;
    VkResult result = read(gpu->device, &executable, count, found);
    if (result != VK_SUCCESS && result != VK_INCOMPLETE)
        return gpu_fail(gpu, "vkGetPipelineExecutableStatisticsKHR", result, err);
    for (uint32_t i = 0; i < *count; i++) {
        snprintf(out[i].name, sizeof out[i].name, "%s", found[i].name);
        out[i].value = value_of(&found[i]);
    }
    return true;
}
