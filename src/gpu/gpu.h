// This is a thin layer over Vulkan: all vk* calls of the renderer are in this folder. Raw handles
// are visible to callers. There is one queue, one push-constant block, and one numbering of
// bindings for all kernels; each kernel's layout contains the bindings that its code uses.
//
// Threads: one thread at a time may use a struct gpu and its objects; several threads may each use
// one of their own.
#ifndef LAMPYRIS_GPU_GPU_H
#define LAMPYRIS_GPU_GPU_H

#include "base/arena.h"
#include "base/err.h"
#include "gpu/params.h"
#include <stdbool.h>
#include <stdint.h>
#include <volk.h>

#define GPU_FIRST_STORAGE 16 // bindings 0 .. 15 are storage buffers
#define GPU_MAX_STORAGE 32   // storage buffers, including those after GPU_UNIFORM_BINDING
#define GPU_MAX_TEXEL 12     // uniform texel buffers: bindings GPU_FIRST_STORAGE + 0 .. 11
#define GPU_UNIFORM_BINDING (GPU_FIRST_STORAGE + GPU_MAX_TEXEL) // the uniform buffer
#define GPU_MAX_BINDINGS (GPU_MAX_STORAGE + GPU_MAX_TEXEL + 1)
#define GPU_PUSH_BYTES 128
#define GPU_MAX_CONSTANTS 64 // specialization constants per kernel
#define GPU_KEPT_KERNELS 64
#define GPU_MAX_DEVICES 16
#define GPU_MIN_INVOCATIONS 128 // threads per workgroup that every usable device supports

struct gpu_device_info {
    uint32_t index;
    char name[256];
    char driver[512];      // name, version and additional information of the driver
    const char *kind;      // "discrete GPU", "integrated GPU", "virtual GPU", "CPU", "other"
    bool is_cpu;           // runs on the processor (lavapipe, SwiftShader)
    bool shares_memory;    // device memory is the host's memory
    uint8_t memory_id[16]; // the same for devices that have the same memory, also in other
                           // processes: zeros for the host's memory, else the UUID of the device
    uint32_t api_version;
    uint64_t memory_bytes; // largest device-local heap
    char unusable[256];    // "", or why the renderer cannot use the device
};

// Lists the first GPU_MAX_DEVICES devices in the loader's order; fails with ERR_NO_VULKAN when
// there is no loader or driver.
bool gpu_list_devices(struct gpu_device_info out[GPU_MAX_DEVICES], uint32_t *count,
                      struct err *err);

// The Vulkan layouts for one set of bindings. Kernels that use the same set share its layouts,
// which the device owns until gpu_close.
struct gpu_layout {
    uint64_t bindings; // bit i is set if binding i is in the set
    VkDescriptorSetLayout set;
    VkPipelineLayout pipeline;
    struct gpu_layout *next;
};

struct gpu_kernel {
    VkPipeline pipeline;
    const struct gpu_layout *layout;
    const char *name;
    // The key by which the pipeline is reused. `spirv` is the module, or the one from which it was
    // derived; `variant` identifies the derivation: see struct gpu_kernel_params.
    const uint32_t *spirv;
    uint64_t variant;
    uint32_t constants[GPU_MAX_CONSTANTS], constant_count;
};

