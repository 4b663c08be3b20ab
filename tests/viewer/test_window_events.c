// Input by keyboard and mouse, which the X server itself simulates (XTEST, with xdotool), and
// requests of a window manager become events.
#include "window_fixture.h"

#include <GLFW/glfw3.h>
#include <X11/Xatom.h>

// Opens a window with the keyboard focus; no window manager handles that here.
static bool window_with_focus(struct stage *stage, struct err *err)
{
    *stage = (struct stage){0};
    const struct window_params params = {"lampyris test", START_WIDTH, START_HEIGHT, false};
    stage->display = XOpenDisplay(NULL);
    if (!stage->display || !window_open(&params, &stage->window, err))
        return false;
    XMoveWindow(stage->display, stage_x11_window(stage), 0, 0);
    XSetInputFocus(stage->display, stage_x11_window(stage), RevertToParent, CurrentTime);
    XSync(stage->display, False);
    for (int wait = 0; wait < 1000 && !glfwGetWindowAttrib(stage->window.handle, GLFW_FOCUSED);
         wait++)
        window_poll(&stage->window, 0.01);
    window_poll(&stage->window, 0);
    return glfwGetWindowAttrib(stage->window.handle, GLFW_FOCUSED);
}

#define WINDOW(stage)                                                                              \
    do {                                                                                           \
        struct err open_err = {0};                                                                 \
        if (!window_with_focus((stage), &open_err)) {                                              \
            if (!(stage)->display)                                                                 \
                SKIP("no display");                                                                \
            REQUIRE(false, "%s", open_err.msg[0] ? open_err.msg : "no focus");                     \
        }                                                                                          \
        if (system("xdotool version >/dev/null 2>&1") != 0)                                        \
            SKIP("xdotool is not installed");                                                      \
    } while (0)

static void finish(struct stage *stage)
{
    window_close(&stage->window);
    XCloseDisplay(stage->display);
}

// Polls for at most ten seconds until `count` events other than movements have arrived. Returns
// their number.
static uint32_t gather(struct stage *stage, struct event *out, uint32_t count)
{
    uint32_t found = 0;
    for (int wait = 0; wait < 1000 && found < count; wait++) {
        window_poll(&stage->window, 0.01);
        for (uint32_t i = 0; i < stage->window.event_count && found < count; i++)
            if (stage->window.events[i].kind != EVENT_MOVE &&
                stage->window.events[i].kind != EVENT_RESIZE)
                out[found++] = stage->window.events[i];
    }
    return found;
}

static void check_events(struct stage *stage, const char *command, const struct event *expected,
                         uint32_t count)
{
    struct event got[16];
    CHECK(system(command) == 0, "%s", command);
    uint32_t found = gather(stage, got, count);
    CHECK(found == count, "%s: %u events, expected %u", command, found, count);
    for (uint32_t i = 0; i < found; i++)
        CHECK(got[i].kind == expected[i].kind && got[i].code == expected[i].code &&
                  got[i].down == expected[i].down && got[i].modifiers == expected[i].modifiers &&
                  got[i].x == expected[i].x && got[i].y == expected[i].y,
              "%s: event %u: kind %d, code %d, down %d, modifiers %u, %g %g", command, i,
              (int)got[i].kind, got[i].code, got[i].down, got[i].modifiers, got[i].x, got[i].y);
}
#define EXPECT(stage, command, ...)                                                                \
    do {                                                                                           \
        const struct event expected[] = {__VA_ARGS__};                                             \
        check_events((stage), (command), expected, sizeof expected / sizeof expected[0]);          \
    } while (0)

