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
    VkSemaphore copied[SWAPCHAIN_IMAGES_MAX]; // signalled when the image is ready to be presented
    VkSemaphore acquired;                     // signalled when the last acquired image may be
                                              // written
    uint32_t image_count;
    // An image of the swapchain's size in case its format encodes values to sRGB, which they are
    // already: copies keep the bits, and are only possible from this image.
    struct gpu_image converted;
    bool vsync; // may be changed at any time; swapchain_show applies it
    bool has_vsync;
    uint32_t window_width, window_height; // size of the window when the swapchain was made
    bool is_stale, is_surface_lost;       // must be recreated
    bool is_suboptimal;                   // and recreating it does not help
    uint32_t lost_in_a_row;               // number of surfaces lost since the last image
    struct gpu_commands commands;
    uint64_t shown, recreated;  // numbers of images shown, and of recreations
    uint64_t shown_before_made; // `shown` at the last creation
    struct swapchain_calls calls;
};

// Headless windows have no swapchain: *out is {0}, and swapchain_show does nothing.
bool swapchain_create(struct gpu *gpu, struct window *window, bool vsync, struct swapchain *out,
                      struct err *err);
void swapchain_finish(struct gpu *gpu, struct swapchain *swapchain); // accepts NULL and {0}
// Copies the screen's image of gpu_screen_draw, scaled if the sizes differ, and presents it.
// Recreates the swapchain if the window or vsync changed, if it is out of date or if the surface
// was lost; an image may be skipped then. Does nothing while minimised.
bool swapchain_show(struct gpu *gpu, struct swapchain *swapchain, struct window *window,
                    const struct gpu_screen *screen, struct err *err);

#endif
