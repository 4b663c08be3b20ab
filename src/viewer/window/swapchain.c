// Presents images in the window.
#include "viewer/window/swapchain.h"

#include "viewer/window/swapchain_choose.h"

// The time to wait for an image, in nanoseconds: longer than a frame of any display. A window that
// is not visible may never get an image; then the image is skipped, and the program continues.
#define ACQUIRE_NS UINT64_C(100000000)
// The number of lost surfaces, without an image in between, after which presentation fails. This
// ends the loop if the window system no longer works.
#define MAX_LOST_SURFACES 4

static bool succeeds(struct gpu *gpu, const char *call, VkResult result, struct err *err)
{
    return result == VK_SUCCESS || gpu_fail(gpu, call, result, err);
}

// Returns whether the work on this image can go on. Sets *failed if it cannot and recreating the
// swapchain does not help.
static bool goes_on(struct gpu *gpu, struct swapchain *swapchain, const char *call, VkResult result,
                    bool *failed, struct err *err)
{
    switch (result) {
    case VK_SUCCESS:
        return true;
    case VK_SUBOPTIMAL_KHR:
        // If the first image of a swapchain is suboptimal, recreating the swapchain does not help.
        swapchain->is_suboptimal |= swapchain->shown == swapchain->shown_before_made;
        swapchain->is_stale |= !swapchain->is_suboptimal;
        return true;
    case VK_NOT_READY:
    case VK_TIMEOUT:
        return false;
    case VK_ERROR_OUT_OF_DATE_KHR:
        swapchain->is_stale = true;
        return false;
    case VK_ERROR_SURFACE_LOST_KHR:
        swapchain->is_surface_lost = true;
        if (++swapchain->lost_in_a_row <= MAX_LOST_SURFACES)
            return false;
        // fallthrough
    default:
        *failed = true;
        return gpu_fail(gpu, call, result, err);
    }
}

// --- parts of a swapchain ------------------------------------------------------------------------

static void calls_load(struct gpu *gpu, struct swapchain_calls *out)
{
#define INSTANCE(name) (PFN_##name) gpu_function(gpu, #name)
#define DEVICE(name) (PFN_##name) vkGetDeviceProcAddr(gpu->device, #name)
    *out = (struct swapchain_calls){
        .destroy_surface = INSTANCE(vkDestroySurfaceKHR),
        .support = INSTANCE(vkGetPhysicalDeviceSurfaceSupportKHR),
        .capabilities = INSTANCE(vkGetPhysicalDeviceSurfaceCapabilitiesKHR),
        .formats = INSTANCE(vkGetPhysicalDeviceSurfaceFormatsKHR),
        .present_modes = INSTANCE(vkGetPhysicalDeviceSurfacePresentModesKHR),
        .create = DEVICE(vkCreateSwapchainKHR),
        .destroy = DEVICE(vkDestroySwapchainKHR),
        .images = DEVICE(vkGetSwapchainImagesKHR),
        .acquire = DEVICE(vkAcquireNextImageKHR),
        .present = DEVICE(vkQueuePresentKHR),
    };
#undef INSTANCE
#undef DEVICE
}

// Frees all parts except the swapchain itself, which is passed to the creation of its successor.
static void images_finish(struct gpu *gpu, struct swapchain *swapchain)
{
    gpu_settle(gpu);
    for (uint32_t i = 0; i < SWAPCHAIN_IMAGES_MAX; i++) {
        if (!gpu->abandoned)
            vkDestroySemaphore(gpu->device, swapchain->copied[i], NULL);
        swapchain->copied[i] = VK_NULL_HANDLE;
    }
    if (!gpu->abandoned)
        vkDestroySemaphore(gpu->device, swapchain->acquired, NULL);
    swapchain->acquired = VK_NULL_HANDLE;
    gpu_image_finish(gpu, &swapchain->converted);
    swapchain->image_count = 0;
}