TEST(keys_and_text_come_in_order)
{
    struct stage stage;
    WINDOW(&stage);
    EXPECT(&stage, "xdotool key w", {EVENT_KEY, .code = GLFW_KEY_W, .down = true},
           {EVENT_TEXT, .code = 'w'}, {EVENT_KEY, .code = GLFW_KEY_W});
    EXPECT(&stage, "xdotool key F1", {EVENT_KEY, .code = GLFW_KEY_F1, .down = true},
           {EVENT_KEY, .code = GLFW_KEY_F1});
    EXPECT(&stage, "xdotool keydown shift key a keyup shift",
           {EVENT_KEY, .code = GLFW_KEY_LEFT_SHIFT, .down = true, .modifiers = EVENT_SHIFT},
           {EVENT_KEY, .code = GLFW_KEY_A, .down = true, .modifiers = EVENT_SHIFT},
           {EVENT_TEXT, .code = 'A', .modifiers = EVENT_SHIFT},
           {EVENT_KEY, .code = GLFW_KEY_A, .modifiers = EVENT_SHIFT},
           {EVENT_KEY, .code = GLFW_KEY_LEFT_SHIFT});
    EXPECT(&stage, "xdotool keydown ctrl key z keyup ctrl",
           {EVENT_KEY, .code = GLFW_KEY_LEFT_CONTROL, .down = true, .modifiers = EVENT_CONTROL},
           {EVENT_KEY, .code = GLFW_KEY_Z, .down = true, .modifiers = EVENT_CONTROL},
           {EVENT_KEY, .code = GLFW_KEY_Z, .modifiers = EVENT_CONTROL},
           {EVENT_KEY, .code = GLFW_KEY_LEFT_CONTROL});
    finish(&stage);
}

TEST(held_keys_repeat_and_go_with_the_focus)
{
    struct stage stage;
    WINDOW(&stage);
    EXPECT(&stage, "xdotool keydown d", {EVENT_KEY, .code = GLFW_KEY_D, .down = true});
    bool repeats = false;
    for (int wait = 0; wait < 1000 && !repeats; wait++) {
        window_poll(&stage.window, 0.01);
        for (uint32_t i = 0; i < stage.window.event_count; i++)
            repeats |= stage.window.events[i].kind == EVENT_KEY && stage.window.events[i].repeated;
    }
    CHECK(repeats, "the key does not repeat");
    XSetInputFocus(stage.display, None, RevertToNone, CurrentTime);
    XSync(stage.display, False);
    const struct event *focus = stage_wait(&stage, EVENT_FOCUS);
    CHECK(focus && !focus->down);
    CHECK(system("xdotool keyup d") == 0);
    finish(&stage);
}

TEST(the_mouse_moves_presses_and_scrolls)
{
    struct stage stage;
    WINDOW(&stage);
    static const int places[][2] = {{3, 2}, {50, 60}, {319, 199}, {100, 7}};
    for (int i = 0; i < 4; i++) {
        char command[64];
        snprintf(command, sizeof command, "xdotool mousemove %d %d", places[i][0], places[i][1]);
        CHECK(system(command) == 0);
        const struct event *move = stage_wait(&stage, EVENT_MOVE);
        while (move && (move->x != places[i][0] || move->y != places[i][1]))
            move = stage_wait(&stage, EVENT_MOVE);
        CHECK(move != NULL, "no movement to %d, %d", places[i][0], places[i][1]);
    }
    EXPECT(&stage, "xdotool click 1", {EVENT_BUTTON, .code = 0, .down = true}, {EVENT_BUTTON});
    EXPECT(&stage, "xdotool click 3", {EVENT_BUTTON, .code = 1, .down = true},
           {EVENT_BUTTON, .code = 1});
    EXPECT(&stage, "xdotool click 2", {EVENT_BUTTON, .code = 2, .down = true},
           {EVENT_BUTTON, .code = 2});
    EXPECT(&stage, "xdotool click 4", {EVENT_SCROLL, .y = 1});
    EXPECT(&stage, "xdotool click 5", {EVENT_SCROLL, .y = -1});
    finish(&stage);
}

// A captured mouse has no bounds: it may move in one direction without end.
TEST(a_captured_mouse_has_no_bounds)
{
    struct stage stage;
    WINDOW(&stage);
    CHECK(system("xdotool mousemove 100 100") == 0);
    CHECK(stage_wait(&stage, EVENT_MOVE) != NULL);
    window_capture(&stage.window, true);
    CHECK(stage.window.is_captured);
    double start = -1, x = -1;
    for (int i = 0; i < 30; i++) {
        CHECK(system("xdotool mousemove_relative 100 0") == 0);
        window_poll(&stage.window, 0.02);
        for (uint32_t e = 0; e < stage.window.event_count; e++)
            if (stage.window.events[e].kind == EVENT_MOVE) {
                x = stage.window.events[e].x;
                start = start < 0 ? x : start;
            }
    }
    CHECK(x - start > 1500, "from %g to %g", start, x);
    window_capture(&stage.window, false);
    CHECK(!stage.window.is_captured);
    finish(&stage);
}

