// Records, submits and times commands.
#include "gpu/gpu_internal.h"
#include "gpu/slow.h"
#include <assert.h>
#include <stdlib.h>

static bool query_pool_create(struct gpu *gpu, struct gpu_commands *commands, struct err *err)
{
    const VkQueryPoolCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
        .queryType = VK_QUERY_TYPE_TIMESTAMP,
        .queryCount = GPU_MAX_TIMESTAMPS,
    };
    return VK(gpu, err, vkCreateQueryPool(gpu->device, &info, NULL, &commands->queries));
}

static bool simulation_create(struct gpu *gpu, struct gpu_commands *commands, struct err *err)
{
    if (gpu->params.limits.group_ns == 0)
        return true;
    commands->slow = slow_create();
    if (!commands->slow)
        return err_memory(err, "a slow device", SLOW_DISPATCHES);
    return buffer_allocate(gpu, "slow device", SLOW_DISPATCHES * UINT64_C(16), GPU_READBACK, false,
                           &commands->slow_log, err);
}

bool commands_create_for_copies(struct gpu *gpu, struct gpu_commands *out, struct err *err)
{
    *out = (struct gpu_commands){0};
    const VkCommandPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
        .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
        .queueFamilyIndex = gpu->queue_family,
    };
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    VkCommandBufferAllocateInfo buffer = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
        .commandBufferCount = 1,
    };
    if (!VK(gpu, err, vkCreateCommandPool(gpu->device, &pool, NULL, &out->pool)))
        goto fail;
    buffer.commandPool = out->pool;
    if (!VK(gpu, err, vkAllocateCommandBuffers(gpu->device, &buffer, &out->handle)) ||
        !VK(gpu, err, vkCreateFence(gpu->device, &fence, NULL, &out->fence)))
        goto fail;
    return true;
fail:
    gpu_commands_finish(gpu, out);
    return false;
}

bool gpu_commands_create(struct gpu *gpu, struct gpu_commands *out, struct err *err)
{
    if (!commands_create_for_copies(gpu, out, err))
        return false;
    if ((!gpu->has_timestamps || query_pool_create(gpu, out, err)) &&
        simulation_create(gpu, out, err))
        return true;
    gpu_commands_finish(gpu, out);
    return false;
}

void gpu_commands_finish(struct gpu *gpu, struct gpu_commands *commands)
{
    if (!commands)
        return;
    gpu_wait(gpu, commands, NULL); // the device may still use the objects that are destroyed below
    if (commands->pool && !gpu->abandoned) {
        vkDestroyQueryPool(gpu->device, commands->queries, NULL);
        vkDestroyFence(gpu->device, commands->fence, NULL);
        vkDestroyCommandPool(gpu->device, commands->pool, NULL); // frees the command buffer
    }
    gpu_buffer_finish(gpu, &commands->slow_log);
    free(commands->slow);
    *commands = (struct gpu_commands){0};
}

bool gpu_begin(struct gpu *gpu, struct gpu_commands *commands, struct err *err)
{
    const VkCommandBufferBeginInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
    };
    if (!gpu->device) // gpu_reopen() failed
        return gpu_fail(gpu, "recording", VK_ERROR_DEVICE_LOST, err);
    if (!gpu_wait(gpu, commands, err) ||
        !VK(gpu, err, vkResetCommandPool(gpu->device, commands->pool, 0)) ||
        !VK(gpu, err, vkBeginCommandBuffer(commands->handle, &info)))
        return false;
    commands->timestamp_count = 0;
    commands->bindings = NULL;
    commands->set = VK_NULL_HANDLE;
    commands->failure = (struct err){0};
    slow_begin(commands->slow);
    commands->awaited = commands->signalled = VK_NULL_HANDLE;
    if (commands->queries)
        vkCmdResetQueryPool(commands->handle, commands->queries, 0, GPU_MAX_TIMESTAMPS);
    return true;
}

void gpu_bind(struct gpu *gpu, struct gpu_commands *commands, struct gpu_bindings *bindings)
{
    (void)gpu;
    commands->bindings = bindings;
}

