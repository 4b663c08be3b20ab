// Finds the Vulkan loader, and creates the instance, with validation layers if requested.
#include "base/log.h"
#include "base/thread.h"
#include "gpu/gpu_internal.h"
#include <stdlib.h>
#include <string.h>

#define VALIDATION_LAYER "VK_LAYER_KHRONOS_validation"
#define MAX_CALLER_EXTENSIONS 16

// volk's pointers belong to the process, and are set once, by the first instance: those to core
// functions dispatch by their first argument, so they serve all instances and devices, and no
// thread sees them change. volkLoadDevice() would bind them to the latest device. Functions of
// extensions, which not every instance has, come from gpu_function().
static struct mutex pointers_mutex = MUTEX_INIT;
static bool has_pointers;

static void load_pointers(VkInstance instance)
{
    mutex_lock(&pointers_mutex);
    if (!has_pointers)
        volkLoadInstance(instance);
    has_pointers = true;
    mutex_unlock(&pointers_mutex);
}

static bool loader_find(void)
{
    mutex_lock(&pointers_mutex);
    bool found = vkCreateInstance || volkInitialize() == VK_SUCCESS;
    mutex_unlock(&pointers_mutex);
    return found;
}

static bool loader_open(struct err *err)
{
    if (!loader_find())
        return err_set(err, ERR_NO_VULKAN,
                       "no Vulkan loader: libvulkan.so.1 was not found; install the package that "
                       "has it (Debian: libvulkan1) and a driver (mesa-vulkan-drivers)");
    uint32_t version = volkGetInstanceVersion();
    if (version < VK_API_VERSION_1_1)
        return err_set(err, ERR_NO_VULKAN,
                       "the Vulkan loader has version %u.%u; expected at least 1.1",
                       VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version));
    return true;
}

static bool has_layer(const char *name)
{
    uint32_t count = 0;
    if (vkEnumerateInstanceLayerProperties(&count, NULL) != VK_SUCCESS)
        return false;
    VkLayerProperties *list = calloc(count + 1, sizeof *list);
    bool found = false;
    if (list && vkEnumerateInstanceLayerProperties(&count, list) >= VK_SUCCESS)
        for (uint32_t i = 0; i < count; i++)
            found |= strcmp(list[i].layerName, name) == 0;
    free(list);
    return found;
}

// Returns whether a layer has an extension; NULL for `layer`: the loader or a driver has it.
static bool has_extension(const char *layer, const char *name)
{
    uint32_t count = 0;
    if (vkEnumerateInstanceExtensionProperties(layer, &count, NULL) != VK_SUCCESS)
        return false;
    VkExtensionProperties *list = calloc(count + 1, sizeof *list);
    bool found = false;
    if (list && vkEnumerateInstanceExtensionProperties(layer, &count, list) >= VK_SUCCESS)
        for (uint32_t i = 0; i < count; i++)
            found |= strcmp(list[i].extensionName, name) == 0;
    free(list);
    return found;
}

static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT types,
                                                 const VkDebugUtilsMessengerCallbackDataEXT *data,
                                                 void *context)
{
    (void)severity, (void)types;
    struct gpu *gpu = context;
    gpu->validation_messages++;
    log_warn("Vulkan validation: %s", data->pMessage);
    return VK_FALSE; // VK_FALSE: the Vulkan call goes on as it would without the layers
}

// Messages of the type GENERAL are excluded: they are the loader's, about drivers and not about
// this program.
static VkDebugUtilsMessengerCreateInfoEXT messenger_info(struct gpu *gpu)
{
    return (VkDebugUtilsMessengerCreateInfoEXT){
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = gpu,
    };
}

static bool validation_check(struct err *err)
{
    if (!has_layer(VALIDATION_LAYER))
        return err_set(err, ERR_GPU,
                       "validation: the layer " VALIDATION_LAYER
                       " is not installed (Debian: vulkan-validationlayers)");
    if (!has_extension(VALIDATION_LAYER, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME))
        return err_set(err, ERR_GPU,
                       "validation: " VALIDATION_LAYER
                       " lacks VK_EXT_validation_features, which synchronization validation needs");
    return true;
}

