// Draws the display of a viewer: the rendered image and the panel, in a Vulkan image.
#include "gpu/gpu_internal.h"
#include <assert.h>
#include <math.h>
#include <string.h>

static_assert(sizeof(struct gpu_vertex) == 20, "the layout of Dear ImGui's vertices");

// --- the atlas ----------------------------------------------------------------------------------

static void atlas_barrier_to_read(struct gpu_commands *commands, const struct gpu_image *atlas)
{
    const VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_SHADER_READ_BIT,
        .oldLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
        .newLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = atlas->handle,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1},
    };
    vkCmdPipelineBarrier(commands->handle, VK_PIPELINE_STAGE_TRANSFER_BIT,
                         VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
}

static bool atlas_upload(struct gpu *gpu, struct gpu_screen *screen, const struct gpu_atlas *atlas,
                         struct err *err)
{
    struct gpu_buffer staging = {0};
    uint64_t bytes = (uint64_t)atlas->width * atlas->height;
    bool ok = buffer_allocate(gpu, "atlas staging", bytes, GPU_READBACK, false, &staging, err) &&
              gpu_begin(gpu, &screen->commands, err);
    if (ok) {
        memcpy(staging.mapped, atlas->coverage, bytes);
        image_discard(&screen->commands, &screen->atlas);
        image_fill(&screen->commands, &screen->atlas, atlas->width, atlas->height, &staging);
        atlas_barrier_to_read(&screen->commands, &screen->atlas);
        ok = gpu_submit(gpu, &screen->commands, err) && gpu_wait(gpu, &screen->commands, err);
    }
    gpu_buffer_finish(gpu, &staging);
    return ok;
}

static bool sides_check(const struct gpu *gpu, const char *what, uint32_t width, uint32_t height,
                        struct err *err)
{
    VkPhysicalDeviceProperties device;
    vkGetPhysicalDeviceProperties(gpu->physical, &device);
    uint32_t limit = device.limits.maxImageDimension2D;
    if (device.limits.maxFramebufferWidth < limit)
        limit = device.limits.maxFramebufferWidth;
    if (device.limits.maxFramebufferHeight < limit)
        limit = device.limits.maxFramebufferHeight;
    if (width > 0 && height > 0 && width <= limit && height <= limit)
        return true;
    return err_set(err, ERR_GPU,
                   "%s of %u x %u pixels; expected sides from 1 to %u pixels, the device's limit",
                   what, width, height, limit);
}

static bool atlas_create(struct gpu *gpu, struct gpu_screen *screen, const struct gpu_atlas *atlas,
                         struct err *err)
{
    if (!sides_check(gpu, "an atlas", atlas->width, atlas->height, err) ||
        !gpu_image_create(gpu, "atlas", VK_FORMAT_R8_UNORM, atlas->width, atlas->height,
                          VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                          &screen->atlas, err) ||
        !atlas_upload(gpu, screen, atlas, err))
        return false;
    const VkDescriptorImageInfo image = {screen->sampler, screen->atlas.view,
                                         VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    const VkWriteDescriptorSet write = {
        .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
        .dstSet = screen->set,
        .descriptorCount = 1,
        .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
        .pImageInfo = &image,
    };
    vkUpdateDescriptorSets(gpu->device, 1, &write, 0, NULL);
    return true;
}

// --- creation and size --------------------------------------------------------------------------

bool gpu_screen_create(struct gpu *gpu, const struct gpu_atlas *atlas, struct gpu_screen *out,
                       struct err *err)
{
    *out = (struct gpu_screen){0};
    if (!gpu->params.graphics)
        return err_set(err, ERR_BUG, "screen: the device was not opened for graphics");
    if (gpu_commands_create(gpu, &out->commands, err) && screen_pipeline_create(gpu, out, err) &&
        atlas_create(gpu, out, atlas, err))
        return true;
    gpu_screen_finish(gpu, out);
    return false;
}

// Destroys the image when the device is idle, because other users of the queue, such as a window,
// may still read the image.
static void picture_finish(struct gpu *gpu, struct gpu_screen *screen)
{
    if (screen->image.handle)
        gpu_settle(gpu);
    if (screen->framebuffer && !gpu->abandoned)
        vkDestroyFramebuffer(gpu->device, screen->framebuffer, NULL);
    gpu_image_finish(gpu, &screen->image);
    screen->framebuffer = VK_NULL_HANDLE;
    screen->width = screen->height = 0;
    screen->is_drawn = false;
}

void gpu_screen_finish(struct gpu *gpu, struct gpu_screen *screen)
{
    if (!screen || !screen->commands.pool)
        return;
    gpu_commands_finish(gpu, &screen->commands);
    picture_finish(gpu, screen);
    gpu_image_finish(gpu, &screen->atlas);
    gpu_buffer_finish(gpu, &screen->vertices);
    gpu_buffer_finish(gpu, &screen->indices);
    if (!gpu->abandoned)
        screen_pipeline_destroy(gpu, screen);
    *screen = (struct gpu_screen){0};
}

static bool framebuffer_create(struct gpu *gpu, struct gpu_screen *screen, uint32_t width,
                               uint32_t height, struct err *err)
{
    const VkFramebufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
        .renderPass = screen->render_pass,
        .attachmentCount = 1,
        .pAttachments = &screen->image.view,
        .width = width,
        .height = height,
        .layers = 1,
    };
    return VK(gpu, err, vkCreateFramebuffer(gpu->device, &info, NULL, &screen->framebuffer));
}