void gpu_push(struct gpu *gpu, struct gpu_commands *commands, const void *data, uint32_t bytes)
{
    assert(bytes <= GPU_PUSH_BYTES && bytes % 4 == 0);
    // All pipeline layouts declare the same push constants, so that constants pushed through one
    // layout are valid for every kernel.
    vkCmdPushConstants(commands->handle, gpu->layouts->pipeline, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                       bytes, data);
}

// Binds the kernel and the buffers that it uses. Returns false and sets commands->failure if there
// is no memory for their descriptors.
static bool bind_kernel(struct gpu *gpu, struct gpu_commands *commands,
                        const struct gpu_kernel *kernel)
{
    VkDescriptorSet set = VK_NULL_HANDLE;
    if (kernel->layout->bindings &&
        !sets_find(gpu, commands->bindings, kernel->layout, &set, &commands->failure))
        return err_prepend(&commands->failure, "kernel %s", kernel->name);
    if (set && set != commands->set) {
        vkCmdBindDescriptorSets(commands->handle, VK_PIPELINE_BIND_POINT_COMPUTE,
                                kernel->layout->pipeline, 0, 1, &set, 0, NULL);
        commands->set = set;
    }
    vkCmdBindPipeline(commands->handle, VK_PIPELINE_BIND_POINT_COMPUTE, kernel->pipeline);
    return true;
}

void gpu_dispatch(struct gpu *gpu, struct gpu_commands *commands, const struct gpu_kernel *kernel,
                  uint32_t groups_x)
{
    assert(groups_x <= gpu->max_groups);
    slow_dispatch(commands->slow, groups_x);
    if (bind_kernel(gpu, commands, kernel))
        vkCmdDispatch(commands->handle, groups_x, 1, 1);
}

void gpu_dispatch_indirect(struct gpu *gpu, struct gpu_commands *commands,
                           const struct gpu_kernel *kernel, const struct gpu_buffer *arguments,
                           uint64_t offset)
{
    uint64_t at = slow_dispatch_indirect(commands->slow);
    if (at != UINT64_MAX) {
        gpu_copy(gpu, commands, arguments, offset, &commands->slow_log, at, 12);
        gpu_barrier(gpu, commands);
    }
    if (bind_kernel(gpu, commands, kernel))
        vkCmdDispatchIndirect(commands->handle, arguments->handle, offset);
}

// The source stages include the reading of indirect arguments, because later commands may overwrite
// these.
void gpu_barrier(struct gpu *gpu, struct gpu_commands *commands)
{
    (void)gpu;
    const VkPipelineStageFlags work = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT |
                                      VK_PIPELINE_STAGE_TRANSFER_BIT |
                                      VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT;
    const VkMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT |
                         VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT |
                         VK_ACCESS_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_UNIFORM_READ_BIT |
                         VK_ACCESS_HOST_READ_BIT | VK_ACCESS_HOST_WRITE_BIT,
    };
    vkCmdPipelineBarrier(commands->handle, work, work | VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &barrier,
                         0, NULL, 0, NULL);
}

void gpu_fill(struct gpu *gpu, struct gpu_commands *commands, const struct gpu_buffer *buffer,
              uint64_t offset, uint64_t bytes, uint32_t value)
{
    (void)gpu;
    vkCmdFillBuffer(commands->handle, buffer->handle, offset, bytes, value);
}

void gpu_copy(struct gpu *gpu, struct gpu_commands *commands, const struct gpu_buffer *from,
              uint64_t from_offset, const struct gpu_buffer *to, uint64_t to_offset, uint64_t bytes)
{
    (void)gpu;
    const VkBufferCopy region = {from_offset, to_offset, bytes};
    vkCmdCopyBuffer(commands->handle, from->handle, to->handle, 1, &region);
}

// After graphics commands, lavapipe 22.3 queues timestamps with the triangles and executes them at
// the next flush, which comes after the following kernel. A barrier after the timestamp forces a
// flush before that kernel.
static void settle_timestamp(struct gpu *gpu, struct gpu_commands *commands)
{
    if (gpu->params.graphics && gpu->info.is_cpu)
        gpu_barrier(gpu, commands);
}