struct gpu {
    VkInstance instance;
    VkPhysicalDevice physical;
    VkDevice device;
    VkQueue queue;
    uint32_t queue_family;
    struct gpu_device_info info;
    // Limits of the device, lowered by params.limits.
    uint64_t max_storage_range;
    uint64_t max_texel_elements; // 0 if texel buffers are not used
    uint32_t storage_count;      // storage buffers that one kernel may bind
    uint32_t texel_count;        // uniform texel buffers that one kernel may bind
    uint64_t max_allocation;
    uint64_t storage_alignment; // in bytes; the offset of a storage range must be a multiple of
                                // this
    uint32_t max_groups;        // greatest number of workgroups per dispatch, in x
    uint32_t max_invocations;   // greatest number of threads per workgroup
    uint64_t max_shared_bytes;  // memory that the threads of a workgroup share
    uint32_t subgroup_size;
    bool has_ballot;        // has ballot and arithmetic subgroup operations in compute shaders
    bool rounds_to_nearest; // kernels request rounding to nearest (VK_KHR_shader_float_controls)
    bool has_timestamps;
    double timestamp_ns;          // nanoseconds per tick of a timestamp
    uint64_t timestamp_mask;      // the valid bits of a timestamp
    uint32_t validation_messages; // number of warnings and errors of the validation layers so far;
                                  // gpu_close keeps it, so that callers see complaints about
                                  // objects that were not destroyed
    bool lost;                    // VK_ERROR_DEVICE_LOST was seen
    bool out_of_memory; // a call failed with VK_ERROR_OUT_OF_DEVICE_MEMORY; a caller that recovers
                        // resets it
    bool abandoned;     // the device may still be working, so its objects are no longer destroyed
    uint64_t allocated_bytes, peak_bytes; // bytes of buffers (including staging buffers) and images
    uint32_t sharers;                     // see gpu_share_memory(); 0: the memory is not shared
    uint64_t share_bytes, host_share_bytes; // the share of this one of them, and its share of the
                                            // host's memory

    struct gpu_layout *layouts; // a list; its last element was created first and has no bindings
    VkPipelineCache pipeline_cache;
    // Pipelines of destroyed kernels, kept for reuse, because drivers take up to half a second to
    // create the pipelines of a renderer. The oldest one is evicted first.
    struct gpu_kernel kept[GPU_KEPT_KERNELS];
    uint32_t kept_next;
    VkDebugUtilsMessengerEXT messenger;
    struct gpu_commands *copying; // used by synchronous copies; NULL before the first copy
    struct gpu_params params;
    uint32_t allocation_count, submit_count;
};

// Opens a device. NULL for params means the defaults. *out must not move until gpu_close, because
// the validation layers hold its address.
bool gpu_open(const struct gpu_params *params, struct gpu *out, struct err *err);
void gpu_close(struct gpu *gpu); // accepts NULL and {0}
// Closes the device, even if it is lost, and opens it again. The caller must have finished all
// objects of the device. On failure *gpu is marked as lost, has no device, and may be closed.
bool gpu_reopen(struct gpu *gpu, struct err *err);

// Returns the device memory, in bytes, that is still available: the budget reported by
// VK_EXT_memory_budget, or else the unused part of the largest heap. If the device uses the host's
// memory, the result is at most the host's free memory. After gpu_share_memory(), it is at most the
// rest of the share.
uint64_t gpu_memory_free(const struct gpu *gpu);
// Returns memory_available(), or less after gpu_share_memory() if the device uses the host's
// memory: the rest of the share of it.
uint64_t gpu_host_memory_free(const struct gpu *gpu);
// Divides the memory that is available now equally among `sharers` renderers, of this process or of
// others, that have opened devices with the same info.memory_id. Each must call this after all have
// opened their device and before any of them allocates memory.
void gpu_share_memory(struct gpu *gpu, uint32_t sharers);

// --- buffers ------------------------------------------------------------------------------------
enum gpu_memory {
    GPU_DEVICE,   // fastest memory for kernels; mapped if the device shares it with the host
    GPU_READBACK, // always mapped, and cached by the host where possible
};

struct gpu_buffer {
    VkBuffer handle;
    VkDeviceMemory memory;
    uint64_t bytes;
    VkBufferView texel_view; // a view of the whole buffer as RGBA32_UINT, or VK_NULL_HANDLE
    void *mapped;            // NULL if the memory is not mapped
    const char *name;        // owned by the caller; must outlive the buffer
};

// Creates a buffer filled with zeros, which may be used as storage buffer, for indirect dispatches
// and for transfers. A size of 0 becomes 16 bytes. `texel` requests a uniform texel view as well;
// gpu_texel_fits() says beforehand whether the size is within the device's limit.
bool gpu_buffer_create(struct gpu *gpu, const char *name, uint64_t bytes, enum gpu_memory memory,
                       bool texel, struct gpu_buffer *out, struct err *err);
