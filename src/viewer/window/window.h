// The window and its events; or a headless replacement, whose events all come from window_push.
// Only the program's first thread may call these functions, and only one window may exist at a
// time.
#ifndef LAMPYRIS_VIEWER_WINDOW_WINDOW_H
#define LAMPYRIS_VIEWER_WINDOW_WINDOW_H

#include "base/arena.h"
#include "base/err.h"
#include <stdbool.h>
#include <stdint.h>
#include <volk.h>

struct GLFWwindow;

enum event_kind {
    EVENT_KEY,    // code: GLFW_KEY_*; down; repeated
    EVENT_BUTTON, // code: 0 left, 1 right, 2 middle; down
    EVENT_MOVE,   // x, y: pixels of the framebuffer from the upper left
    EVENT_SCROLL, // x, y: notches
    EVENT_TEXT,   // code: a Unicode character
    EVENT_DROP,   // path; one event per file
    EVENT_RESIZE, // to window->width, height (several are merged into one); with the same size if
                  // the contents of the window were damaged
    EVENT_FOCUS,  // down: it has the focus now; without it no key is held
    EVENT_CLOSE,
};

#define EVENT_SHIFT 1u
#define EVENT_CONTROL 2u
#define EVENT_ALT 4u

struct event {
    enum event_kind kind;
    int code;
    bool down, repeated;
    uint32_t modifiers; // EVENT_SHIFT …
    double x, y;
    const char *path; // lives until the next window_poll
};

#define WINDOW_EVENTS_MAX 512

// Events in order. Consecutive mouse movements are merged into one event.
struct window_events {
    struct event list[WINDOW_EVENTS_MAX];
    uint32_t count;
    struct arena texts;
};

struct window {
    struct GLFWwindow *handle; // NULL: headless
    uint32_t width, height;    // size of the framebuffer, pixels; never 0
    float scale;               // pixels per point of text: 2 on many high-resolution displays
    double pixels_per_unit[2]; // framebuffer pixels per unit of GLFW's screen coordinates
    bool is_minimised;         // nothing is drawn
    bool should_close;
    bool is_captured;     // the mouse rotates the view: it is hidden and not confined
    struct event *events; // events that the last window_poll() found
    uint32_t event_count;
    // One holds `events`, the other collects events until the next window_poll.
    struct window_events queues[2];
    uint32_t gathering;
};

struct window_params {
    const char *title;
    uint32_t width, height; // size of the framebuffer, pixels
    bool headless;
};

// Opens the window. ERR_USAGE if there is no display, with a pointer to `lampyris render` and
// --headless. *out must not move.
bool window_open(const struct window_params *params, struct window *out, struct err *err);
void window_close(struct window *window); // accepts NULL and {0}; after swapchain_finish

// Return the instance extensions that surfaces need, and whether a queue family can present, as
// gpu_params requires. Without an open window: none, and false.
const char *const *window_extensions(uint32_t *count);
bool window_can_present(void *window, VkInstance instance, VkPhysicalDevice device,
                        uint32_t queue_family);
// Creates the surface for swapchains; the caller destroys it.
bool window_create_surface(struct window *window, VkInstance instance, VkSurfaceKHR *out,
                           struct err *err);

// Replaces `events` by those since the last call, in order; if there are none, waits for one up to
// this time. Updates the other fields.
void window_poll(struct window *window, double wait_seconds);
// Adds an event as if the user had caused it: for scripts. The next window_poll returns it. A path
// is copied.
void window_push(struct window *window, const struct event *event);
// Requests another size; headless windows take it at once. The next window_poll returns the event.
void window_resize(struct window *window, uint32_t width, uint32_t height);
void window_minimise(struct window *window, bool minimised);
void window_capture(struct window *window, bool captured);
void window_set_title(struct window *window, const char *title);
void window_set_clipboard(struct window *window, const char *text); // headless: nothing

#endif
