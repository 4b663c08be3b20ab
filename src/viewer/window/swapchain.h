// Shows the screen's image in the window. The vk* calls of this folder are the only ones outside of
// src/gpu.
#ifndef LAMPYRIS_VIEWER_WINDOW_SWAPCHAIN_H
#define LAMPYRIS_VIEWER_WINDOW_SWAPCHAIN_H

#include "gpu/screen.h"
#include "viewer/window/window.h"

#define SWAPCHAIN_IMAGES_MAX 16

// The functions of VK_KHR_surface and VK_KHR_swapchain; see gpu_function().
struct swapchain_calls {
    PFN_vkDestroySurfaceKHR destroy_surface;
    PFN_vkGetPhysicalDeviceSurfaceSupportKHR support;
    PFN_vkGetPhysicalDeviceSurfaceCapabilitiesKHR capabilities;
    PFN_vkGetPhysicalDeviceSurfaceFormatsKHR formats;
    PFN_vkGetPhysicalDeviceSurfacePresentModesKHR present_modes;
    PFN_vkCreateSwapchainKHR create;
    PFN_vkDestroySwapchainKHR destroy;
    PFN_vkGetSwapchainImagesKHR images;
    PFN_vkAcquireNextImageKHR acquire;
    PFN_vkQueuePresentKHR present;
};

struct swapchain {
    VkSurfaceKHR surface;
    struct GLFWwindow *surface_of;
    VkSwapchainKHR handle; // VK_NULL_HANDLE while the window has no area
    uint32_t width, height;
    VkFormat format;
    VkPresentModeKHR present_mode;
    VkImage images[SWAPCHAIN_IMAGES_MAX];
    // One per image; signalled when the image is ready for presentation.
    VkSemaphore copied[SWAPCHAIN_IMAGES_MAX];
    VkSemaphore acquired; // signalled when the image that was acquired last may be written
    uint32_t image_count;
    // An image of the swapchain's size, for formats that encode values to sRGB. The values are
    // encoded already, so they must be copied without a change of bits, which is possible only from
    // an image of the same size.
    struct gpu_image converted;
    bool vsync; // may be changed at any time; takes effect at the next swapchain_show
    bool has_vsync;
    uint32_t window_width, window_height; // size of the window when the swapchain was created
    bool is_stale, is_surface_lost;       // the swapchain or the surface must be recreated
    bool is_suboptimal;                   // the swapchain is suboptimal even after recreation
    uint32_t lost_in_a_row; // number of surfaces lost since the last image that was shown
    struct gpu_commands commands;
    uint64_t shown, recreated;  // number of images shown, and number of recreations
    uint64_t shown_before_made; // value of `shown` when the swapchain was created
    struct swapchain_calls calls;
};

// Creates a swapchain. A headless window has none: *out is {0}, and swapchain_show does nothing.
bool swapchain_create(struct gpu *gpu, struct window *window, bool vsync, struct swapchain *out,
                      struct err *err);
void swapchain_finish(struct gpu *gpu, struct swapchain *swapchain); // accepts NULL and {0}
// Presents the screen's image (see gpu_screen_draw), scaled if the sizes differ. Recreates the
// swapchain if the window or vsync has changed, or if the swapchain is out of date or its surface
// lost; then an image may be skipped. Does nothing while the window is minimised.
bool swapchain_show(struct gpu *gpu, struct swapchain *swapchain, struct window *window,
                    const struct gpu_screen *screen, struct err *err);

#endif
