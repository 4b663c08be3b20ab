// The window and what comes from it; or, headless, the same without one: then all events are those
// that window_push brings.
//
// One thread, the program's first, and one window at a time.
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
    EVENT_DROP,   // path; one event a file
    EVENT_RESIZE, // to window->width, height (several at once become one); of the same size where
                  // what the window shows was damaged
    EVENT_FOCUS,  // down: has it now; without it no key is held any more
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

// Events in the order in which they happened. Movements of the mouse that follow on one another are
// one event.
struct window_events {
    struct event list[WINDOW_EVENTS_MAX];
    uint32_t count;
    struct arena texts;
};

struct window {
    struct GLFWwindow *handle; // NULL: headless
    uint32_t width, height;    // of the framebuffer, pixels; never 0
    float scale;               // pixels for a point of text: 2 on many displays with small pixels
    double pixels_per_unit[2]; // of the framebuffer, for a unit of GLFW's screen coordinates
    bool is_minimised;         // nothing is to be drawn
    bool should_close;
    bool is_captured;     // the mouse looks around: hidden, its positions without bounds
    struct event *events; // of the last window_poll
    uint32_t event_count;
    // One holds `events`, the other one gathers what comes before the next window_poll.
    struct window_events queues[2];
    uint32_t gathering;
};

struct window_params {
    const char *title;
    uint32_t width, height; // of the framebuffer
    bool headless;
};

// ERR_USAGE where there is no display, saying so and pointing to `lampyris render` and --headless.
// *out must not move.
bool window_open(const struct window_params *params, struct window *out, struct err *err);
void window_close(struct window *window); // accepts NULL and {0}; after swapchain_finish

// The instance extensions that surfaces need, and whether a queue family can show pictures, as
// gpu_params wants them. Without an open window: none, and false.
const char *const *window_extensions(uint32_t *count);
bool window_can_present(void *window, VkInstance instance, VkPhysicalDevice device,
                        uint32_t queue_family);
// Creates the surface that swapchains show pictures on; the caller's to destroy.
bool window_create_surface(struct window *window, VkInstance instance, VkSurfaceKHR *out,
                           struct err *err);

// Replaces `events` by what happened since the last time, in order; where nothing did, waits at
// most so long for it. Updates the other fields.
void window_poll(struct window *window, double wait_seconds);
// An event as if the user had made it: from scripts. The next window_poll brings it. Of a path a
// copy is kept.
void window_push(struct window *window, const struct event *event);
// Asks for another size; headless it has it at once. The next window_poll brings the event.
void window_resize(struct window *window, uint32_t width, uint32_t height);
void window_minimise(struct window *window, bool minimised);
void window_capture(struct window *window, bool captured);
void window_set_title(struct window *window, const char *title);
void window_set_clipboard(struct window *window, const char *text); // headless: nothing

#endif
