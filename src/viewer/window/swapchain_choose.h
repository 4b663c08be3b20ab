// Chooses what a swapchain is made with, from what its surface offers. No Vulkan calls.
#ifndef LAMPYRIS_VIEWER_WINDOW_SWAPCHAIN_CHOOSE_H
#define LAMPYRIS_VIEWER_WINDOW_SWAPCHAIN_CHOOSE_H

#include <stdbool.h>
#include <stdint.h>
#include <volk.h>

// A format that shows sRGB-encoded values; of those that store what is written before those that
// encode it, which swapchain_twin tells apart. VK_FORMAT_UNDEFINED: none is offered.
VkSurfaceFormatKHR swapchain_choose_format(const VkSurfaceFormatKHR *offered, uint32_t count);
// Of a format that encodes: the one of the same bits that does not. VK_FORMAT_UNDEFINED: it does
// not.
VkFormat swapchain_twin(VkFormat format);
// With vsync a mode that shows pictures one after the other, else one that does not wait for the
// display, where there is one.
VkPresentModeKHR swapchain_choose_mode(const VkPresentModeKHR *offered, uint32_t count, bool vsync);
// The surface's own size where it has one, else the window's as far as it may be had.
VkExtent2D swapchain_choose_extent(const VkSurfaceCapabilitiesKHR *surface, uint32_t window_width,
                                   uint32_t window_height);
uint32_t swapchain_choose_count(const VkSurfaceCapabilitiesKHR *surface, VkPresentModeKHR mode);

#endif