bool gpu_screen_resize(struct gpu *gpu, struct gpu_screen *screen, uint32_t width, uint32_t height,
                       struct err *err)
{
    if (screen->width == width && screen->height == height)
        return true;
    if (!sides_check(gpu, "a screen", width, height, err))
        return false;
    picture_finish(gpu, screen);
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                    VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                    VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    if (!gpu_image_create(gpu, "screen", VK_FORMAT_R8G8B8A8_UNORM, width, height, usage,
                          &screen->image, err) ||
        !framebuffer_create(gpu, screen, width, height, err)) {
        picture_finish(gpu, screen);
        return false;
    }
    screen->width = width;
    screen->height = height;
    return true;
}

// --- drawing ------------------------------------------------------------------------------------

// Makes sure that a buffer has at least this many bytes. A new buffer has at least twice the old
// size, so that a growing panel does not create one in every frame.
static bool buffer_grow(struct gpu *gpu, const char *name, uint64_t bytes,
                        struct gpu_buffer *buffer, struct err *err)
{
    if (buffer->handle && buffer->bytes >= bytes)
        return true;
    uint64_t larger = 2 * buffer->bytes > bytes ? 2 * buffer->bytes : bytes;
    gpu_buffer_finish(gpu, buffer);
    return buffer_allocate(gpu, name, larger, GPU_READBACK, false, buffer, err);
}

static bool drawing_check(const struct gpu_drawing *drawing, struct err *err)
{
    for (uint32_t i = 0; i < drawing->draw_count; i++) {
        const struct gpu_draw *draw = &drawing->draws[i];
        if (draw->first_index > drawing->index_count ||
            draw->index_count > drawing->index_count - draw->first_index ||
            (draw->index_count && draw->first_vertex >= drawing->vertex_count))
            return err_set(err, ERR_BUG,
                           "draw %u: its %u indices from index %u on or its vertices from vertex "
                           "%u on are outside the drawing, which has %u indices and %u vertices",
                           i, draw->index_count, draw->first_index, draw->first_vertex,
                           drawing->index_count, drawing->vertex_count);
    }
    return true;
}

static bool drawing_upload(struct gpu *gpu, struct gpu_screen *screen,
                           const struct gpu_drawing *drawing, struct err *err)
{
    uint64_t vertex_bytes = (uint64_t)drawing->vertex_count * sizeof *drawing->vertices;
    uint64_t index_bytes = (uint64_t)drawing->index_count * sizeof *drawing->indices;
    if (!buffer_grow(gpu, "screen vertices", vertex_bytes, &screen->vertices, err) ||
        !buffer_grow(gpu, "screen indices", index_bytes, &screen->indices, err))
        return false;
    if (vertex_bytes)
        memcpy(screen->vertices.mapped, drawing->vertices, vertex_bytes);
    if (index_bytes)
        memcpy(screen->indices.mapped, drawing->indices, index_bytes);
    return true;
}

// Converts a position in pixels to an integer in [0, size]; NaN becomes 0.
static int32_t on_screen(float position, uint32_t size)
{
    double rounded = floor((double)position + 0.5);
    return rounded > 0 ? (rounded < size ? (int32_t)rounded : (int32_t)size) : 0;
}

static bool scissor_set(struct gpu_screen *screen, const float clip[4])
{
    int32_t left = on_screen(clip[0], screen->width), right = on_screen(clip[2], screen->width);
    int32_t top = on_screen(clip[1], screen->height), bottom = on_screen(clip[3], screen->height);
    if (right <= left || bottom <= top)
        return false;
    const VkRect2D scissor = {{left, top}, {(uint32_t)(right - left), (uint32_t)(bottom - top)}};
    vkCmdSetScissor(screen->commands.handle, 0, 1, &scissor);
    return true;
}

