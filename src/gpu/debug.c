// Describes failed Vulkan calls, and names objects for debuggers.
#include "gpu/gpu_internal.h"
#include <string.h>

static const char *result_text(VkResult result)
{
    static const struct {
        VkResult result;
        const char *text;
    } texts[] = {
        {VK_NOT_READY, "not ready"},
        {VK_TIMEOUT, "timeout"},
        {VK_INCOMPLETE, "incomplete"},
        {VK_ERROR_OUT_OF_HOST_MEMORY, "out of host memory"},
        {VK_ERROR_OUT_OF_DEVICE_MEMORY, "out of device memory"},
        {VK_ERROR_OUT_OF_POOL_MEMORY, "out of pool memory"},
        {VK_ERROR_INITIALIZATION_FAILED, "initialization failed"},
        {VK_ERROR_DEVICE_LOST,
         "device lost (it was reset, removed, or a dispatch ran past its watchdog)"},
        {VK_ERROR_MEMORY_MAP_FAILED, "memory could not be mapped"},
        {VK_ERROR_LAYER_NOT_PRESENT, "layer not present"},
        {VK_ERROR_EXTENSION_NOT_PRESENT, "extension not present"},
        {VK_ERROR_FEATURE_NOT_PRESENT, "feature not present"},
        {VK_ERROR_INCOMPATIBLE_DRIVER, "incompatible driver"},
        {VK_ERROR_TOO_MANY_OBJECTS, "too many objects"},
        {VK_ERROR_FORMAT_NOT_SUPPORTED, "format not supported"},
        {VK_ERROR_SURFACE_LOST_KHR, "the window's surface is lost"},
        {VK_ERROR_NATIVE_WINDOW_IN_USE_KHR, "the window is in use elsewhere"},
        {VK_ERROR_INVALID_SHADER_NV, "the driver rejects the shader"},
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        if (texts[i].result == result)
            return texts[i].text;
    return "unknown error";
}

bool gpu_fail(struct gpu *gpu, const char *call, VkResult result, struct err *err)
{
    if (gpu && result == VK_ERROR_DEVICE_LOST)
        gpu->lost = true;
    if (gpu && result == VK_ERROR_OUT_OF_DEVICE_MEMORY)
        gpu->out_of_memory = true;
    return err_set(err, ERR_GPU, "%s: %s (VkResult %d)", call, result_text(result), (int)result);
}

bool vk_check(struct gpu *gpu, const char *call, VkResult result, struct err *err)
{
    if (result == VK_SUCCESS)
        return true;
    char name[64] = {0}; // the call without its arguments, such as "vkQueueSubmit"
    size_t length = strcspn(call, "(");
    memcpy(name, call, length < sizeof name ? length : sizeof name - 1);
    return gpu_fail(gpu, name, result, err);
}

void debug_name(const struct gpu *gpu, VkObjectType type, uint64_t handle, const char *name)
{
    if (!gpu->params.validation)
        return;
    const VkDebugUtilsObjectNameInfoEXT info = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
        .objectType = type,
        .objectHandle = handle,
        .pObjectName = name,
    };
    PFN_vkSetDebugUtilsObjectNameEXT set_name =
        (PFN_vkSetDebugUtilsObjectNameEXT)gpu_function(gpu, "vkSetDebugUtilsObjectNameEXT");
    set_name(gpu->device, &info);
}

PFN_vkVoidFunction gpu_function(const struct gpu *gpu, const char *name)
{
    return vkGetInstanceProcAddr(gpu->instance, name);
}