// The extensions are checked one by one, because vkCreateInstance does not report which one is
// missing.
static bool extensions_check(const struct gpu_params *params, struct err *err)
{
    if (params->instance_extension_count > MAX_CALLER_EXTENSIONS)
        return err_set(err, ERR_BUG, "%u instance extensions; expected at most %d",
                       params->instance_extension_count, MAX_CALLER_EXTENSIONS);
    for (uint32_t i = 0; i < params->instance_extension_count; i++)
        if (!has_extension(NULL, params->instance_extensions[i]))
            return err_set(err, ERR_GPU,
                           "the Vulkan loader and its drivers lack %s, which a window needs",
                           params->instance_extensions[i]);
    return true;
}

static VkResult instance_call(struct gpu *gpu, const void *next, bool portability)
{
    bool validation = gpu->params.validation;
    const char *layers[] = {VALIDATION_LAYER};
    const char *extensions[3 + MAX_CALLER_EXTENSIONS];
    uint32_t extension_count = 0;
    if (validation) {
        extensions[extension_count++] = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
        extensions[extension_count++] = VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME;
    }
    if (portability)
        extensions[extension_count++] = VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME;
    for (uint32_t i = 0; i < gpu->params.instance_extension_count; i++)
        extensions[extension_count++] = gpu->params.instance_extensions[i];

    const VkApplicationInfo application = {
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
        .pApplicationName = "lampyris",
        .apiVersion = VK_API_VERSION_1_1, // the program uses no newer version
    };
    const VkInstanceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pNext = next,
        .flags = portability ? VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR : 0,
        .pApplicationInfo = &application,
        .enabledLayerCount = validation ? 1 : 0,
        .ppEnabledLayerNames = layers,
        .enabledExtensionCount = extension_count,
        .ppEnabledExtensionNames = extensions,
    };
    return vkCreateInstance(&info, NULL, &gpu->instance);
}

bool instance_create(struct gpu *gpu, struct err *err)
{
    bool validation = gpu->params.validation;
    if (!loader_open(err) || (validation && !validation_check(err)) ||
        !extensions_check(&gpu->params, err))
        return false;

    // Both structs are in the pNext chain, so that messages about the creation of the instance
    // itself are received, too.
    const VkDebugUtilsMessengerCreateInfoEXT messenger = messenger_info(gpu);
    const VkValidationFeatureEnableEXT enable[] = {
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    const VkValidationFeaturesEXT features = {
        .sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
        .pNext = &messenger,
        .enabledValidationFeatureCount = 1,
        .pEnabledValidationFeatures = enable,
    };
    VkResult result =
        instance_call(gpu, validation ? &features : NULL,
                      has_extension(NULL, VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME));
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
        return err_set(err, ERR_NO_VULKAN,
                       "no Vulkan driver was found; install one (Debian: mesa-vulkan-drivers, "
                       "which also has lavapipe for machines without a GPU)");
    if (result != VK_SUCCESS)
        return gpu_fail(gpu, "vkCreateInstance", result, err);
    load_pointers(gpu->instance);
    if (!validation)
        return true;
    PFN_vkCreateDebugUtilsMessengerEXT create =
        (PFN_vkCreateDebugUtilsMessengerEXT)gpu_function(gpu, "vkCreateDebugUtilsMessengerEXT");
    return VK(gpu, err, create(gpu->instance, &messenger, NULL, &gpu->messenger));
}

void instance_destroy(struct gpu *gpu)
{
    if (!gpu->instance)
        return;
    if (gpu->messenger) {
        PFN_vkDestroyDebugUtilsMessengerEXT destroy =
            (PFN_vkDestroyDebugUtilsMessengerEXT)gpu_function(gpu,
                                                              "vkDestroyDebugUtilsMessengerEXT");
        destroy(gpu->instance, gpu->messenger, NULL);
    }
    vkDestroyInstance(gpu->instance, NULL);
    gpu->messenger = VK_NULL_HANDLE;
    gpu->instance = VK_NULL_HANDLE;
}
