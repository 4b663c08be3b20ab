// Declares what the files of this folder share. This file is private to this folder.
#ifndef LAMPYRIS_GPU_GPU_INTERNAL_H
#define LAMPYRIS_GPU_GPU_INTERNAL_H

#include "gpu/screen.h"

// Runs a Vulkan call. Returns true on success; otherwise err has the call's name and its result.
#define VK(gpu, err, call) vk_check((gpu), #call, (call), (err))
bool vk_check(struct gpu *gpu, const char *call, VkResult result, struct err *err);

// --- instance.c ---------------------------------------------------------------------------------
// Creates the instance as gpu->params requires. If validation is on, its messages are counted in
// *gpu from now on, so *gpu must not move.
bool instance_create(struct gpu *gpu, struct err *err);
void instance_destroy(struct gpu *gpu);

// --- limits.c -----------------------------------------------------------------------------------
// Adds the words of the environment variable LAMPYRIS_LIMITS to the limits that the caller has not
// set.
bool limits_from_environment(struct gpu_limit_overrides *limits, struct err *err);

// --- select.c -----------------------------------------------------------------------------------
// Returns whether a device has an extension. If the driver fails to report its extensions, returns
// false and sets *failure to the reason; otherwise *failure is unchanged. failure may be NULL.
bool device_has_extension(VkPhysicalDevice device, const char *name, VkResult *failure);
// Selects a device by gpu->params.device; sets gpu->physical, gpu->queue_family and gpu->info.
bool device_select(struct gpu *gpu, struct err *err);
// Writes to `out` why the renderer cannot use the device, or "". queue_family is UINT32_MAX if no
// queue family supports compute.
void device_find_lacks(const VkPhysicalDeviceProperties *device, uint32_t queue_family, char *out,
                       size_t size);
// Reads the limits of gpu->physical and lowers them by the overrides.
bool device_read_limits(struct gpu *gpu, struct err *err);

// --- buffer.c -----------------------------------------------------------------------------------
// Creates a buffer without checking max_texel_elements and without filling it with zeros.
bool buffer_allocate(struct gpu *gpu, const char *name, uint64_t bytes, enum gpu_memory memory,
                     bool texel, struct gpu_buffer *out, struct err *err);
bool buffer_zero(struct gpu *gpu, struct gpu_buffer *buffer, struct err *err);
// Allocates memory for a buffer or an image without binding it. *flags receives the property flags
// of the memory type.
bool memory_allocate(struct gpu *gpu, const VkMemoryRequirements *needs, enum gpu_memory memory,
                     VkMemoryPropertyFlags *flags, VkDeviceMemory *out, struct err *err);
void memory_count(struct gpu *gpu, uint64_t bytes); // counts further bytes as in use

// --- command.c ----------------------------------------------------------------------------------
// Creates commands for copies only: they have no timestamps, and the simulation of a slow device
// does not apply to them.
bool commands_create_for_copies(struct gpu *gpu, struct gpu_commands *out, struct err *err);

// --- transfer.c ---------------------------------------------------------------------------------
// Destroys the objects that are kept for copies between host and buffers.
void transfers_destroy(struct gpu *gpu);
// Discards the contents of an image before a transfer overwrites all of it. Waits for earlier
// transfers from the image and for fragment shaders that sample it.
void image_discard(struct gpu_commands *commands, const struct gpu_image *image);
// Copies tightly packed rows into an image that image_discard() has prepared.
void image_fill(struct gpu_commands *commands, const struct gpu_image *image, uint32_t width,
                uint32_t height, const struct gpu_buffer *pixels);

// --- screen_pipeline.c --------------------------------------------------------------------------
// Creates all parts of *screen that depend neither on its size nor on the pixels of the atlas; the
// image screen->atlas must have been created, but may be empty. After a failure, call
// screen_pipeline_destroy() to destroy what was created.
bool screen_pipeline_create(struct gpu *gpu, struct gpu_screen *screen, struct err *err);
void screen_pipeline_destroy(struct gpu *gpu, struct gpu_screen *screen);

// --- layout.c -----------------------------------------------------------------------------------
// Returns the type of a binding. Bindings 0 .. GPU_FIRST_STORAGE - 1 are storage buffers;
// GPU_MAX_TEXEL uniform texel buffers, the uniform buffer and further storage buffers follow in
// this order.
VkDescriptorType binding_type(uint32_t binding);
// Creates the layout without bindings, through which push constants are set.
bool layouts_create(struct gpu *gpu, struct err *err);
void layouts_destroy(struct gpu *gpu);
// Returns the layout with this set of bindings, and creates it if necessary. Returns NULL on
// failure.
const struct gpu_layout *layout_find(struct gpu *gpu, uint64_t bindings, struct err *err);

// --- sets.c -------------------------------------------------------------------------------------
// Returns the descriptor set of the bindings for a layout, and creates and writes it if necessary.
bool sets_find(struct gpu *gpu, struct gpu_bindings *bindings, const struct gpu_layout *layout,
               VkDescriptorSet *out, struct err *err);
// Marks the sets as outdated after other buffers were bound: they are written again before their
// next use.
void sets_expire(struct gpu_sets *sets);
void sets_destroy(struct gpu *gpu, struct gpu_sets *sets); // accepts NULL

// --- kernel.c -----------------------------------------------------------------------------------
bool pipeline_cache_create(struct gpu *gpu, struct err *err);
void kernels_destroy(struct gpu *gpu); // destroys the kept pipelines and the pipeline cache

// --- debug.c ------------------------------------------------------------------------------------
// Names an object for the messages of validation layers and for debuggers. Does nothing unless
// validation is on.
void debug_name(const struct gpu *gpu, VkObjectType type, uint64_t handle, const char *name);
#define DEBUG_NAME(gpu, type, handle, name)                                                        \
    debug_name((gpu), VK_OBJECT_TYPE_##type, (uint64_t)(handle), (name))

#endif
