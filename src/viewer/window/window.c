// The window: one of GLFW, or a headless replacement.
#include "viewer/window/window.h"

#include "base/clock.h"
#include "base/log.h"
#include <string.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

// --- events -------------------------------------------------------------------------------------

// Moves and changes of size report a state, so the last one of consecutive events replaces the
// others.
static bool replaces_last(const struct window_events *queue, const struct event *event)
{
    return queue->count > 0 && event->kind == queue->list[queue->count - 1].kind &&
           (event->kind == EVENT_MOVE || event->kind == EVENT_RESIZE);
}

// Adds an event. If the queue is full, its last event becomes a loss of focus: the events that are
// dropped may be releases, and no key may remain held forever.
static void event_add(struct window *window, const struct event *event)
{
    struct window_events *queue = &window->queues[window->gathering];
    struct event copy = *event;
    if (event->path) {
        copy.path = arena_strdup(&queue->texts, event->path);
        if (!copy.path) {
            log_warn("window: out of memory for the path of a file that was dropped");
            return;
        }
    }
    if (event->kind == EVENT_CLOSE)
        window->should_close = true;
    if (replaces_last(queue, event))
        queue->list[queue->count - 1] = copy;
    else if (queue->count + 1 < WINDOW_EVENTS_MAX)
        queue->list[queue->count++] = copy;
    else if (queue->count < WINDOW_EVENTS_MAX)
        queue->list[queue->count++] = (struct event){.kind = EVENT_FOCUS};
}

void window_push(struct window *window, const struct event *event)
{
    event_add(window, event);
}

// Returns the modifiers that are held. On X11, GLFW's own flags do not include a modifier key in
// the event of its press.
static uint32_t held_modifiers(GLFWwindow *handle)
{
    static const struct {
        int left, right;
        uint32_t modifier;
    } keys[] = {
        {GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT, EVENT_SHIFT},
        {GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL, EVENT_CONTROL},
        {GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT, EVENT_ALT},
    };
    uint32_t held = 0;
    for (int i = 0; i < 3; i++)
        if (glfwGetKey(handle, keys[i].left) == GLFW_PRESS ||
            glfwGetKey(handle, keys[i].right) == GLFW_PRESS)
            held |= keys[i].modifier;
    return held;
}

// Adds an event that GLFW has reported.
static void tell(GLFWwindow *handle, struct event event)
{
    event.modifiers = held_modifiers(handle);
    event_add(glfwGetWindowUserPointer(handle), &event);
}

static void on_key(GLFWwindow *handle, int key, int scancode, int action, int mods)
{
    (void)scancode, (void)mods;
    if (key != GLFW_KEY_UNKNOWN)
        tell(handle, (struct event){
                         .kind = EVENT_KEY,
                         .code = key,
                         .down = action != GLFW_RELEASE,
                         .repeated = action == GLFW_REPEAT,
                     });
}

static void on_text(GLFWwindow *handle, unsigned int character)
{
    tell(handle, (struct event){.kind = EVENT_TEXT, .code = (int)character});
}

static void on_button(GLFWwindow *handle, int button, int action, int mods)
{
    (void)mods;
    if (button <= GLFW_MOUSE_BUTTON_MIDDLE)
        tell(handle,
             (struct event){.kind = EVENT_BUTTON, .code = button, .down = action == GLFW_PRESS});
}

static void on_move(GLFWwindow *handle, double x, double y)
{
    const struct window *window = glfwGetWindowUserPointer(handle);
    tell(handle, (struct event){
                     .kind = EVENT_MOVE,
                     .x = x * window->pixels_per_unit[0],
                     .y = y * window->pixels_per_unit[1],
                 });
}

static void on_scroll(GLFWwindow *handle, double x, double y)
{
    tell(handle, (struct event){.kind = EVENT_SCROLL, .x = x, .y = y});
}

