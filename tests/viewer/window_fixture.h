// Helpers for the tests with a real window: a device that shows pictures in it, a screen, and an
// X11 connection of the test's own, by which it inspects the window and acts as the window manager.
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

// Opens all of it, or leaves the test: as skipped without a display, Vulkan or validation layers,
// as failed for any other reason.
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
// Also checks that nothing is left and that the validation layers were silent.
void stage_close(struct stage *stage);
// The screen and its picture in the window's size, or another one.
bool stage_size(struct stage *stage, uint32_t width, uint32_t height, struct err *err);
// Fills the picture with what `seed` makes of the pixels' numbers, and draws it on the screen.
bool stage_draw(struct stage *stage, uint32_t seed, struct err *err);
static inline bool stage_show(struct stage *stage, struct err *err)
{
    return swapchain_show(&stage->gpu, &stage->swapchain, &stage->window, &stage->screen, err);
}
// Returns whether the window, as it is seen, comes to show `seed`'s picture bit for bit within ten
// seconds.
bool stage_shows(struct stage *stage, uint32_t seed);
// Polls until an event of this kind comes, for up to ten seconds; NULL: none came.
const struct event *stage_wait(struct stage *stage, enum event_kind kind);

Window stage_x11_window(const struct stage *stage);
double resident_megabytes(void);
void sleep_ms(long ms);

#endif
