// The window and its events, or a headless replacement, all of whose events come from window_push.
// Only the main thread may call these functions, and only one window may exist at a time.
#ifndef LAMPYRIS_VIEWER_WINDOW_WINDOW_H
#define LAMPYRIS_VIEWER_WINDOW_WINDOW_H

#include "base/arena.h"
#include "base/err.h"
#include <stdbool.h>
#include <stdint.h>
#include <volk.h>

struct GLFWwindow;

enum event_kind {
    EVENT_KEY,    // code: GLFW_KEY_*; down, repeated
    EVENT_BUTTON, // code: 0 left, 1 right, 2 middle; down
    EVENT_MOVE,   // x, y: position in the framebuffer, in pixels from the upper left
    EVENT_SCROLL, // x, y: notches of the wheel
    EVENT_TEXT,   // code: a Unicode character
    EVENT_DROP,   // path of a file; there is one event per file
    // The framebuffer now has window->width x height pixels (several changes are merged). If the
    // size is the same, the contents of the window were damaged.
    EVENT_RESIZE,
    EVENT_FOCUS, // down: the window now has the focus; without the focus no key counts as held
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
    const char *path; // valid until the next window_poll
};

#define WINDOW_EVENTS_MAX 512

// Events in order. Consecutive movements of the mouse are merged into one.
struct window_events {
    struct event list[WINDOW_EVENTS_MAX];
    uint32_t count;
    struct arena texts;
};

struct window {
    struct GLFWwindow *handle; // NULL if the window is headless
    uint32_t width, height;    // size of the framebuffer in pixels; at least 1
    float scale;               // pixels per point of text: 2 on many high-resolution displays
    double pixels_per_unit[2]; // framebuffer pixels per unit of GLFW's screen coordinates
    bool is_minimised;         // nothing is drawn while it is true
    bool should_close;
    bool is_captured; // the mouse rotates the view, so it is hidden and not confined to the window
    struct event *events; // the events of the last window_poll()
    uint32_t event_count;
    // One queue owns `events`; the other one collects the events until the next window_poll.
    struct window_events queues[2];
    uint32_t gathering;
};

struct window_params {
    const char *title;
    uint32_t width, height; // size of the framebuffer, pixels
    bool headless;
};

// Opens a window. Fails with ERR_USAGE if there is no display; the message names `lampyris render`
// and --headless. *out must not move.
bool window_open(const struct window_params *params, struct window *out, struct err *err);
void window_close(struct window *window); // accepts NULL and {0}; call it after swapchain_finish

// These functions return the instance extensions that surfaces need, and whether a queue family can
// present, for gpu_params. Without an open window they return no extensions, and false.
const char *const *window_extensions(uint32_t *count);
bool window_can_present(void *window, VkInstance instance, VkPhysicalDevice device,
                        uint32_t queue_family);
// Creates the surface for a swapchain. The caller destroys it.
bool window_create_surface(struct window *window, VkInstance instance, VkSurfaceKHR *out,
                           struct err *err);

// Replaces `events` by those that have arrived since the last call, in order. If there are none,
// waits at most this time for one. Updates the other members.
void window_poll(struct window *window, double wait_seconds);
// Adds an event as if the user had caused it, for scripts. The next window_poll returns it. A path
// is copied.
void window_push(struct window *window, const struct event *event);
// Requests another size, which a headless window gets at once. The next window_poll returns the
// event.
void window_resize(struct window *window, uint32_t width, uint32_t height);
void window_minimise(struct window *window, bool minimised);
void window_capture(struct window *window, bool captured);
void window_set_title(struct window *window, const char *title);
// Does nothing if the window is headless.
void window_set_clipboard(struct window *window, const char *text);

#endif
