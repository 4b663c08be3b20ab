// Shows the screen's image in the window. The only vk* calls outside of src/gpu.
#ifndef LAMPYRIS_VIEWER_WINDOW_SWAPCHAIN_H
#define LAMPYRIS_VIEWER_WINDOW_SWAPCHAIN_H

#include "gpu/screen.h"
#include "viewer/window/window.h"

#define SWAPCHAIN_IMAGES_MAX 16

// Functions of the extensions VK_KHR_surface and VK_KHR_swapchain: see gpu_function.
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
    VkSemaphore copied[SWAPCHAIN_IMAGES_MAX]; // an image of these is ready to be shown
    VkSemaphore acquired;                     // the image that was asked for last may be written
    uint32_t image_count;
    // Of the swapchain's size, where its format would encode once more what is encoded already:
    // copies keep the bits, and only from here on.
    struct gpu_image converted;
    bool vsync; // may be changed at any time; swapchain_show takes notice
    bool has_vsync;
    uint32_t window_width, window_height; // the window's when the swapchain was made
    bool is_stale, is_surface_lost;       // to be made anew
    bool is_suboptimal;                   // and making it anew does not help
    uint32_t lost_in_a_row;               // surfaces, since the last picture
    struct gpu_commands commands;
    uint64_t shown, recreated;  // pictures; times that it was made anew
    uint64_t shown_before_made; // `shown` when it was made
    struct swapchain_calls calls;
};

// Headless windows have none: *out is {0} then, and swapchain_show does nothing.
bool swapchain_create(struct gpu *gpu, struct window *window, bool vsync, struct swapchain *out,
                      struct err *err);
void swapchain_finish(struct gpu *gpu, struct swapchain *swapchain); // accepts NULL and {0}
// Copies what gpu_screen_draw made, scaled where the sizes differ, and shows it. Makes the
// swapchain anew where the window or vsync changed, where it is out of date or where the surface
// was lost; a picture may be left out then. Does nothing while minimised.
bool swapchain_show(struct gpu *gpu, struct swapchain *swapchain, struct window *window,
                    const struct gpu_screen *screen, struct err *err);

#endif
