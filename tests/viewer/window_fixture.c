#include "window_fixture.h"

#include <unistd.h>

// GLFW's header for this function needs more X11 headers than this declaration.
struct GLFWwindow;
unsigned long glfwGetX11Window(struct GLFWwindow *window);

static uint32_t pixel(uint32_t seed, uint32_t i)
{
    return (i + seed * 7919u) * 2654435761u | 0xff000000u;
}

static bool device_open(struct stage *stage, const struct gpu_params *params, struct err *err)
{
    struct gpu_params all = *params;
    all.graphics = true;
    all.instance_extensions = window_extensions(&all.instance_extension_count);
    all.can_present = window_can_present;
    all.present_context = &stage->window;
    return gpu_open(&all, &stage->gpu, err);
}

bool stage_open(struct stage *stage, const struct gpu_params *params, struct err *err)
{
    *stage = (struct stage){0};
    const struct window_params window = {"lampyris test", START_WIDTH, START_HEIGHT, false};
    static const uint8_t coverage = 255;
    const struct gpu_atlas atlas = {&coverage, 1, 1};
    if (!window_open(&window, &stage->window, err))
        return false;
    stage->display = XOpenDisplay(NULL);
    return (stage->display || err_set(err, ERR_SYSTEM, "no display")) &&
           device_open(stage, params, err) &&
           gpu_screen_create(&stage->gpu, &atlas, &stage->screen, err) &&
           swapchain_create(&stage->gpu, &stage->window, true, &stage->swapchain, err) &&
           stage_size(stage, START_WIDTH, START_HEIGHT, err);
}

void stage_close(struct stage *stage)
{
    struct gpu *gpu = &stage->gpu;
    swapchain_finish(gpu, &stage->swapchain);
    gpu_screen_finish(gpu, &stage->screen);
    gpu_buffer_finish(gpu, &stage->pixels);
    CHECK(gpu->allocated_bytes == 0, "%llu bytes", (unsigned long long)gpu->allocated_bytes);
    gpu_close(gpu);
    CHECK(gpu->validation_messages == 0, "%u", gpu->validation_messages);
    if (stage->display)
        XCloseDisplay(stage->display);
    window_close(&stage->window);
}

bool stage_size(struct stage *stage, uint32_t width, uint32_t height, struct err *err)
{
    gpu_buffer_finish(&stage->gpu, &stage->pixels);
    return gpu_screen_resize(&stage->gpu, &stage->screen, width, height, err) &&
           gpu_buffer_create(&stage->gpu, "pixels", (uint64_t)width * height * 4, GPU_DEVICE, false,
                             &stage->pixels, err);
}

bool stage_draw(struct stage *stage, uint32_t seed, struct err *err)
{
    uint32_t count = stage->screen.width * stage->screen.height;
    uint32_t *data = malloc((size_t)count * sizeof *data);
    for (uint32_t i = 0; data && i < count; i++)
        data[i] = pixel(seed, i);
    bool ok = data && gpu_upload(&stage->gpu, &stage->pixels, 0, data, (uint64_t)count * 4, err) &&
              gpu_screen_draw(&stage->gpu, &stage->screen, &stage->pixels, NULL, err);
    free(data);
    return ok;
}

void sleep_ms(long ms)
{
    nanosleep(&(struct timespec){ms / 1000, ms % 1000 * 1000000}, NULL);
}

Window stage_x11_window(const struct stage *stage)
{
    return glfwGetX11Window(stage->window.handle);
}

static bool shows_now(struct stage *stage, uint32_t seed)
{
    XWindowAttributes attributes;
    Window window = stage_x11_window(stage);
    const struct gpu_screen *screen = &stage->screen;
    if (!XGetWindowAttributes(stage->display, window, &attributes) ||
        (uint32_t)attributes.width != screen->width ||
        (uint32_t)attributes.height != screen->height)
        return false;
    XImage *image =
        XGetImage(stage->display, window, 0, 0, screen->width, screen->height, AllPlanes, ZPixmap);
    bool same = image != NULL;
    for (uint32_t i = 0; same && i < screen->width * screen->height; i++) {
        uint32_t wanted = pixel(seed, i);
        unsigned long got = XGetPixel(image, (int)(i % screen->width), (int)(i / screen->width));
        same = (got & 0xffffffu) ==
               ((wanted & 255u) << 16 | (wanted & 0xff00u) | (wanted >> 16 & 255u));
    }
    if (image)
        XDestroyImage(image);
    return same;
}

bool stage_shows(struct stage *stage, uint32_t seed)
{
    for (int wait = 0; wait < 1000; wait++) {
        if (shows_now(stage, seed))
            return true;
        sleep_ms(10);
    }
    return false;
}

const struct event *stage_wait(struct stage *stage, enum event_kind kind)
{
    for (int wait = 0; wait < 1000; wait++) {
        window_poll(&stage->window, 0.01);
        for (uint32_t i = 0; i < stage->window.event_count; i++)
            if (stage->window.events[i].kind == kind)
                return &stage->window.events[i];
    }
    return NULL;
}

double resident_megabytes(void)
{
    long all = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file && fscanf(file, "%ld %ld", &all, &resident) != 2)
        resident = 0;
    if (file)
        fclose(file);
    return (double)resident * (double)sysconf(_SC_PAGESIZE) / 1048576;
}
