// A thin layer over Vulkan: every vk* call of the renderer is in this folder. Raw handles stay
// visible. There is one queue, one push-constant block, and one numbering of bindings for all
// kernels; each kernel's layout has those that its code uses.
//
// Threads: one thread at a time may use a struct gpu and its objects; several may use one each.
#ifndef LAMPYRIS_GPU_GPU_H
#define LAMPYRIS_GPU_GPU_H

#include "base/arena.h"
#include "base/err.h"
#include "gpu/params.h"
#include <stdbool.h>
#include <stdint.h>
#include <volk.h>

#define GPU_FIRST_STORAGE 16 // storage-buffer bindings 0 .. 15
#define GPU_MAX_STORAGE 32   // including those after GPU_UNIFORM_BINDING
#define GPU_MAX_TEXEL 12     // uniform-texel-buffer bindings, GPU_FIRST_STORAGE + 0 .. 11
#define GPU_UNIFORM_BINDING (GPU_FIRST_STORAGE + GPU_MAX_TEXEL) // the one uniform buffer
#define GPU_MAX_BINDINGS (GPU_MAX_STORAGE + GPU_MAX_TEXEL + 1)
#define GPU_PUSH_BYTES 128
#define GPU_MAX_CONSTANTS 64 // specialization constants of a kernel
#define GPU_KEPT_KERNELS 64
#define GPU_MAX_DEVICES 16
#define GPU_MIN_INVOCATIONS 128 // threads a workgroup that kernels may count on

struct gpu_device_info {
    uint32_t index;
    char name[256];
    char driver[512];   // name, version and info of the driver
    const char *kind;   // "discrete GPU", "integrated GPU", "virtual GPU", "CPU", "other"
    bool is_cpu;        // runs on the processor (lavapipe, SwiftShader)
    bool shares_memory; // device memory is the host's memory
    uint32_t api_version;
    uint64_t memory_bytes; // largest device-local heap
    char unusable[256];    // "", or what it lacks for us
};

// Lists the first GPU_MAX_DEVICES devices in the loader's order; fails with ERR_NO_VULKAN when
// there is no loader or driver.
bool gpu_list_devices(struct gpu_device_info out[GPU_MAX_DEVICES], uint32_t *count,
                      struct err *err);

// The layout for a set of bindings that a kernel's code uses. Kernels with the same set share it;
// the device keeps it until it is closed.
struct gpu_layout {
    uint64_t bindings; // bit i: binding i
    VkDescriptorSetLayout set;
    VkPipelineLayout pipeline;
    struct gpu_layout *next;
};

struct gpu_kernel {
    VkPipeline pipeline;
    const struct gpu_layout *layout;
    const char *name;
    // The module and the derivation from which it was made.
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
    // The limits in use, after overrides.
    uint64_t max_storage_range;
    uint64_t max_texel_elements; // 0 without texel buffers
    uint32_t storage_count;      // storage buffers that one kernel may bind
    uint32_t texel_count;        // uniform texel buffers that one kernel may bind
    uint64_t max_allocation;
    uint64_t storage_alignment; // offsets of storage ranges are multiples of this, bytes
    uint32_t max_groups;        // workgroups in x a dispatch
    uint32_t max_invocations;   // threads a workgroup
    uint64_t max_shared_bytes;  // memory that a workgroup shares
    uint32_t subgroup_size;
    bool has_ballot;        // ballot and arithmetic subgroup operations in compute
    bool rounds_to_nearest; // kernels ask for it: VK_KHR_shader_float_controls
    bool has_timestamps;
    double timestamp_ns;          // nanoseconds a tick
    uint64_t timestamp_mask;      // the bits of a tick count that are valid
    uint32_t validation_messages; // warnings and errors of the validation layers so far; gpu_close
                                  // keeps it, so that objects left over can be counted
    bool lost;                    // VK_ERROR_DEVICE_LOST was seen
    bool out_of_memory;           // VK_ERROR_OUT_OF_DEVICE_MEMORY; whoever goes on takes it back
    bool abandoned;               // it may still be working, so nothing is destroyed any more
    uint64_t allocated_bytes, peak_bytes; // bytes of buffers, including staging, and of images

    struct gpu_layout *layouts; // the first one made, which stands last, has no bindings
    VkPipelineCache pipeline_cache;
    // Pipelines of destroyed kernels, kept for reuse: drivers take up to half a second to make the
    // pipelines of a renderer. The oldest is evicted first.
    struct gpu_kernel kept[GPU_KEPT_KERNELS];
    uint32_t kept_next;
    VkDebugUtilsMessengerEXT messenger;
    struct gpu_commands *copying; // used by synchronous copies; NULL before the first one
    struct gpu_params params;
    uint32_t allocation_count, submit_count;
};