void gpu_buffer_finish(struct gpu *gpu, struct gpu_buffer *buffer); // accepts NULL and {0}
bool gpu_texel_fits(const struct gpu *gpu, uint64_t bytes);
// gpu_upload() and gpu_download() copy and wait for the end. If the buffer is not mapped they use
// staging memory, in pieces of at most 64 MiB.
bool gpu_upload(struct gpu *gpu, struct gpu_buffer *buffer, uint64_t offset, const void *data,
                uint64_t bytes, struct err *err);
bool gpu_download(struct gpu *gpu, const struct gpu_buffer *buffer, uint64_t offset, void *data,
                  uint64_t bytes, struct err *err);

// --- kernels ------------------------------------------------------------------------------------
struct gpu_kernel_params {
    const char *name;
    const uint32_t *spirv;
    size_t spirv_bytes;
    const uint32_t *constants; // values of the specialization constants 0 .. constant_count - 1
    uint32_t constant_count;
    // If `spirv` was derived from another module: that module, and a number that identifies the
    // derivation. Both are part of the key by which pipelines are reused. NULL: `spirv` was not
    // derived.
    const uint32_t *made_from;
    uint64_t variant;
};

// Creates a kernel. `spirv`, or `made_from` if it is set, must outlive the device or be passed to
// gpu_kernels_forget(). Fails if the kernel binds more buffers than the device supports.
bool gpu_kernel_create(struct gpu *gpu, const struct gpu_kernel_params *params,
                       struct gpu_kernel *out, struct err *err);
// Destroys all kept pipelines of this module, so that the caller may free its code.
void gpu_kernels_forget(struct gpu *gpu, const uint32_t *spirv);
// Finishes a kernel. The device keeps its pipeline for later kernels with the same code and
// constants. Accepts NULL and {0}.
void gpu_kernel_finish(struct gpu *gpu, struct gpu_kernel *kernel);

#define GPU_MAX_STATISTICS 32

// A statistic of a compiled kernel, such as registers or instructions; the driver chooses the name.
struct gpu_statistic {
    char name[VK_MAX_DESCRIPTION_SIZE];
    double value; // 0 or 1 if the driver reports a Boolean
};

// Reads at most GPU_MAX_STATISTICS statistics of a kernel. The device must have been opened with
// params.statistics.
bool gpu_kernel_statistics(struct gpu *gpu, const struct gpu_kernel *kernel,
                           struct gpu_statistic out[GPU_MAX_STATISTICS], uint32_t *count,
                           struct err *err);

// --- bindings -----------------------------------------------------------------------------------
// The buffers of all bindings. A kernel's descriptor set contains the bindings that its code uses;
// there is one set for each layout, created when a kernel of that layout is dispatched first. Every
// binding is always valid: bindings left {0} refer to a small dummy buffer, which struct
// gpu_bindings owns.
struct gpu_binding {
    const struct gpu_buffer *buffer; // NULL: the dummy buffer
    uint64_t offset, bytes; // both in bytes; offset is a multiple of storage_alignment; bytes = 0:
                            // up to the end of the buffer
};

struct gpu_bindings {
    struct gpu_buffer dummy;
    VkDescriptorBufferInfo storage[GPU_MAX_STORAGE], uniform;
    VkBufferView texel[GPU_MAX_TEXEL];
    struct gpu_sets *sets; // see sets.c; NULL until a kernel needs a descriptor set
};

// Creates bindings. storage, texel and uniform may be NULL if there are none. The buffers must
// outlive the bindings, and those in `texel` need a texel view.
bool gpu_bindings_create(struct gpu *gpu, const struct gpu_binding storage[GPU_MAX_STORAGE],
                         const struct gpu_buffer *const texel[GPU_MAX_TEXEL],
                         const struct gpu_buffer *uniform, struct gpu_bindings *out,
                         struct err *err);
// Replaces the buffers. The device must have finished all commands that use the bindings; commands
// that were recorded with the old buffers become invalid.
bool gpu_bindings_write(struct gpu *gpu, const struct gpu_binding storage[GPU_MAX_STORAGE],
                        const struct gpu_buffer *const texel[GPU_MAX_TEXEL],
                        const struct gpu_buffer *uniform, struct gpu_bindings *bindings,
                        struct err *err);