static void on_drop(GLFWwindow *handle, int count, const char **paths)
{
    for (int i = 0; i < count; i++)
        tell(handle, (struct event){.kind = EVENT_DROP, .path = paths[i]});
}

// Adopts a new size. Some systems report no area for a window that is minimised; its size is then
// kept.
static bool size_set(struct window *window, int width, int height)
{
    if (width <= 0 || height <= 0)
        return false;
    int units_wide, units_high;
    glfwGetWindowSize(window->handle, &units_wide, &units_high);
    window->width = (uint32_t)width;
    window->height = (uint32_t)height;
    window->pixels_per_unit[0] = units_wide > 0 ? (double)width / units_wide : 1;
    window->pixels_per_unit[1] = units_high > 0 ? (double)height / units_high : 1;
    return true;
}

static void on_resize(GLFWwindow *handle, int width, int height)
{
    if (size_set(glfwGetWindowUserPointer(handle), width, height))
        tell(handle, (struct event){.kind = EVENT_RESIZE});
}

static void on_damage(GLFWwindow *handle)
{
    tell(handle, (struct event){.kind = EVENT_RESIZE});
}

static void on_minimise(GLFWwindow *handle, int minimised)
{
    struct window *window = glfwGetWindowUserPointer(handle);
    window->is_minimised = minimised;
}

static void on_focus(GLFWwindow *handle, int focused)
{
    tell(handle, (struct event){.kind = EVENT_FOCUS, .down = focused});
}

static void on_close(GLFWwindow *handle)
{
    tell(handle, (struct event){.kind = EVENT_CLOSE});
}

static void on_scale(GLFWwindow *handle, float x, float y)
{
    struct window *window = glfwGetWindowUserPointer(handle);
    (void)y;
    window->scale = x > 0 ? x : 1;
}

static void on_error(int code, const char *text)
{
    (void)code;
    log_warn("window: %s", text);
}

// --- opening and closing -------------------------------------------------------------------------

static const char *glfw_error(void)
{
    const char *text = NULL;
    glfwGetError(&text);
    return text ? text : "GLFW gives no reason";
}

static void callbacks_set(struct window *window)
{
    GLFWwindow *handle = window->handle;
    glfwSetWindowUserPointer(handle, window);
    glfwSetErrorCallback(on_error);
    glfwSetKeyCallback(handle, on_key);
    glfwSetCharCallback(handle, on_text);
    glfwSetMouseButtonCallback(handle, on_button);
    glfwSetCursorPosCallback(handle, on_move);
    glfwSetScrollCallback(handle, on_scroll);
    glfwSetDropCallback(handle, on_drop);
    glfwSetFramebufferSizeCallback(handle, on_resize);
    glfwSetWindowRefreshCallback(handle, on_damage);
    glfwSetWindowIconifyCallback(handle, on_minimise);
    glfwSetWindowFocusCallback(handle, on_focus);
    glfwSetWindowCloseCallback(handle, on_close);
    glfwSetWindowContentScaleCallback(handle, on_scale);
}

static bool handle_open(const struct window_params *params, struct window *window, struct err *err)
{
    if (!glfwInit())
        return err_set(err, ERR_USAGE,
                       "no display: %s; `lampyris render` and lampyris-view --headless need none",
                       glfw_error());
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    window->handle =
        glfwCreateWindow((int)params->width, (int)params->height, params->title, NULL, NULL);
    if (!window->handle) {
        err_set(err, ERR_SYSTEM, "a window of %u x %u pixels cannot be opened: %s", params->width,
                params->height, glfw_error());
        glfwTerminate();
        return false;
    }
    callbacks_set(window);
    float x, y;
    glfwGetWindowContentScale(window->handle, &x, &y);
    on_scale(window->handle, x, y);
    int width = 0, height = 0;
    glfwGetFramebufferSize(window->handle, &width, &height);
    if (size_set(window, width, height) &&
        (window->width != params->width || window->height != params->height))
        window_resize(window, params->width, params->height);
    return true;
}

