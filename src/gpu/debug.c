// Failures in words, and names for objects.
#include "gpu/gpu_internal.h"
#include <string.h>

static const char *result_text(VkResult result)
{
    switch (result) {
    case VK_NOT_READY:
        return "not ready";
    case VK_TIMEOUT:
        return "timeout";
    case VK_INCOMPLETE:
        return "incomplete";
    case VK_ERROR_OUT_OF_HOST_MEMORY:
        return "out of host memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
        return "out of device memory";
    case VK_ERROR_OUT_OF_POOL_MEMORY:
        return "out of pool memory";
    case VK_ERROR_INITIALIZATION_FAILED:
        return "initialization failed";
    case VK_ERROR_DEVICE_LOST:
        return "device lost (it was reset, removed, or a dispatch ran past its watchdog)";
    case VK_ERROR_MEMORY_MAP_FAILED:
        return "memory could not be mapped";
    case VK_ERROR_LAYER_NOT_PRESENT:
        return "layer not present";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
        return "extension not present";
    case VK_ERROR_FEATURE_NOT_PRESENT:
        return "feature not present";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
        return "incompatible driver";
    case VK_ERROR_TOO_MANY_OBJECTS:
        return "too many objects";
    case VK_ERROR_FORMAT_NOT_SUPPORTED:
        return "format not supported";
    case VK_ERROR_SURFACE_LOST_KHR:
        return "the window's surface is lost";
    case VK_ERROR_NATIVE_WINDOW_IN_USE_KHR:
        return "the window is in use elsewhere";
    case VK_ERROR_INVALID_SHADER_NV:
        return "the driver rejects the shader";
    default:
        return "unknown error";
    }
}

bool gpu_fail(struct gpu *gpu, const char *call, VkResult result, struct err *err)
{
    if (gpu && result == VK_ERROR_DEVICE_LOST)
        gpu->lost = true;
    return err_set(err, ERR_GPU, "%s: %s (VkResult %d)", call, result_text(result), (int)result);
}

bool vk_check(struct gpu *gpu, const char *call, VkResult result, struct err *err)
{
    if (result == VK_SUCCESS)
        return true;
    char name[64] = {0}; // the call without its arguments
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