uint32_t gpu_timestamp(struct gpu *gpu, struct gpu_commands *commands)
{
    if (!commands->queries || commands->timestamp_count == GPU_MAX_TIMESTAMPS)
        return UINT32_MAX;
    vkCmdWriteTimestamp(commands->handle, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, commands->queries,
                        commands->timestamp_count);
    settle_timestamp(gpu, commands);
    slow_timestamp(commands->slow, commands->timestamp_count);
    return commands->timestamp_count++;
}

static VkResult submit_call(struct gpu *gpu, const struct gpu_commands *commands)
{
    if (++gpu->submit_count == gpu->params.lose_device_at_submit || gpu->lost)
        return VK_ERROR_DEVICE_LOST;
    const VkPipelineStageFlags transfers = VK_PIPELINE_STAGE_TRANSFER_BIT;
    const VkSubmitInfo info = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
        .waitSemaphoreCount = commands->awaited ? 1 : 0,
        .pWaitSemaphores = &commands->awaited,
        .pWaitDstStageMask = &transfers,
        .commandBufferCount = 1,
        .pCommandBuffers = &commands->handle,
        .signalSemaphoreCount = commands->signalled ? 1 : 0,
        .pSignalSemaphores = &commands->signalled,
    };
    return vkQueueSubmit(gpu->queue, 1, &info, commands->fence);
}

bool gpu_submit(struct gpu *gpu, struct gpu_commands *commands, struct err *err)
{
    if (commands->failure.code != ERR_NONE) {
        if (err)
            *err = commands->failure;
        return false;
    }
    gpu_barrier(gpu, commands);
    if (!VK(gpu, err, vkEndCommandBuffer(commands->handle)) ||
        !VK(gpu, err, vkResetFences(gpu->device, 1, &commands->fence)))
        return false;
    VkResult result = submit_call(gpu, commands);
    if (result != VK_SUCCESS)
        return gpu_fail(gpu, "vkQueueSubmit", result, err);
    commands->pending = true;
    return true;
}

void gpu_settle(struct gpu *gpu)
{
    gpu->abandoned = gpu->abandoned || vkDeviceWaitIdle(gpu->device) != VK_SUCCESS;
}

bool gpu_wait(struct gpu *gpu, struct gpu_commands *commands, struct err *err)
{
    if (!commands->pending)
        return true;
    // There is no time limit: a driver reports a hanging device as lost. The wait is repeated in
    // slices of a second, because a timeout of UINT64_MAX overflows in some drivers.
    const uint64_t slice_ns = UINT64_C(1000000000);
    VkResult result;
    do
        result = vkWaitForFences(gpu->device, 1, &commands->fence, VK_TRUE, slice_ns);
    while (result == VK_TIMEOUT);
    commands->pending = false;
    if (result == VK_SUCCESS)
        result = slow_wait(gpu, commands->slow, commands->slow_log.mapped);
    if (result == VK_SUCCESS)
        return true;
    gpu_settle(gpu);
    return gpu_fail(gpu, "vkWaitForFences", result, err);
}

bool gpu_timestamps_ns(struct gpu *gpu, struct gpu_commands *commands, double *out, struct err *err)
{
    uint64_t ticks[GPU_MAX_TIMESTAMPS];
    uint32_t count = commands->timestamp_count;
    if (!gpu_wait(gpu, commands, err))
        return false;
    if (count == 0)
        return true;
    if (!VK(gpu, err,
            vkGetQueryPoolResults(gpu->device, commands->queries, 0, count, sizeof ticks, ticks,
                                  sizeof ticks[0], VK_QUERY_RESULT_64_BIT)))
        return false;
    // The counter wraps at its valid bits; differences modulo 2^bits are correct nevertheless.
    for (uint32_t i = 0; i < count; i++)
        out[i] = (double)((ticks[i] - ticks[0]) & gpu->timestamp_mask) * gpu->timestamp_ns;
    slow_timestamps(gpu, commands->slow, commands->slow_log.mapped, count, out);
    return true;
}
