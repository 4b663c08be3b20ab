// Tests pictures in a real window: they are shown bit by bit, through every change of the window.
#include "window_fixture.h"

#include <GLFW/glfw3.h>

TEST(pictures_are_shown)
{
    struct stage stage;
    struct err err = {0};
    STAGE_OPEN(&stage, .validation = true);
    for (uint32_t seed = 0; seed < 5; seed++) {
        CHECK(stage_draw(&stage, seed, &err) && stage_show(&stage, &err), "%s", err.msg);
        CHECK(stage_shows(&stage, seed), "picture %u", seed);
    }
    CHECK(stage.swapchain.shown == 5 && stage.swapchain.recreated == 0, "%u shown, %u made anew",
          (unsigned)stage.swapchain.shown, (unsigned)stage.swapchain.recreated);
    stage_close(&stage);
}

static bool resize_to(struct stage *stage, uint32_t width, uint32_t height, struct err *err)
{
    if (width == stage->window.width && height == stage->window.height)
        return true;
    window_resize(&stage->window, width, height);
    while (stage->window.width != width || stage->window.height != height)
        if (!stage_wait(stage, EVENT_RESIZE))
            return err_set(err, ERR_BUG, "no event of the size %u x %u", width, height);
    return stage_size(stage, width, height, err);
}

static void resize_often(struct stage *stage, uint32_t count, uint32_t period, double *grown)
{
    struct err err = {0};
    uint64_t bytes = 0;
    double megabytes = 0;
    bool ok = true;
    for (uint32_t i = 0; ok && i < count; i++) {
        uint32_t j = i % period;
        ok = resize_to(stage, 200 + j * 37 % 300, 100 + j * 53 % 200, &err) &&
             stage_draw(stage, i, &err) && stage_show(stage, &err);
        CHECK(i % 25 || !ok || stage_shows(stage, i), "picture %u", i);
        if (i == 2 * period) {
            bytes = stage->gpu.allocated_bytes;
            megabytes = resident_megabytes();
        }
        CHECK(!bytes || j != 0 || stage->gpu.allocated_bytes == bytes, "%llu bytes, expected %llu",
              (unsigned long long)stage->gpu.allocated_bytes, (unsigned long long)bytes);
    }
    CHECK(ok, "%s", err.msg);
    // On a busy machine a few images may be late.
    CHECK(stage->swapchain.shown + count / 20 >= count, "%u shown",
          (unsigned)stage->swapchain.shown);
    CHECK(stage->swapchain.recreated >= count - 1, "%u made anew",
          (unsigned)stage->swapchain.recreated);
    *grown = resident_megabytes() - megabytes;
}

TEST(resizing_leaks_nothing)
{
    struct stage stage;
    double grown;
    STAGE_OPEN(&stage, .validation = false);
    resize_often(&stage, 500, 50, &grown);
    // 400 leaked swapchains, each with three images of these sizes, would take 270 MB.
    CHECK(grown < 16, "%.1f megabytes", grown);
    stage_close(&stage);
}

TEST(resizing_is_silent)
{
    struct stage stage;
    double grown;
    STAGE_OPEN(&stage, .validation = true);
    resize_often(&stage, 60, 20, &grown);
    stage_close(&stage);
}

// The window is larger than the picture, so the picture is scaled. Each quarter has one colour.
TEST(pictures_of_another_size_are_scaled)
{
    struct stage stage;
    struct err err = {0};
    STAGE_OPEN(&stage, .validation = true);
    static const uint32_t colors[4] = {0xff0000ff, 0xff00ff00, 0xffff8000, 0xff40c0f0};
    uint32_t data[32 * 20];
    for (uint32_t i = 0; i < 32 * 20; i++)
        data[i] = colors[(i % 32 >= 16) + 2 * (i / 32 >= 10)];
    CHECK(stage_size(&stage, 32, 20, &err) &&
              gpu_upload(&stage.gpu, &stage.pixels, 0, data, sizeof data, &err) &&
              gpu_screen_draw(&stage.gpu, &stage.screen, &stage.pixels, NULL, &err) &&
              stage_show(&stage, &err),
          "%s", err.msg);
    sleep_ms(100); // until the window system has processed it
    for (int quarter = 0; quarter < 4; quarter++) {
        int x = 5 + (quarter & 1) * 290, y = 5 + (quarter >> 1) * 170;
        XImage *image =
            XGetImage(stage.display, stage_x11_window(&stage), x, y, 1, 1, AllPlanes, ZPixmap);
        REQUIRE(image);
        uint32_t c = colors[quarter];
        uint32_t wanted = (c & 255u) << 16 | (c & 0xff00u) | (c >> 16 & 255u);
        CHECK((XGetPixel(image, 0, 0) & 0xffffffu) == wanted, "quarter %d: %lx, expected %x",
              quarter, XGetPixel(image, 0, 0), wanted);
        XDestroyImage(image);
    }
    stage_close(&stage);
}