// params may be NULL: defaults. *out must not move until gpu_close, because the validation layers
// hold its address.
bool gpu_open(const struct gpu_params *params, struct gpu *out, struct err *err);
void gpu_close(struct gpu *gpu); // accepts NULL and {0}
// Closes the device, which may be lost, and opens it again: all its objects must be finished
// before. On failure *gpu has no device, is lost, and can be closed.
bool gpu_reopen(struct gpu *gpu, struct err *err);

// Returns the device memory that is still available: the value of VK_EXT_memory_budget, or else the
// rest of the largest heap; limited by the host's free memory if that is also the device's.
uint64_t gpu_memory_free(const struct gpu *gpu);

// --- buffers ------------------------------------------------------------------------------------
enum gpu_memory {
    GPU_DEVICE,   // the fastest for kernels; also mapped where the host shares it
    GPU_READBACK, // always mapped, and cached where possible
};

struct gpu_buffer {
    VkBuffer handle;
    VkDeviceMemory memory;
    uint64_t bytes;
    VkBufferView texel_view; // RGBA32_UINT over the whole buffer, or VK_NULL_HANDLE
    void *mapped;            // NULL where not mapped
    const char *name;        // the caller's, who keeps it while the buffer lives
};

// texel: also creates a uniform texel view (the size must fit the limit: call gpu_texel_fits
// before). Usage: storage, indirect, transfer. A size of 0 becomes 16. Zero-filled.
bool gpu_buffer_create(struct gpu *gpu, const char *name, uint64_t bytes, enum gpu_memory memory,
                       bool texel, struct gpu_buffer *out, struct err *err);
void gpu_buffer_finish(struct gpu *gpu, struct gpu_buffer *buffer); // accepts NULL and {0}
bool gpu_texel_fits(const struct gpu *gpu, uint64_t bytes);
// Copy synchronously, if needed through staging memory in pieces of at most 64 MiB.
bool gpu_upload(struct gpu *gpu, struct gpu_buffer *buffer, uint64_t offset, const void *data,
                uint64_t bytes, struct err *err);
bool gpu_download(struct gpu *gpu, const struct gpu_buffer *buffer, uint64_t offset, void *data,
                  uint64_t bytes, struct err *err);

// --- kernels ------------------------------------------------------------------------------------
struct gpu_kernel_params {
    const char *name;
    const uint32_t *spirv;
    size_t spirv_bytes;
    const uint32_t *constants; // specialization constants with ids 0 .. count-1, 32 bits each
    uint32_t constant_count;
    // The original module, if this SPIR-V was derived from another one, and a number that
    // identifies the derivation: both are part of the pipeline's key. NULL: it was not derived.
    const uint32_t *made_from;
    uint64_t variant;
};

// The code, or the module from which it was derived, must outlive the device. Fails if the kernel
// binds more buffers than the device supports.
bool gpu_kernel_create(struct gpu *gpu, const struct gpu_kernel_params *params,
                       struct gpu_kernel *out, struct err *err);
// Destroys the kept pipelines of this code, so that it may be freed.
void gpu_kernels_forget(struct gpu *gpu, const uint32_t *spirv);
// The device keeps the pipeline for later kernels with the same code and constants. Accepts NULL
// and {0}.
void gpu_kernel_finish(struct gpu *gpu, struct gpu_kernel *kernel);

#define GPU_MAX_STATISTICS 32

// A statistic of a compiled kernel, with the driver's name for it: registers, instructions, ...
struct gpu_statistic {
    char name[VK_MAX_DESCRIPTION_SIZE];
    double value; // 0 or 1 of what is false or true
};

// Reads the first GPU_MAX_STATISTICS of them; needs a device that was opened with
// params.statistics.
bool gpu_kernel_statistics(struct gpu *gpu, const struct gpu_kernel *kernel,
                           struct gpu_statistic out[GPU_MAX_STATISTICS], uint32_t *count,
                           struct err *err);

// --- bindings -----------------------------------------------------------------------------------
// Buffers for all bindings. Kernels find those that they name in descriptor sets, one for each
// layout, which are made when the first kernel of that layout is dispatched. Every binding is
// always valid: those left {0} are bound to a small dummy buffer that the bindings own.
struct gpu_binding {
    const struct gpu_buffer *buffer; // NULL: the dummy
    uint64_t offset, bytes; // the range, from a multiple of storage_alignment; bytes 0: to the end
};