bool window_open(const struct window_params *params, struct window *out, struct err *err)
{
    *out = (struct window){
        .width = params->width, .height = params->height, .scale = 1, .pixels_per_unit = {1, 1}};
    out->events = out->queues[1].list;
    if (params->width == 0 || params->height == 0 || params->width > INT16_MAX ||
        params->height > INT16_MAX) // X11's limit
        return err_set(err, ERR_USAGE,
                       "a window of %u x %u pixels: expected sides from 1 to %d pixels",
                       params->width, params->height, INT16_MAX);
    return params->headless || handle_open(params, out, err);
}

void window_close(struct window *window)
{
    if (!window)
        return;
    if (window->handle) {
        glfwDestroyWindow(window->handle);
        glfwTerminate();
        glfwSetErrorCallback(NULL);
    }
    arena_finish(&window->queues[0].texts);
    arena_finish(&window->queues[1].texts);
    *window = (struct window){0};
}

// --- Vulkan -------------------------------------------------------------------------------------

const char *const *window_extensions(uint32_t *count)
{
    *count = 0;
    const char **list = glfwGetRequiredInstanceExtensions(count);
    return (const char *const *)list;
}

bool window_can_present(void *window, VkInstance instance, VkPhysicalDevice device,
                        uint32_t queue_family)
{
    (void)window; // GLFW needs no window to determine this
    return glfwGetPhysicalDevicePresentationSupport(instance, device, queue_family);
}

bool window_create_surface(struct window *window, VkInstance instance, VkSurfaceKHR *out,
                           struct err *err)
{
    VkResult result = glfwCreateWindowSurface(instance, window->handle, NULL, out);
    return result == VK_SUCCESS ||
           err_set(err, ERR_GPU, "the window has no surface: %s (%d)", glfw_error(), (int)result);
}

// --- events, size and clipboard ------------------------------------------------------------------

void window_poll(struct window *window, double wait_seconds)
{
    bool waits = wait_seconds > 0 && window->queues[window->gathering].count == 0;
    if (window->handle && waits)
        glfwWaitEventsTimeout(wait_seconds);
    else if (window->handle)
        glfwPollEvents();
    else if (waits)
        clock_sleep(wait_seconds); // a signal ends this wait, too
    struct window_events *gathered = &window->queues[window->gathering];
    window->events = gathered->list;
    window->event_count = gathered->count;
    window->gathering ^= 1;
    window->queues[window->gathering].count = 0;
    arena_finish(&window->queues[window->gathering].texts);
}

void window_resize(struct window *window, uint32_t width, uint32_t height)
{
    if (window->handle) {
        glfwSetWindowSize(window->handle, (int)(width / window->pixels_per_unit[0] + 0.5),
                          (int)(height / window->pixels_per_unit[1] + 0.5));
        return;
    }
    window->width = width ? width : 1;
    window->height = height ? height : 1;
    event_add(window, &(struct event){.kind = EVENT_RESIZE});
}

void window_minimise(struct window *window, bool minimised)
{
    if (!window->handle)
        window->is_minimised = minimised;
    else if (minimised)
        glfwIconifyWindow(window->handle);
    else
        glfwRestoreWindow(window->handle);
}

void window_capture(struct window *window, bool captured)
{
    if (window->handle && window->is_captured != captured) {
        // Uses raw mouse movements, to which the system has not applied acceleration.
        if (glfwRawMouseMotionSupported())
            glfwSetInputMode(window->handle, GLFW_RAW_MOUSE_MOTION, captured);
        glfwSetInputMode(window->handle, GLFW_CURSOR,
                         captured ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
    }
    window->is_captured = captured;
}

void window_set_title(struct window *window, const char *title)
{
    if (window->handle)
        glfwSetWindowTitle(window->handle, title);
}

void window_set_clipboard(struct window *window, const char *text)
{
    if (window->handle)
        glfwSetClipboardString(window->handle, text);
}
