// Shows the screen's image in the window. The only vk* calls outside of src/gpu.
#ifndef LAMPYRIS_APP_VIEWER_SWAPCHAIN_H
#define LAMPYRIS_APP_VIEWER_SWAPCHAIN_H

#include "screen.h"
#include "window.h"

#define SWAPCHAIN_IMAGES_MAX 16

struct swapchain {
    VkSurfaceKHR surface;
    VkSwapchainKHR handle; // VK_NULL_HANDLE while the window has no area
    uint32_t width, height;
    VkImage images[SWAPCHAIN_IMAGES_MAX];
    uint32_t image_count;
    bool vsync; // may be changed at any time; swapchain_show takes notice
    bool has_vsync;
    struct gpu_commands commands;
    uint64_t shown, recreated; // pictures; times that it was made anew
};

// Headless windows have none: *out is {0} then, and swapchain_show does nothing.
bool swapchain_create(struct gpu *gpu, struct window *window, bool vsync, struct swapchain *out,
                      struct err *err);
void swapchain_finish(struct gpu *gpu, struct swapchain *swapchain); // accepts NULL and {0}
// Copies what gpu_screen_draw made (of any size: the overlap, or scaled where it differs) and shows
// it. Makes the swapchain anew where the window or vsync changed, where it is out of date or where
// the surface was lost; a picture may be left out then. Does nothing while minimised.
bool swapchain_show(struct gpu *gpu, struct swapchain *swapchain, struct window *window,
                    const struct gpu_screen *screen, struct err *err);

#endif