struct gpu_bindings {
    struct gpu_buffer dummy;
    VkDescriptorBufferInfo storage[GPU_MAX_STORAGE], uniform;
    VkBufferView texel[GPU_MAX_TEXEL];
    struct gpu_sets *sets; // see sets.c; NULL: none was needed yet
};

// storage, texel, uniform: NULL for none. Texel buffers need a texel view. The buffers must outlive
// the bindings.
bool gpu_bindings_create(struct gpu *gpu, const struct gpu_binding storage[GPU_MAX_STORAGE],
                         const struct gpu_buffer *const texel[GPU_MAX_TEXEL],
                         const struct gpu_buffer *uniform, struct gpu_bindings *out,
                         struct err *err);
// Binds other buffers instead. No commands that use the bindings may be pending, and commands
// recorded with them before become invalid.
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
    struct gpu_slow *slow; // see slow.h; NULL: nothing is simulated
    struct gpu_buffer slow_log;
    VkQueryPool queries; // VK_NULL_HANDLE without timestamps
    uint32_t timestamp_count;
    bool pending;
    struct gpu_bindings *bindings; // the argument of gpu_bind
    VkDescriptorSet set;           // the one of them that is bound
    struct err failure;            // during recording; gpu_submit returns it
    // Set after gpu_begin, for one submission, or VK_NULL_HANDLE: its transfers wait for `awaited`,
    // and it signals `signalled`.
    VkSemaphore awaited, signalled;
};

bool gpu_commands_create(struct gpu *gpu, struct gpu_commands *out, struct err *err);
void gpu_commands_finish(struct gpu *gpu, struct gpu_commands *commands);
// Starts recording anew; waits for a submission of these commands that is still pending.
bool gpu_begin(struct gpu *gpu, struct gpu_commands *commands, struct err *err);
// Binds buffers for the following dispatches. The bindings must stay valid until the commands are
// submitted.
void gpu_bind(struct gpu *gpu, struct gpu_commands *commands, struct gpu_bindings *bindings);
void gpu_push(struct gpu *gpu, struct gpu_commands *commands, const void *data, uint32_t bytes);
void gpu_dispatch(struct gpu *gpu, struct gpu_commands *commands, const struct gpu_kernel *kernel,
                  uint32_t groups_x);
void gpu_dispatch_indirect(struct gpu *gpu, struct gpu_commands *commands,
                           const struct gpu_kernel *kernel, const struct gpu_buffer *arguments,
                           uint64_t offset);
// Makes all previous shader writes and transfers visible to all later shader, indirect and transfer
// (after the fence also host) reads and writes.
void gpu_barrier(struct gpu *gpu, struct gpu_commands *commands);
void gpu_fill(struct gpu *gpu, struct gpu_commands *commands, const struct gpu_buffer *buffer,
              uint64_t offset, uint64_t bytes, uint32_t value);
void gpu_copy(struct gpu *gpu, struct gpu_commands *commands, const struct gpu_buffer *from,
              uint64_t from_offset, const struct gpu_buffer *to, uint64_t to_offset,
              uint64_t bytes);
// Returns the index of the timestamp, or UINT32_MAX if there is none (not supported, or the pool is
// full).
uint32_t gpu_timestamp(struct gpu *gpu, struct gpu_commands *commands);
// Ends recording with a barrier, so that the next submission and, after gpu_wait, the host see all
// writes. Fails if recording failed for lack of memory for descriptor sets; nothing is submitted
// then.
bool gpu_submit(struct gpu *gpu, struct gpu_commands *commands, struct err *err);
bool gpu_wait(struct gpu *gpu, struct gpu_commands *commands, struct err *err);
// Waits as gpu_wait does; then writes all timestamp_count timestamps, in nanoseconds since
// timestamp 0.
bool gpu_timestamps_ns(struct gpu *gpu, struct gpu_commands *commands, double *out,
                       struct err *err);

// Returns a function of an extension that was enabled for the instance or the device. volk's
// pointers to such functions are unusable: they are those of the process's first instance.
PFN_vkVoidFunction gpu_function(const struct gpu *gpu, const char *name);

// Waits until the device is idle, so that its objects may be destroyed. If that cannot be
// determined, the device is abandoned: from then on its objects are not destroyed until the process
// ends. Called wherever waiting failed.
void gpu_settle(struct gpu *gpu);

// Sets the failing call and its VkResult as text; ERR_GPU. Returns false.
bool gpu_fail(struct gpu *gpu, const char *call, VkResult result, struct err *err);

#endif