void gpu_bindings_finish(struct gpu *gpu, struct gpu_bindings *bindings);

// --- commands -----------------------------------------------------------------------------------
#define GPU_MAX_TIMESTAMPS 1024

struct gpu_commands {
    VkCommandPool pool;
    VkCommandBuffer handle;
    VkFence fence;
    struct gpu_slow *slow; // see slow.h; NULL if no slow device is simulated
    struct gpu_buffer slow_log;
    VkQueryPool queries; // VK_NULL_HANDLE if there are no timestamps
    uint32_t timestamp_count;
    bool pending;
    struct gpu_bindings *bindings; // the bindings of the last gpu_bind
    VkDescriptorSet set; // the descriptor set that is bound at present, one of those of `bindings`
    struct err failure;  // an error during recording, which gpu_submit returns
    // Semaphores for one submission, or VK_NULL_HANDLE; the caller sets them after gpu_begin. The
    // submission's transfers wait for `awaited`, and its end signals `signalled`.
    VkSemaphore awaited, signalled;
};

bool gpu_commands_create(struct gpu *gpu, struct gpu_commands *out, struct err *err);
void gpu_commands_finish(struct gpu *gpu, struct gpu_commands *commands);
// Starts a new recording; first waits for the previous submission of these commands.
bool gpu_begin(struct gpu *gpu, struct gpu_commands *commands, struct err *err);
// Binds buffers for the dispatches that follow. The bindings must stay valid until the submitted
// commands have ended.
void gpu_bind(struct gpu *gpu, struct gpu_commands *commands, struct gpu_bindings *bindings);
void gpu_push(struct gpu *gpu, struct gpu_commands *commands, const void *data, uint32_t bytes);
void gpu_dispatch(struct gpu *gpu, struct gpu_commands *commands, const struct gpu_kernel *kernel,
                  uint32_t groups_x);
void gpu_dispatch_indirect(struct gpu *gpu, struct gpu_commands *commands,
                           const struct gpu_kernel *kernel, const struct gpu_buffer *arguments,
                           uint64_t offset);
// Makes all previous writes by shaders and transfers visible to all later shaders, indirect
// dispatches and transfers, and to the host after gpu_wait.
void gpu_barrier(struct gpu *gpu, struct gpu_commands *commands);
void gpu_fill(struct gpu *gpu, struct gpu_commands *commands, const struct gpu_buffer *buffer,
              uint64_t offset, uint64_t bytes, uint32_t value);
void gpu_copy(struct gpu *gpu, struct gpu_commands *commands, const struct gpu_buffer *from,
              uint64_t from_offset, const struct gpu_buffer *to, uint64_t to_offset,
              uint64_t bytes);
// Records a timestamp. Returns its index, or UINT32_MAX if timestamps are not supported or
// GPU_MAX_TIMESTAMPS have been recorded.
uint32_t gpu_timestamp(struct gpu *gpu, struct gpu_commands *commands);
// Ends the recording with a barrier and submits it, so that the next submission and, after
// gpu_wait, the host see all writes. Fails and submits nothing if an error occurred during
// recording.
bool gpu_submit(struct gpu *gpu, struct gpu_commands *commands, struct err *err);
bool gpu_wait(struct gpu *gpu, struct gpu_commands *commands, struct err *err);
// Calls gpu_wait, then writes the timestamp_count timestamps to `out`, in nanoseconds since
// timestamp 0.
bool gpu_timestamps_ns(struct gpu *gpu, struct gpu_commands *commands, double *out,
                       struct err *err);

// Returns a function of an extension that was enabled for the instance or the device. volk's
// pointers to such functions are unusable: they are those of the process's first instance.
PFN_vkVoidFunction gpu_function(const struct gpu *gpu, const char *name);

// Waits until the device is idle, so that its objects may be destroyed. If waiting fails, the
// device is abandoned: its objects are not destroyed until the process ends. Call this wherever
// gpu_wait has failed.
void gpu_settle(struct gpu *gpu);

// Fails with ERR_GPU; the message has the failed call and its VkResult as text. Returns false.
bool gpu_fail(struct gpu *gpu, const char *call, VkResult result, struct err *err);

#endif
