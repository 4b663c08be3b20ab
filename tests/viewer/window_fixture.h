// Helpers for tests with a real window: a device that shows images in it, a screen, and a separate
// X11 connection, with which the test inspects the window and acts as the window manager.
#ifndef LAMPYRIS_TESTS_WINDOW_FIXTURE_H
#define LAMPYRIS_TESTS_WINDOW_FIXTURE_H

#include "test.h"
#include "viewer/window/swapchain.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <time.h>

#define START_WIDTH 320u
#define START_HEIGHT 200u

struct stage {
    struct window window;
    struct gpu gpu;
    struct gpu_screen screen;
    struct gpu_buffer pixels;
    struct swapchain swapchain;
    Display *display;
};

// Opens everything. If that fails, the test ends: as skipped without a display, Vulkan or
// validation layers, otherwise as failed.
#define STAGE_OPEN(stage, ...)                                                                     \
    do {                                                                                           \
        struct err open_err = {0};                                                                 \
        const struct gpu_params open_params = {__VA_ARGS__};                                       \
        if (!stage_open((stage), &open_params, &open_err)) {                                       \
            stage_close(stage);                                                                    \
            if (open_err.code == ERR_NO_VULKAN || strstr(open_err.msg, "is not installed") ||      \
                strstr(open_err.msg, "no display") || strstr(open_err.msg, "no queue") ||          \
                strstr(open_err.msg, "which windows need"))                                        \
                SKIP("%s", open_err.msg);                                                          \
            REQUIRE(false, "%s", open_err.msg);                                                    \
        }                                                                                          \
    } while (0)

bool stage_open(struct stage *stage, const struct gpu_params *params, struct err *err);
// Closes everything. Checks that no object is left and that the validation layers were silent.
void stage_close(struct stage *stage);
// Creates the screen and its picture, with the size of the window or another one.
bool stage_size(struct stage *stage, uint32_t width, uint32_t height, struct err *err);
// Fills the picture with values made from `seed` and the indices of the pixels, and draws it on the
// screen.
bool stage_draw(struct stage *stage, uint32_t seed, struct err *err);
static inline bool stage_show(struct stage *stage, struct err *err)
{
    return swapchain_show(&stage->gpu, &stage->swapchain, &stage->window, &stage->screen, err);
}
// Returns whether the visible window shows the picture of `seed`, bit for bit, within ten seconds.
bool stage_shows(struct stage *stage, uint32_t seed);
// Polls for at most ten seconds until an event of this kind arrives. Returns NULL if none does.
const struct event *stage_wait(struct stage *stage, enum event_kind kind);

Window stage_x11_window(const struct stage *stage);
double resident_megabytes(void);
void sleep_ms(long ms);

#endif
