#include "viewer/window/swapchain_choose.h"

static const struct {
    VkFormat format, twin; // twin: as swapchain_twin() returns it
} formats[] = {
    {VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_UNDEFINED},
    {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_UNDEFINED},
    {VK_FORMAT_A8B8G8R8_UNORM_PACK32, VK_FORMAT_UNDEFINED},
    {VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_R8G8B8A8_UNORM},
    {VK_FORMAT_B8G8R8A8_SRGB, VK_FORMAT_B8G8R8A8_UNORM},
    {VK_FORMAT_A8B8G8R8_SRGB_PACK32, VK_FORMAT_A8B8G8R8_UNORM_PACK32},
};
#define FORMAT_COUNT (sizeof formats / sizeof formats[0])

VkSurfaceFormatKHR swapchain_choose_format(const VkSurfaceFormatKHR *offered, uint32_t count)
{
    for (size_t wanted = 0; wanted < FORMAT_COUNT; wanted++)
        for (uint32_t i = 0; i < count; i++)
            if (offered[i].format == formats[wanted].format &&
                offered[i].colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR)
                return offered[i];
    return (VkSurfaceFormatKHR){VK_FORMAT_UNDEFINED, VK_COLOR_SPACE_SRGB_NONLINEAR_KHR};
}

VkFormat swapchain_twin(VkFormat format)
{
    for (size_t i = 0; i < FORMAT_COUNT; i++)
        if (formats[i].format == format)
            return formats[i].twin;
    return VK_FORMAT_UNDEFINED;
}

VkPresentModeKHR swapchain_choose_mode(const VkPresentModeKHR *offered, uint32_t count, bool vsync)
{
    static const VkPresentModeKHR wanted[] = {
        VK_PRESENT_MODE_MAILBOX_KHR,
        VK_PRESENT_MODE_IMMEDIATE_KHR,
        VK_PRESENT_MODE_FIFO_RELAXED_KHR,
    };
    for (uint32_t w = 0; !vsync && w < 3; w++)
        for (uint32_t i = 0; i < count; i++)
            if (offered[i] == wanted[w])
                return offered[i];
    return VK_PRESENT_MODE_FIFO_KHR; // every surface supports this mode
}

static uint32_t within(uint32_t value, uint32_t least, uint32_t most)
{
    return value < least ? least : value > most ? most : value;
}

VkExtent2D swapchain_choose_extent(const VkSurfaceCapabilitiesKHR *surface, uint32_t window_width,
                                   uint32_t window_height)
{
    // UINT32_MAX marks surfaces that can have any size (Vulkan specification,
    // VkSurfaceCapabilitiesKHR).
    if (surface->currentExtent.width != UINT32_MAX)
        return surface->currentExtent;
    return (VkExtent2D){
        within(window_width, surface->minImageExtent.width, surface->maxImageExtent.width),
        within(window_height, surface->minImageExtent.height, surface->maxImageExtent.height),
    };
}

// Returns one image more than the surface holds back, so that an image is available while another
// one is displayed. Mailbox mode needs another one, for the image that waits.
uint32_t swapchain_choose_count(const VkSurfaceCapabilitiesKHR *surface, VkPresentModeKHR mode)
{
    uint32_t count = surface->minImageCount + 1;
    if (mode == VK_PRESENT_MODE_MAILBOX_KHR && count < 3)
        count = 3;
    uint32_t most = surface->maxImageCount; // 0 means that there is no limit
    return most && count > most ? most : count;
}
