// A Vulkan loader in which one call fails. This library has the loader's name and forwards every
// function to the real one, except for call number VKF_N (counted from 1) of the function VKF_NAME,
// which returns the VkResult VKF_RESULT without doing anything. With VKF_STICKY, all later calls of
// it fail, too. With VKF_LOSE, the device is lost at submission number VKF_LOSE, and calls are
// counted from there. VKF_COUNT names a file to which the number of calls of each function is
// written at the end; VKF_LOADER is the real loader.
#define VK_NO_PROTOTYPES
#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

// All functions that return a VkResult and that the program calls without a window: name,
// parameters and arguments.
#define FUNCTIONS(X)                                                                               \
    X(vkAllocateCommandBuffers,                                                                    \
      (VkDevice d, const VkCommandBufferAllocateInfo *i, VkCommandBuffer *o), (d, i, o))           \
    X(vkAllocateDescriptorSets,                                                                    \
      (VkDevice d, const VkDescriptorSetAllocateInfo *i, VkDescriptorSet *o), (d, i, o))           \
    X(vkAllocateMemory,                                                                            \
      (VkDevice d, const VkMemoryAllocateInfo *i, const VkAllocationCallbacks *a,                  \
       VkDeviceMemory *o),                                                                         \
      (d, i, a, o))                                                                                \
    X(vkBeginCommandBuffer, (VkCommandBuffer c, const VkCommandBufferBeginInfo *i), (c, i))        \
    X(vkBindBufferMemory, (VkDevice d, VkBuffer b, VkDeviceMemory m, VkDeviceSize s),              \
      (d, b, m, s))                                                                                \
    X(vkBindImageMemory, (VkDevice d, VkImage b, VkDeviceMemory m, VkDeviceSize s), (d, b, m, s))  \
    CREATE(X, Buffer)                                                                              \
    CREATE(X, BufferView)                                                                          \
    CREATE(X, CommandPool)                                                                         \
    CREATE_PIPELINES(X, Compute)                                                                   \
    CREATE(X, DescriptorPool)                                                                      \
    CREATE(X, DescriptorSetLayout)                                                                 \
    X(vkCreateDevice,                                                                              \
      (VkPhysicalDevice p, const VkDeviceCreateInfo *i, const VkAllocationCallbacks *a,            \
       VkDevice *o),                                                                               \
      (p, i, a, o))                                                                                \
    CREATE(X, Fence)                                                                               \
    CREATE(X, Framebuffer)                                                                         \
    CREATE_PIPELINES(X, Graphics)                                                                  \
    CREATE(X, Image)                                                                               \
    CREATE(X, ImageView)                                                                           \
    X(vkCreateInstance,                                                                            \
      (const VkInstanceCreateInfo *i, const VkAllocationCallbacks *a, VkInstance *o), (i, a, o))   \
    CREATE(X, PipelineCache)                                                                       \
    CREATE(X, PipelineLayout)                                                                      \
    CREATE(X, QueryPool)                                                                           \
    CREATE(X, RenderPass)                                                                          \
    CREATE(X, Sampler)                                                                             \
    CREATE(X, ShaderModule)                                                                        \
    X(vkDeviceWaitIdle, (VkDevice d), (d))                                                         \
    X(vkEndCommandBuffer, (VkCommandBuffer c), (c))                                                \
    X(vkEnumerateDeviceExtensionProperties,                                                        \
      (VkPhysicalDevice p, const char *l, uint32_t *n, VkExtensionProperties *o), (p, l, n, o))    \
    X(vkEnumerateInstanceExtensionProperties,                                                      \
      (const char *l, uint32_t *n, VkExtensionProperties *o), (l, n, o))                           \
    X(vkEnumerateInstanceVersion, (uint32_t * v), (v))                                             \
    X(vkEnumeratePhysicalDevices, (VkInstance v, uint32_t * n, VkPhysicalDevice * o), (v, n, o))   \
    X(vkGetQueryPoolResults,                                                                       \
      (VkDevice d, VkQueryPool q, uint32_t f, uint32_t n, size_t s, void *o, VkDeviceSize t,       \
       VkQueryResultFlags l),                                                                      \
      (d, q, f, n, s, o, t, l))                                                                    \
    X(vkMapMemory,                                                                                 \
      (VkDevice d, VkDeviceMemory m, VkDeviceSize f, VkDeviceSize s, VkMemoryMapFlags l,           \
       void **o),                                                                                  \
      (d, m, f, s, l, o))                                                                          \
    X(vkQueueSubmit, (VkQueue q, uint32_t n, const VkSubmitInfo *i, VkFence f), (q, n, i, f))      \
    X(vkResetCommandPool, (VkDevice d, VkCommandPool p, VkCommandPoolResetFlags l), (d, p, l))     \
    X(vkResetFences, (VkDevice d, uint32_t n, const VkFence *f), (d, n, f))                        \
    X(vkWaitForFences, (VkDevice d, uint32_t n, const VkFence *f, VkBool32 w, uint64_t t),         \
      (d, n, f, w, t))