static void handle_finish(struct gpu *gpu, struct swapchain *swapchain)
{
    images_finish(gpu, swapchain);
    if (swapchain->handle && !gpu->abandoned)
        swapchain->calls.destroy(gpu->device, swapchain->handle, NULL);
    swapchain->handle = VK_NULL_HANDLE;
}

static void surface_finish(struct gpu *gpu, struct swapchain *swapchain)
{
    handle_finish(gpu, swapchain);
    if (swapchain->surface && !gpu->abandoned)
        swapchain->calls.destroy_surface(gpu->instance, swapchain->surface, NULL);
    swapchain->surface = VK_NULL_HANDLE;
}

static bool surface_create(struct gpu *gpu, struct swapchain *swapchain, struct window *window,
                           struct err *err)
{
    swapchain->surface_of = window->handle;
    swapchain->is_surface_lost = false;
    VkBool32 shows = VK_FALSE;
    if (!window_create_surface(window, gpu->instance, &swapchain->surface, err) ||
        !succeeds(
            gpu, "vkGetPhysicalDeviceSurfaceSupportKHR",
            swapchain->calls.support(gpu->physical, gpu->queue_family, swapchain->surface, &shows),
            err))
        return false;
    return shows ||
           err_set(err, ERR_GPU, "%s cannot present images in this window", gpu->info.name);
}

static bool semaphores_create(struct gpu *gpu, struct swapchain *swapchain, struct err *err)
{
    const VkSemaphoreCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    bool ok = succeeds(gpu, "vkCreateSemaphore",
                       vkCreateSemaphore(gpu->device, &info, NULL, &swapchain->acquired), err);
    for (uint32_t i = 0; ok && i < swapchain->image_count; i++)
        ok = succeeds(gpu, "vkCreateSemaphore",
                      vkCreateSemaphore(gpu->device, &info, NULL, &swapchain->copied[i]), err);
    return ok;
}

static bool images_create(struct gpu *gpu, struct swapchain *swapchain, struct err *err)
{
    uint32_t count = 0;
    if (!succeeds(gpu, "vkGetSwapchainImagesKHR",
                  swapchain->calls.images(gpu->device, swapchain->handle, &count, NULL), err))
        return false;
    if (count > SWAPCHAIN_IMAGES_MAX)
        return err_set(err, ERR_GPU, "%s needs %u images for this window; expected at most %d",
                       gpu->info.name, count, SWAPCHAIN_IMAGES_MAX);
    swapchain->image_count = count;
    VkFormat twin = swapchain_twin(swapchain->format);
    return succeeds(
               gpu, "vkGetSwapchainImagesKHR",
               swapchain->calls.images(gpu->device, swapchain->handle, &count, swapchain->images),
               err) &&
           semaphores_create(gpu, swapchain, err) &&
           (!twin ||
            gpu_image_create(gpu, "converted", twin, swapchain->width, swapchain->height,
                             VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                             &swapchain->converted, err));
}

// --- creation ------------------------------------------------------------------------------------

struct offer {
    VkSurfaceCapabilitiesKHR capabilities;
    VkSurfaceFormatKHR formats[256];
    VkPresentModeKHR modes[32];
    uint32_t format_count, mode_count;
};

// Reads what the surface offers. If there are more entries than there is space for, the first ones
// are enough to choose from.
static VkResult offer_read(const struct gpu *gpu, const struct swapchain *swapchain,
                           struct offer *out)
{
    const struct swapchain_calls *calls = &swapchain->calls;
    out->format_count = sizeof out->formats / sizeof out->formats[0];
    out->mode_count = sizeof out->modes / sizeof out->modes[0];
    VkResult result = calls->capabilities(gpu->physical, swapchain->surface, &out->capabilities);
    if (result == VK_SUCCESS)
        result =
            calls->formats(gpu->physical, swapchain->surface, &out->format_count, out->formats);
    if (result >= VK_SUCCESS)
        result =
            calls->present_modes(gpu->physical, swapchain->surface, &out->mode_count, out->modes);
    return result > VK_SUCCESS ? VK_SUCCESS : result;
}

