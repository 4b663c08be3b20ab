// Declarations for the files of this folder only.
#ifndef LAMPYRIS_GPU_GPU_INTERNAL_H
#define LAMPYRIS_GPU_GPU_INTERNAL_H

#include "gpu/screen.h"

// Runs a Vulkan call; true on success, else err has the call's name and its result.
#define VK(gpu, err, call) vk_check((gpu), #call, (call), (err))
bool vk_check(struct gpu *gpu, const char *call, VkResult result, struct err *err);

// --- instance.c ---------------------------------------------------------------------------------
// Needs gpu->params. If validation is on, its messages carry the pointer gpu from now on.
bool instance_create(struct gpu *gpu, struct err *err);
void instance_destroy(struct gpu *gpu);

// --- limits.c -----------------------------------------------------------------------------------
// Adds the words of the environment variable LAMPYRIS_LIMITS to the limits that are not set yet.
bool limits_from_environment(struct gpu_limit_overrides *limits, struct err *err);

// --- select.c -----------------------------------------------------------------------------------
// Returns false, too, if the driver fails to report its extensions: *failure then has the reason,
// and otherwise is unchanged. failure may be NULL.
bool device_has_extension(VkPhysicalDevice device, const char *name, VkResult *failure);
// Selects by gpu->params.device; sets physical, queue_family and info.
bool device_select(struct gpu *gpu, struct err *err);
// Writes the reason why the device cannot be used, or "". queue_family: UINT32_MAX if no family
// supports compute.
void device_find_lacks(const VkPhysicalDeviceProperties *device, uint32_t queue_family, char *out,
                       size_t size);
// Reads the limits of gpu->physical, lowered by the overrides.
bool device_read_limits(struct gpu *gpu, struct err *err);

// --- buffer.c -----------------------------------------------------------------------------------
// Creates a buffer without checking max_texel_elements, and without filling it with zeros.
bool buffer_allocate(struct gpu *gpu, const char *name, uint64_t bytes, enum gpu_memory memory,
                     bool texel, struct gpu_buffer *out, struct err *err);
bool buffer_zero(struct gpu *gpu, struct gpu_buffer *buffer, struct err *err);
// Allocates memory for a buffer or an image, without binding it. *flags: the flags of its type.
bool memory_allocate(struct gpu *gpu, const VkMemoryRequirements *needs, enum gpu_memory memory,
                     VkMemoryPropertyFlags *flags, VkDeviceMemory *out, struct err *err);
void memory_count(struct gpu *gpu, uint64_t bytes); // more bytes are in use

// --- command.c ----------------------------------------------------------------------------------
// Creates commands for copies only: they have no timestamps, and are never simulated as slow.
bool commands_create_for_copies(struct gpu *gpu, struct gpu_commands *out, struct err *err);

// --- transfer.c ---------------------------------------------------------------------------------
void transfers_destroy(struct gpu *gpu); // the objects kept for copies between host and buffers

// --- image.c ------------------------------------------------------------------------------------
// Discards the contents of an image before a transfer writes all of it. Waits for transfers from it
// and for fragments that sample it.
void image_discard(struct gpu_commands *commands, const struct gpu_image *image);
// Copies tightly packed rows into an image that image_discard has prepared.
void image_fill(struct gpu_commands *commands, const struct gpu_image *image, uint32_t width,
                uint32_t height, const struct gpu_buffer *pixels);

// --- screen_pipeline.c --------------------------------------------------------------------------
// Creates all of *screen that does not depend on its size or on the atlas' pixels; the image
// screen->atlas need not have any yet. After a failure the other function destroys what was
// created.
bool screen_pipeline_create(struct gpu *gpu, struct gpu_screen *screen, struct err *err);
void screen_pipeline_destroy(struct gpu *gpu, struct gpu_screen *screen);

// --- layout.c -----------------------------------------------------------------------------------
// Bindings 0 .. GPU_FIRST_STORAGE-1 are storage buffers, then come GPU_MAX_TEXEL uniform texel
// buffers, one uniform buffer and further storage buffers.
VkDescriptorType binding_type(uint32_t binding);
// The first layout, without bindings: push constants are set through it.
bool layouts_create(struct gpu *gpu, struct err *err);
void layouts_destroy(struct gpu *gpu);
// Returns the layout with these bindings, creating it if necessary; NULL on failure.
const struct gpu_layout *layout_find(struct gpu *gpu, uint64_t bindings, struct err *err);

// --- sets.c -------------------------------------------------------------------------------------
// Returns the bindings' descriptor set for a layout, creating and writing it if necessary.
bool sets_find(struct gpu *gpu, struct gpu_bindings *bindings, const struct gpu_layout *layout,
               VkDescriptorSet *out, struct err *err);
// Marks the sets as outdated because other buffers were bound: they are written again before use.
void sets_expire(struct gpu_sets *sets);
void sets_destroy(struct gpu *gpu, struct gpu_sets *sets); // accepts NULL

// --- kernel.c -----------------------------------------------------------------------------------
bool pipeline_cache_create(struct gpu *gpu, struct err *err);
void kernels_destroy(struct gpu *gpu); // kept pipelines, and the pipeline cache

// --- debug.c ------------------------------------------------------------------------------------
// Names an object for the validation layers' messages and for debuggers; nothing without them.
void debug_name(const struct gpu *gpu, VkObjectType type, uint64_t handle, const char *name);
#define DEBUG_NAME(gpu, type, handle, name)                                                        \
    debug_name((gpu), VK_OBJECT_TYPE_##type, (uint64_t)(handle), (name))

#endif