#define CREATE(X, type)                                                                            \
    X(vkCreate##type,                                                                              \
      (VkDevice d, const Vk##type##CreateInfo *i, const VkAllocationCallbacks *a, Vk##type *o),    \
      (d, i, a, o))
#define CREATE_PIPELINES(X, kind)                                                                  \
    X(vkCreate##kind##Pipelines,                                                                   \
      (VkDevice d, VkPipelineCache c, uint32_t n, const Vk##kind##PipelineCreateInfo *i,           \
       const VkAllocationCallbacks *a, VkPipeline *o),                                             \
      (d, c, n, i, a, o))

// --- which call fails ----------------------------------------------------------------------------

struct function {
    const char *name;
    PFN_vkVoidFunction real;
    long calls;
};

static bool is_lost; // set at submission VKF_LOSE
static void forget_calls(void);

// Returns whether the device is lost at this submission.
static bool loses(const struct function *function)
{
    const char *number = getenv("VKF_LOSE");
    if (!number || is_lost || strcmp(function->name, "vkQueueSubmit") != 0 ||
        function->calls + 1 < atol(number))
        return false;
    is_lost = true;
    forget_calls();
    return true;
}

static bool waits_for_loss(void)
{
    return getenv("VKF_LOSE") && !is_lost;
}

static bool fails(struct function *function)
{
    const char *name = getenv("VKF_NAME"), *number = getenv("VKF_N");
    long n = number ? atol(number) : 0;
    function->calls++;
    if (waits_for_loss())
        return false;
    if (!name || strcmp(name, function->name) != 0)
        return false;
    return function->calls == n || (getenv("VKF_STICKY") && function->calls > n);
}

static VkResult failure(void)
{
    const char *result = getenv("VKF_RESULT");
    return result ? (VkResult)atoi(result) : VK_ERROR_DEVICE_LOST;
}

enum {
#define X(call, parameters, arguments) FUNCTION_##call,
    FUNCTIONS(X)
#undef X
        FUNCTION_COUNT
};

static struct function functions[FUNCTION_COUNT] = {
#define X(call, parameters, arguments) [FUNCTION_##call] = {.name = #call},
    FUNCTIONS(X)
#undef X
};

#define X(call, parameters, arguments)                                                             \
    static VKAPI_ATTR VkResult VKAPI_CALL call_##call parameters                                   \
    {                                                                                              \
        struct function *function = &functions[FUNCTION_##call];                                   \
        if (loses(function))                                                                       \
            return VK_ERROR_DEVICE_LOST;                                                           \
        return fails(function) ? failure() : ((PFN_##call)function->real)arguments;                \
    }
FUNCTIONS(X)
#undef X

static void forget_calls(void)
{
    for (int i = 0; i < FUNCTION_COUNT; i++)
        functions[i].calls = 0;
}

static const PFN_vkVoidFunction calls[FUNCTION_COUNT] = {
#define X(call, parameters, arguments) [FUNCTION_##call] = (PFN_vkVoidFunction)call_##call,
    FUNCTIONS(X)
#undef X
};

// --- the loader ----------------------------------------------------------------------------------

static void write_counts(void)
{
    FILE *file = fopen(getenv("VKF_COUNT"), "w");
    for (int i = 0; file && i < FUNCTION_COUNT; i++)
        fprintf(file, "%s %ld\n", functions[i].name, functions[i].calls);
    if (file)
        fclose(file);
}

static PFN_vkGetInstanceProcAddr real_loader(void)
{
    static PFN_vkGetInstanceProcAddr found;
    if (found)
        return found;
    void *library = dlopen(getenv("VKF_LOADER"), RTLD_NOW | RTLD_LOCAL);
    if (library)
        found = (PFN_vkGetInstanceProcAddr)dlsym(library, "vkGetInstanceProcAddr");
    if (found && getenv("VKF_COUNT"))
        atexit(write_counts);
    return found;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL vkGetInstanceProcAddr(VkInstance instance,
                                                               const char *name);

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL vkGetInstanceProcAddr(VkInstance instance,
                                                               const char *name)
{
    PFN_vkGetInstanceProcAddr loader = real_loader();
    PFN_vkVoidFunction real = loader ? loader(instance, name) : NULL;
    for (int i = 0; real && i < FUNCTION_COUNT; i++)
        if (strcmp(functions[i].name, name) == 0) {
            functions[i].real = real;
            return calls[i];
        }
    return real;
}