static bool offer_check(const struct gpu *gpu, const struct offer *offer, VkFormat format,
                        struct err *err)
{
    if (format == VK_FORMAT_UNDEFINED)
        return err_set(err, ERR_GPU,
                       "%s offers %u formats for this window; expected one with 8 bits per channel",
                       gpu->info.name, offer->format_count);
    if (!(offer->capabilities.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT))
        return err_set(err, ERR_GPU, "%s cannot copy images into this window", gpu->info.name);
    return true;
}

static VkCompositeAlphaFlagBitsKHR composite_alpha(const VkSurfaceCapabilitiesKHR *surface)
{
    VkCompositeAlphaFlagsKHR offered = surface->supportedCompositeAlpha;
    if (offered & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR)
        return VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
    // At least one bit is set; images are opaque, so that all modes give the same result.
    return 1u << __builtin_ctz(offered);
}

static VkResult handle_create(struct gpu *gpu, struct swapchain *swapchain,
                              const struct offer *offer, VkSurfaceFormatKHR format)
{
    const VkSurfaceCapabilitiesKHR *surface = &offer->capabilities;
    bool as_it_is = surface->supportedTransforms & VK_SURFACE_TRANSFORM_IDENTITY_BIT_KHR;
    VkSwapchainKHR old = swapchain->handle;
    const VkSwapchainCreateInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
        .surface = swapchain->surface,
        .minImageCount = swapchain_choose_count(surface, swapchain->present_mode),
        .imageFormat = format.format,
        .imageColorSpace = format.colorSpace,
        .imageExtent = {swapchain->width, swapchain->height},
        .imageArrayLayers = 1,
        .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT,
        .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
        .preTransform =
            as_it_is ? VK_SURFACE_TRANSFORM_IDENTITY_BIT_KHR : surface->currentTransform,
        .compositeAlpha = composite_alpha(surface),
        .presentMode = swapchain->present_mode,
        .clipped = VK_TRUE,
        .oldSwapchain = old,
    };
    swapchain->handle = VK_NULL_HANDLE;
    VkResult result = swapchain->calls.create(gpu->device, &info, NULL, &swapchain->handle);
    if (result != VK_SUCCESS)
        swapchain->handle = VK_NULL_HANDLE;
    if (old) // the old swapchain is retired even if creation fails
        swapchain->calls.destroy(gpu->device, old, NULL);
    return result;
}

// Recreates the swapchain. Returns false if there is none afterwards; *failed is whether that is an
// error.
static bool remake(struct gpu *gpu, struct swapchain *swapchain, const struct window *window,
                   bool *failed, struct err *err)
{
    struct offer offer;
    if (!goes_on(gpu, swapchain, "vkGetPhysicalDeviceSurfaceCapabilitiesKHR",
                 offer_read(gpu, swapchain, &offer), failed, err))
        return false;
    VkExtent2D extent = swapchain_choose_extent(&offer.capabilities, window->width, window->height);
    if (extent.width == 0 || extent.height == 0)
        return false;
    VkSurfaceFormatKHR format = swapchain_choose_format(offer.formats, offer.format_count);
    *failed = !offer_check(gpu, &offer, format.format, err);
    if (*failed)
        return false;
    swapchain->width = extent.width;
    swapchain->height = extent.height;
    swapchain->format = format.format;
    swapchain->present_mode =
        swapchain_choose_mode(offer.modes, offer.mode_count, swapchain->vsync);
    if (!goes_on(gpu, swapchain, "vkCreateSwapchainKHR",
                 handle_create(gpu, swapchain, &offer, format), failed, err))
        return false;
    *failed = !images_create(gpu, swapchain, err);
    return !*failed;
}