static void drawing_record(struct gpu_screen *screen, const struct gpu_drawing *drawing)
{
    VkCommandBuffer commands = screen->commands.handle;
    const VkViewport viewport = {0, 0, (float)screen->width, (float)screen->height, 0, 1};
    const float clip_per_pixel[] = {2.0f / (float)screen->width, 2.0f / (float)screen->height};
    const VkDeviceSize start = 0;
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, screen->pipeline);
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, screen->pipeline_layout, 0,
                            1, &screen->set, 0, NULL);
    vkCmdPushConstants(commands, screen->pipeline_layout, VK_SHADER_STAGE_VERTEX_BIT, 0,
                       sizeof clip_per_pixel, clip_per_pixel);
    vkCmdBindVertexBuffers(commands, 0, 1, &screen->vertices.handle, &start);
    vkCmdBindIndexBuffer(commands, screen->indices.handle, 0, VK_INDEX_TYPE_UINT16);
    for (uint32_t i = 0; i < drawing->draw_count; i++) {
        const struct gpu_draw *draw = &drawing->draws[i];
        if (draw->index_count && scissor_set(screen, draw->clip))
            vkCmdDrawIndexed(commands, draw->index_count, 1, draw->first_index,
                             (int32_t)draw->first_vertex, 0);
    }
}

// The render pass runs even without triangles, because it transitions the image to its final
// layout.
static void pass_record(struct gpu_screen *screen, const struct gpu_drawing *drawing)
{
    const VkRenderPassBeginInfo begin = {
        .sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
        .renderPass = screen->render_pass,
        .framebuffer = screen->framebuffer,
        .renderArea = {{0, 0}, {screen->width, screen->height}},
    };
    vkCmdBeginRenderPass(screen->commands.handle, &begin, VK_SUBPASS_CONTENTS_INLINE);
    if (drawing && drawing->draw_count)
        drawing_record(screen, drawing);
    vkCmdEndRenderPass(screen->commands.handle);
}

static bool draw_time_read(struct gpu *gpu, struct gpu_screen *screen, struct err *err)
{
    double ns[2] = {0};
    if (!gpu_timestamps_ns(gpu, &screen->commands, ns, err))
        return false;
    screen->draw_ms = ns[1] * 1e-6;
    return true;
}

bool gpu_screen_draw(struct gpu *gpu, struct gpu_screen *screen, const struct gpu_buffer *pixels,
                     const struct gpu_drawing *drawing, struct err *err)
{
    uint64_t bytes = (uint64_t)screen->width * screen->height * 4;
    if (!screen->image.handle || pixels->bytes < bytes)
        return err_set(err, ERR_BUG,
                       "screen: %u x %u pixels cannot be drawn from a buffer of %llu bytes",
                       screen->width, screen->height, (unsigned long long)pixels->bytes);
    if ((drawing && (!drawing_check(drawing, err) || !drawing_upload(gpu, screen, drawing, err))) ||
        !gpu_begin(gpu, &screen->commands, err))
        return false;
    gpu_timestamp(gpu, &screen->commands);
    image_discard(&screen->commands, &screen->image);
    image_fill(&screen->commands, &screen->image, screen->width, screen->height, pixels);
    pass_record(screen, drawing);
    gpu_timestamp(gpu, &screen->commands);
    screen->is_drawn = false;
    if (!gpu_submit(gpu, &screen->commands, err) || !gpu_wait(gpu, &screen->commands, err) ||
        !draw_time_read(gpu, screen, err))
        return false;
    screen->is_drawn = true;
    return true;
}

bool gpu_screen_read(struct gpu *gpu, struct gpu_screen *screen, struct arena *arena,
                     uint8_t (**out)[4], struct err *err)
{
    if (!screen->is_drawn)
        return err_set(err, ERR_BUG, "screen: nothing was drawn before it was read");
    uint64_t bytes = (uint64_t)screen->width * screen->height * sizeof **out;
    *out = arena_alloc(arena, bytes, 1);
    if (!*out)
        return err_memory(err, "the screen's pixels", bytes);
    struct gpu_buffer readback = {0};
    bool ok = buffer_allocate(gpu, "screen readback", bytes, GPU_READBACK, false, &readback, err) &&
              gpu_begin(gpu, &screen->commands, err);
    if (ok) {
        const VkBufferImageCopy all = {
            .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
            .imageExtent = {screen->width, screen->height, 1},
        };
        vkCmdCopyImageToBuffer(screen->commands.handle, screen->image.handle,
                               VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, readback.handle, 1, &all);
        ok = gpu_submit(gpu, &screen->commands, err) && gpu_wait(gpu, &screen->commands, err);
    }
    if (ok)
        memcpy(*out, readback.mapped, bytes);
    gpu_buffer_finish(gpu, &readback);
    return ok;
}
