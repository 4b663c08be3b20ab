// Chooses the parameters of a swapchain from what the surface offers. Makes no Vulkan calls.
#ifndef LAMPYRIS_VIEWER_WINDOW_SWAPCHAIN_CHOOSE_H
#define LAMPYRIS_VIEWER_WINDOW_SWAPCHAIN_CHOOSE_H

#include <stdbool.h>
#include <stdint.h>
#include <volk.h>

// Returns a format that displays sRGB-encoded values. Formats that store values unchanged are
// preferred to formats that encode them (see swapchain_twin). Returns VK_FORMAT_UNDEFINED if none
// is offered.
VkSurfaceFormatKHR swapchain_choose_format(const VkSurfaceFormatKHR *offered, uint32_t count);
// Returns the format with the same bits that does not encode values, for a format that does;
// VK_FORMAT_UNDEFINED for all others.
VkFormat swapchain_twin(VkFormat format);
// Returns a presentation mode. With vsync, images are presented in order; without it, a mode that
// does not wait for the display is chosen if it is offered.
VkPresentModeKHR swapchain_choose_mode(const VkPresentModeKHR *offered, uint32_t count, bool vsync);
// Returns the surface's own size if it has one; otherwise the window's size within the surface's
// limits.
VkExtent2D swapchain_choose_extent(const VkSurfaceCapabilitiesKHR *surface, uint32_t window_width,
                                   uint32_t window_height);
uint32_t swapchain_choose_count(const VkSurfaceCapabilitiesKHR *surface, VkPresentModeKHR mode);

#endif