// Creates a swapchain for the current window. If the window has no area or the surface is lost,
// there is no swapchain afterwards, and this is not a failure.
static bool swapchain_make(struct gpu *gpu, struct swapchain *swapchain,
                           const struct window *window, struct err *err)
{
    bool failed = false;
    images_finish(gpu, swapchain);
    swapchain->is_stale = swapchain->is_suboptimal = false;
    swapchain->has_vsync = swapchain->vsync;
    swapchain->window_width = window->width;
    swapchain->window_height = window->height;
    swapchain->shown_before_made = swapchain->shown;
    if (remake(gpu, swapchain, window, &failed, err))
        swapchain->recreated++;
    else
        handle_finish(gpu, swapchain);
    return !failed;
}

bool swapchain_create(struct gpu *gpu, struct window *window, bool vsync, struct swapchain *out,
                      struct err *err)
{
    *out = (struct swapchain){.vsync = vsync};
    if (!window->handle)
        return true;
    calls_load(gpu, &out->calls);
    if (!gpu_commands_create(gpu, &out->commands, err) || !surface_create(gpu, out, window, err) ||
        !swapchain_make(gpu, out, window, err)) {
        swapchain_finish(gpu, out);
        return false;
    }
    out->recreated = 0;
    return true;
}

void swapchain_finish(struct gpu *gpu, struct swapchain *swapchain)
{
    if (!swapchain)
        return;
    if (swapchain->commands.pool) {
        gpu_commands_finish(gpu, &swapchain->commands);
        surface_finish(gpu, swapchain);
    }
    *swapchain = (struct swapchain){0};
}

static bool is_out_of_date(const struct swapchain *swapchain, const struct window *window)
{
    return !swapchain->handle || swapchain->is_stale || swapchain->vsync != swapchain->has_vsync ||
           swapchain->window_width != window->width || swapchain->window_height != window->height;
}

static bool bring_up_to_date(struct gpu *gpu, struct swapchain *swapchain, struct window *window,
                             struct err *err)
{
    if (!swapchain->surface || swapchain->is_surface_lost ||
        swapchain->surface_of != window->handle) {
        surface_finish(gpu, swapchain);
        if (!surface_create(gpu, swapchain, window, err))
            return false;
    }
    return !is_out_of_date(swapchain, window) || swapchain_make(gpu, swapchain, window, err);
}

// --- presentation --------------------------------------------------------------------------------

static const VkImageSubresourceLayers color_layer = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};

static void barrier(struct gpu_commands *commands, VkImage image, VkImageLayout from,
                    VkImageLayout to)
{
    const VkImageMemoryBarrier info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = from == VK_IMAGE_LAYOUT_UNDEFINED ? 0 : VK_ACCESS_TRANSFER_WRITE_BIT,
        .dstAccessMask = to == VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL   ? VK_ACCESS_TRANSFER_WRITE_BIT
                         : to == VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL ? VK_ACCESS_TRANSFER_READ_BIT
                                                                      : 0,
        .oldLayout = from,
        .newLayout = to,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1},
    };
    vkCmdPipelineBarrier(commands->handle, VK_PIPELINE_STAGE_TRANSFER_BIT,
                         VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL, 0, NULL, 1, &info);
}

// Copies the image to the swapchain's image; reorders the channels for its format, and scales.
static void blit(struct swapchain *swapchain, const struct gpu_screen *screen, VkImage to)
{
    bool same_size = screen->width == swapchain->width && screen->height == swapchain->height;
    const VkImageBlit region = {
        .srcSubresource = color_layer,
        .srcOffsets = {{0, 0, 0}, {(int32_t)screen->width, (int32_t)screen->height, 1}},
        .dstSubresource = color_layer,
        .dstOffsets = {{0, 0, 0}, {(int32_t)swapchain->width, (int32_t)swapchain->height, 1}},
    };
    vkCmdBlitImage(swapchain->commands.handle, screen->image.handle,
                   VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                   1, &region, same_size ? VK_FILTER_NEAREST : VK_FILTER_LINEAR);
}

