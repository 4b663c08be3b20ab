// Chooses the parameters of a swapchain from what its surface offers. No Vulkan calls.
#ifndef LAMPYRIS_VIEWER_WINDOW_SWAPCHAIN_CHOOSE_H
#define LAMPYRIS_VIEWER_WINDOW_SWAPCHAIN_CHOOSE_H

#include <stdbool.h>
#include <stdint.h>
#include <volk.h>

// Returns a format that displays sRGB-encoded values. Formats that store values unchanged are
// preferred to those that encode them, which swapchain_twin identifies. VK_FORMAT_UNDEFINED: none
// is offered.
VkSurfaceFormatKHR swapchain_choose_format(const VkSurfaceFormatKHR *offered, uint32_t count);
// For a format that encodes, returns the format with the same bits that does not; for others
// VK_FORMAT_UNDEFINED.
VkFormat swapchain_twin(VkFormat format);
// With vsync, returns a mode that presents images in order; else one that does not wait for the
// display, if there is one.
VkPresentModeKHR swapchain_choose_mode(const VkPresentModeKHR *offered, uint32_t count, bool vsync);
// Returns the surface's own size if it has one, else the window's size within the surface's limits.
VkExtent2D swapchain_choose_extent(const VkSurfaceCapabilitiesKHR *surface, uint32_t window_width,
                                   uint32_t window_height);
uint32_t swapchain_choose_count(const VkSurfaceCapabilitiesKHR *surface, VkPresentModeKHR mode);

#endif
