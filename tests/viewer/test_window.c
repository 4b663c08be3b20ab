// Tests the window without a display: pushed events are returned in order, and a missing display is
// reported.
#include "test.h"
#include "viewer/window/window.h"

#include <GLFW/glfw3.h>
#include <time.h>

// Opens a window without a display. If that fails, the test ends.
#define OPEN_HEADLESS(window)                                                                      \
    do {                                                                                           \
        struct err open_err = {0};                                                                 \
        const struct window_params open_params = {"test", 320, 200, .headless = true};             \
        REQUIRE(window_open(&open_params, (window), &open_err), "%s", open_err.msg);               \
    } while (0)

TEST(no_display_is_a_message)
{
    struct window window;
    struct err err = {0};
    const struct window_params params = {"test", 320, 200, .headless = false};
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    CHECK(!window_open(&params, &window, &err));
    CHECK(err.code == ERR_USAGE && strstr(err.msg, "no display: ") == err.msg &&
              strstr(err.msg, "DISPLAY environment variable") && strstr(err.msg, "--headless") &&
              strstr(err.msg, "`lampyris render`"),
          "%d: %s", err.code, err.msg);
    window_close(&window);
    setenv("DISPLAY", ":12345", 1);
    err = (struct err){0};
    CHECK(!window_open(&params, &window, &err));
    CHECK(err.code == ERR_USAGE && strstr(err.msg, ":12345"), "%d: %s", err.code, err.msg);
    window_close(&window);
    window_close(NULL);
}

TEST(sizes_are_checked)
{
    static const uint32_t sizes[][2] = {{0, 200}, {320, 0}, {32768, 10}, {10, UINT32_MAX}};
    for (int i = 0; i < 4; i++) {
        struct window window;
        struct err err = {0};
        const struct window_params params = {"test", sizes[i][0], sizes[i][1], .headless = true};
        CHECK(!window_open(&params, &window, &err) && err.code == ERR_USAGE &&
                  strstr(err.msg, "32767"),
              "%s", err.msg);
        window_close(&window);
    }
}

TEST(headless_has_no_surface)
{
    struct window window;
    uint32_t count = 5;
    OPEN_HEADLESS(&window);
    CHECK(window.width == 320 && window.height == 200 && window.scale == 1 && !window.handle);
    CHECK(!window_extensions(&count) && count == 0, "%u", count);
    window_set_title(&window, "another");
    window_set_clipboard(&window, "text");
    window_capture(&window, true);
    CHECK(window.is_captured);
    window_minimise(&window, true);
    CHECK(window.is_minimised);
    window_close(&window);
}

// Events of all kinds are returned once and in order. Paths are copies that remain valid until the
// next poll.
TEST(pushed_events_come_in_order)
{
    struct window window;
    OPEN_HEADLESS(&window);
    char path[] = "scene.json";
    const struct event events[] = {
        {EVENT_KEY, .code = GLFW_KEY_W, .down = true, .modifiers = EVENT_SHIFT},
        {EVENT_MOVE, .x = 3, .y = 4.5},
        {EVENT_BUTTON, .code = 1, .down = true},
        {EVENT_MOVE, .x = 30, .y = -4},
        {EVENT_SCROLL, .x = 0, .y = 1},
        {EVENT_SCROLL, .x = 0, .y = 1},
        {EVENT_TEXT, .code = 0x1f41b},
        {EVENT_DROP, .path = path},
        {EVENT_DROP, .path = "other"},
        {EVENT_FOCUS},
        {EVENT_CLOSE},
    };
    const uint32_t count = sizeof events / sizeof events[0];
    window_poll(&window, 0);
    CHECK(window.event_count == 0, "%u", window.event_count);
    for (uint32_t i = 0; i < count; i++)
        window_push(&window, &events[i]);
    memset(path, 'x', strlen(path));
    CHECK(window.event_count == 0, "before the poll: %u", window.event_count);
    window_poll(&window, 10); // returns at once
    CHECK(window.event_count == count, "%u of %u", window.event_count, count);
    for (uint32_t i = 0; i < count && i < window.event_count; i++) {
        const struct event *got = &window.events[i], *pushed = &events[i];
        CHECK(got->kind == pushed->kind && got->code == pushed->code && got->down == pushed->down &&
                  got->modifiers == pushed->modifiers && got->x == pushed->x && got->y == pushed->y,
              "event %u", i);
    }
    CHECK(window.event_count == count && strcmp(window.events[7].path, "scene.json") == 0 &&
          strcmp(window.events[8].path, "other") == 0);
    CHECK(window.should_close);
    // Events that arrive while others are read must not overwrite them.
    window_push(&window, &events[0]);
    CHECK(window.events[10].kind == EVENT_CLOSE && window.event_count == count);
    window_poll(&window, 0);
    CHECK(window.event_count == 1 && window.events[0].code == GLFW_KEY_W);
    window_close(&window);
}

TEST(movements_and_sizes_in_a_row_become_one)
{
    struct window window;
    OPEN_HEADLESS(&window);
    for (int i = 0; i < 1000; i++)
        window_push(&window, &(struct event){EVENT_MOVE, .x = i});
    for (uint32_t i = 0; i <= 100; i++)
        window_resize(&window, 1000 - i, i);
    CHECK(window.width == 900 && window.height == 100);
    window_push(&window, &(struct event){EVENT_MOVE, .x = 5});
    window_poll(&window, 0);
    REQUIRE(window.event_count == 3, "%u", window.event_count);
    CHECK(window.events[0].x == 999 && window.events[1].kind == EVENT_RESIZE &&
          window.events[2].x == 5);
    window_resize(&window, 0, 7);
    CHECK(window.width == 1 && window.height == 7);
    window_close(&window);
}

// Events that do not fit are dropped, but no key remains held because of that.
TEST(too_many_events_end_without_the_focus)
{
    struct window window;
    OPEN_HEADLESS(&window);
    for (int i = 0; i < 3 * WINDOW_EVENTS_MAX; i++)
        window_push(&window, &(struct event){EVENT_KEY, .code = 65, .down = i % 2 == 0});
    window_poll(&window, 0);
    CHECK(window.event_count == WINDOW_EVENTS_MAX, "%u", window.event_count);
    const struct event *last = &window.events[window.event_count - 1];
    CHECK(last->kind == EVENT_FOCUS && !last->down, "kind %d", (int)last->kind);
    window_push(&window, &(struct event){EVENT_KEY, .code = 66});
    window_poll(&window, 0);
    CHECK(window.event_count == 1 && window.events[0].code == 66);
    window_close(&window);
}

static double seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

TEST(polls_wait_where_nothing_happened)
{
    struct window window;
    OPEN_HEADLESS(&window);
    double start = seconds_now();
    window_poll(&window, 0.05);
    double waited = seconds_now() - start;
    CHECK(waited >= 0.05, "%g s", waited);
    window_close(&window);
}

TEST_MAIN(TEST_CASE(no_display_is_a_message), TEST_CASE(sizes_are_checked),
          TEST_CASE(headless_has_no_surface), TEST_CASE(pushed_events_come_in_order),
          TEST_CASE(movements_and_sizes_in_a_row_become_one),
          TEST_CASE(too_many_events_end_without_the_focus),
          TEST_CASE(polls_wait_where_nothing_happened))
