// Creates images: render targets and textures.
#include "gpu/gpu_internal.h"

static bool handle_create(struct gpu *gpu, VkFormat format, uint32_t width, uint32_t height,
                          VkImageUsageFlags usage, VkImage *out, struct err *err)
{
    const VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .imageType = VK_IMAGE_TYPE_2D,
        .format = format,
        .extent = {width, height, 1},
        .mipLevels = 1,
        .arrayLayers = 1,
        .samples = VK_SAMPLE_COUNT_1_BIT,
        .tiling = VK_IMAGE_TILING_OPTIMAL,
        .usage = usage,
        .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
        .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
    };
    return VK(gpu, err, vkCreateImage(gpu->device, &info, NULL, out));
}

static bool memory_create(struct gpu *gpu, struct gpu_image *image, struct err *err)
{
    VkMemoryRequirements needs;
    VkMemoryPropertyFlags flags;
    vkGetImageMemoryRequirements(gpu->device, image->handle, &needs);
    if (!memory_allocate(gpu, &needs, GPU_DEVICE, &flags, &image->memory, err))
        return false;
    image->bytes = needs.size;
    memory_count(gpu, needs.size);
    return VK(gpu, err, vkBindImageMemory(gpu->device, image->handle, image->memory, 0));
}

static bool view_create(struct gpu *gpu, VkFormat format, struct gpu_image *image, struct err *err)
{
    const VkImageViewCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = image->handle,
        .viewType = VK_IMAGE_VIEW_TYPE_2D,
        .format = format,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1},
    };
    return VK(gpu, err, vkCreateImageView(gpu->device, &info, NULL, &image->view));
}

bool gpu_image_create(struct gpu *gpu, const char *name, VkFormat format, uint32_t width,
                      uint32_t height, VkImageUsageFlags usage, struct gpu_image *out,
                      struct err *err)
{
    const VkImageUsageFlags seen = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    *out = (struct gpu_image){0};
    if (!handle_create(gpu, format, width, height, usage, &out->handle, err) ||
        !memory_create(gpu, out, err) || ((usage & seen) && !view_create(gpu, format, out, err))) {
        gpu_image_finish(gpu, out);
        return err_prepend(err, "image %s, %u x %u pixels", name, width, height);
    }
    DEBUG_NAME(gpu, IMAGE, out->handle, name);
    return true;
}

void gpu_image_finish(struct gpu *gpu, struct gpu_image *image)
{
    if (image->handle && !gpu->abandoned) {
        vkDestroyImageView(gpu->device, image->view, NULL);
        vkDestroyImage(gpu->device, image->handle, NULL);
        vkFreeMemory(gpu->device, image->memory, NULL);
    }
    gpu->allocated_bytes -= image->bytes;
    *image = (struct gpu_image){0};
}

void image_discard(struct gpu_commands *commands, const struct gpu_image *image)
{
    const VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
        .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
        .newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image->handle,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1},
    };
    vkCmdPipelineBarrier(commands->handle,
                         VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT,
                         VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
}

void image_fill(struct gpu_commands *commands, const struct gpu_image *image, uint32_t width,
                uint32_t height, const struct gpu_buffer *pixels)
{
    const VkBufferImageCopy all = {
        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .imageExtent = {width, height, 1},
    };
    vkCmdCopyBufferToImage(commands->handle, pixels->handle, image->handle,
                           VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &all);
}