TEST(closing_is_asked_for)
{
    struct stage stage;
    WINDOW(&stage);
    XClientMessageEvent message = {
        .type = ClientMessage,
        .window = stage_x11_window(&stage),
        .message_type = XInternAtom(stage.display, "WM_PROTOCOLS", False),
        .format = 32,
    };
    message.data.l[0] = (long)XInternAtom(stage.display, "WM_DELETE_WINDOW", False);
    XSendEvent(stage.display, message.window, False, NoEventMask, (XEvent *)&message);
    XSync(stage.display, False);
    CHECK(stage_wait(&stage, EVENT_CLOSE) && stage.window.should_close);
    finish(&stage);
}

// GLFW reports this when a file manager has dropped files on the window.
TEST(dropped_files_are_events)
{
    struct stage stage;
    WINDOW(&stage);
    const char *paths[] = {"/tmp/a scene.json", "b.glb"};
    GLFWdropfun on_drop = glfwSetDropCallback(stage.window.handle, NULL);
    REQUIRE(on_drop);
    on_drop(stage.window.handle, 2, paths);
    struct event got[2];
    REQUIRE(gather(&stage, got, 2) == 2);
    for (int i = 0; i < 2; i++)
        CHECK(got[i].kind == EVENT_DROP && strcmp(got[i].path, paths[i]) == 0, "%d", i);
    finish(&stage);
}

TEST(titles_and_clipboards_are_set)
{
    struct stage stage;
    WINDOW(&stage);
    window_set_title(&stage.window, "cornell.json");
    window_set_clipboard(&stage.window, "\"camera\": {}");
    char *title = NULL;
    XSync(stage.display, False);
    window_poll(&stage.window, 0.02);
    CHECK(XFetchName(stage.display, stage_x11_window(&stage), &title) && title &&
              strcmp(title, "cornell.json") == 0,
          "%s", title ? title : "none");
    XFree(title);
    const char *clipboard = glfwGetClipboardString(stage.window.handle);
    CHECK(clipboard && strcmp(clipboard, "\"camera\": {}") == 0, "%s", clipboard ? clipboard : "");
    finish(&stage);
}

// Displays with small pixels set this X11 resource; text has twice the size on them.
TEST(scale_is_the_displays)
{
    static const struct {
        const char *resources;
        float scale;
    } cases[] = {{"Xft.dpi:\t192\n", 2}, {"Xft.dpi:\t144\n", 1.5f}, {"", 1}};
    Display *display = XOpenDisplay(NULL);
    if (!display)
        SKIP("no display");
    for (int i = 0; i < 3; i++) {
        struct window window;
        struct err err = {0};
        const struct window_params params = {"lampyris test", START_WIDTH, START_HEIGHT, false};
        const char *text = cases[i].resources;
        XChangeProperty(display, DefaultRootWindow(display), XA_RESOURCE_MANAGER, XA_STRING, 8,
                        PropModeReplace, (const unsigned char *)text, (int)strlen(text));
        XSync(display, False);
        CHECK(window_open(&params, &window, &err), "%s", err.msg);
        CHECK(window.scale == cases[i].scale, "%g, expected %g", (double)window.scale,
              (double)cases[i].scale);
        CHECK(window.width == START_WIDTH && window.height == START_HEIGHT, "%u x %u", window.width,
              window.height);
        window_close(&window);
    }
    XCloseDisplay(display);
}

TEST_MAIN(TEST_CASE(keys_and_text_come_in_order), TEST_CASE(held_keys_repeat_and_go_with_the_focus),
          TEST_CASE(the_mouse_moves_presses_and_scrolls), TEST_CASE(a_captured_mouse_has_no_bounds),
          TEST_CASE(closing_is_asked_for), TEST_CASE(dropped_files_are_events),
          TEST_CASE(titles_and_clipboards_are_set), TEST_CASE(scale_is_the_displays))