static void copy(struct swapchain *swapchain, VkImage from, VkImage to)
{
    const VkImageCopy region = {
        .srcSubresource = color_layer,
        .dstSubresource = color_layer,
        .extent = {swapchain->width, swapchain->height, 1},
    };
    vkCmdCopyImage(swapchain->commands.handle, from, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
}

// Records the copy to the swapchain's image. The screen's values are sRGB-encoded already. A blit
// to a format that encodes would encode them again, but a copy keeps the bits.
static void picture_record(struct swapchain *swapchain, const struct gpu_screen *screen,
                           VkImage image)
{
    struct gpu_commands *commands = &swapchain->commands;
    const VkImageLayout undefined = VK_IMAGE_LAYOUT_UNDEFINED,
                        to = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                        from = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    barrier(commands, image, undefined, to);
    if (swapchain->converted.handle) {
        barrier(commands, swapchain->converted.handle, undefined, to);
        blit(swapchain, screen, swapchain->converted.handle);
        barrier(commands, swapchain->converted.handle, to, from);
        copy(swapchain, swapchain->converted.handle, image);
    } else if (swapchain->format == VK_FORMAT_R8G8B8A8_UNORM && screen->width == swapchain->width &&
               screen->height == swapchain->height) {
        copy(swapchain, screen->image.handle, image);
    } else {
        blit(swapchain, screen, image);
    }
    barrier(commands, image, to, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
}

static VkResult present_call(struct gpu *gpu, struct swapchain *swapchain, uint32_t index)
{
    const VkPresentInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
        .waitSemaphoreCount = 1,
        .pWaitSemaphores = &swapchain->copied[index],
        .swapchainCount = 1,
        .pSwapchains = &swapchain->handle,
        .pImageIndices = &index,
    };
    return swapchain->calls.present(gpu->queue, &info);
}

// Presents the image. *shown receives whether it was presented.
static bool picture_show(struct gpu *gpu, struct swapchain *swapchain,
                         const struct gpu_screen *screen, bool *shown, struct err *err)
{
    bool failed = false;
    uint32_t index;
    // gpu_begin() waits for the end of the last copy, which has waited for the semaphore, so that
    // the semaphore can be used again.
    if (!gpu_begin(gpu, &swapchain->commands, err))
        return false;
    VkResult result = swapchain->calls.acquire(gpu->device, swapchain->handle, ACQUIRE_NS,
                                               swapchain->acquired, VK_NULL_HANDLE, &index);
    if (!goes_on(gpu, swapchain, "vkAcquireNextImageKHR", result, &failed, err))
        return !failed;
    picture_record(swapchain, screen, swapchain->images[index]);
    swapchain->commands.awaited = swapchain->acquired;
    swapchain->commands.signalled = swapchain->copied[index];
    if (!gpu_submit(gpu, &swapchain->commands, err)) {
        // The image that was acquired would never be presented, and its semaphore never be waited
        // for.
        swapchain->is_stale = true;
        return false;
    }
    result = present_call(gpu, swapchain, index);
    *shown = goes_on(gpu, swapchain, "vkQueuePresentKHR", result, &failed, err);
    return !failed;
}

bool swapchain_show(struct gpu *gpu, struct swapchain *swapchain, struct window *window,
                    const struct gpu_screen *screen, struct err *err)
{
    if (!window->handle || window->is_minimised || !screen->is_drawn)
        return true;
    if (gpu->lost)
        return gpu_fail(gpu, "presenting an image", VK_ERROR_DEVICE_LOST, err);
    // If the swapchain is out of date, it is recreated and used at once, so that a window that is
    // being resized shows an image in every frame.
    bool shown = false;
    for (int attempt = 0; attempt < 2 && !shown; attempt++) {
        if (!bring_up_to_date(gpu, swapchain, window, err) ||
            (swapchain->handle && !picture_show(gpu, swapchain, screen, &shown, err)))
            return false;
        if (!swapchain->is_stale && !swapchain->is_surface_lost)
            break;
    }
    if (shown) {
        swapchain->shown++;
        swapchain->lost_in_a_row = 0;
    }
    return true;
}