TEST(vsync_may_be_changed)
{
    struct stage stage;
    struct err err = {0};
    STAGE_OPEN(&stage, .validation = true);
    for (uint32_t i = 0; i < 6; i++) {
        stage.swapchain.vsync = i % 2;
        CHECK(stage_draw(&stage, i, &err) && stage_show(&stage, &err), "%s", err.msg);
        CHECK(stage_shows(&stage, i), "picture %u", i);
        bool waits = stage.swapchain.present_mode == VK_PRESENT_MODE_FIFO_KHR;
        CHECK(waits == i % 2, "mode %d", (int)stage.swapchain.present_mode);
    }
    CHECK(stage.swapchain.recreated == 6, "%u", (unsigned)stage.swapchain.recreated);
    stage_close(&stage);
}

// Sets the state that a window manager writes on windows (ICCCM, section 4.1.3.1).
static void set_state(struct stage *stage, long state)
{
    Atom atom = XInternAtom(stage->display, "WM_STATE", False);
    const long data[2] = {state, None};
    XChangeProperty(stage->display, stage_x11_window(stage), atom, atom, 32, PropModeReplace,
                    (const unsigned char *)data, 2);
    XSync(stage->display, False);
}

static bool wait_minimised(struct stage *stage, bool minimised)
{
    for (int wait = 0; wait < 1000 && stage->window.is_minimised != minimised; wait++)
        window_poll(&stage->window, 0.01);
    return stage->window.is_minimised == minimised;
}

TEST(minimised_windows_show_nothing)
{
    struct stage stage;
    struct err err = {0};
    STAGE_OPEN(&stage, .validation = true);
    for (uint32_t round = 0; round < 3; round++) {
        CHECK(stage_draw(&stage, round, &err) && stage_show(&stage, &err), "%s", err.msg);
        CHECK(stage_shows(&stage, round), "picture %u", round);
        set_state(&stage, IconicState);
        CHECK(wait_minimised(&stage, true));
        uint64_t shown = stage.swapchain.shown;
        CHECK(stage_draw(&stage, round + 50, &err) && stage_show(&stage, &err), "%s", err.msg);
        CHECK(stage.swapchain.shown == shown && stage_shows(&stage, round));
        set_state(&stage, NormalState);
        CHECK(wait_minimised(&stage, false));
        CHECK(stage_show(&stage, &err) && stage_shows(&stage, round + 50), "%s", err.msg);
    }
    window_minimise(&stage.window, true); // no window manager exists that could do it
    window_minimise(&stage.window, false);
    stage_close(&stage);
}

// The window of the surface is destroyed, and another one exists.
TEST(another_window_gets_a_surface)
{
    struct stage stage;
    struct err err = {0};
    STAGE_OPEN(&stage, .validation = true);
    for (uint32_t round = 0; round < 3; round++) {
        CHECK(stage_draw(&stage, round, &err) && stage_show(&stage, &err), "%s", err.msg);
        CHECK(stage_shows(&stage, round));
        glfwDestroyWindow(stage.window.handle);
        stage.window.handle =
            glfwCreateWindow((int)START_WIDTH, (int)START_HEIGHT, "another", NULL, NULL);
        REQUIRE(stage.window.handle);
    }
    CHECK(stage.swapchain.recreated == 2, "%u", (unsigned)stage.swapchain.recreated);
    stage_close(&stage);
}

TEST_MAIN(TEST_CASE(pictures_are_shown), TEST_CASE(resizing_leaks_nothing),
          TEST_CASE(resizing_is_silent), TEST_CASE(pictures_of_another_size_are_scaled),
          TEST_CASE(vsync_may_be_changed), TEST_CASE(minimised_windows_show_nothing),
          TEST_CASE(another_window_gets_a_surface))
