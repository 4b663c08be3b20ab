// Tests the screen: images arrive bit by bit, triangles equal a computation on the CPU, and all
// objects are destroyed.
#include "gpu/screen.h"
#include "gpu_fixture.h"
#include <math.h>
#include <unistd.h>

// Odd, so that rows of the image and of the buffer do not have the same length by chance.
#define WIDTH 61u
#define HEIGHT 43u
#define ATLAS 8u

// Without a graphics queue there is no screen to test.
#define OPEN_GRAPHICS(gpu, ...)                                                                    \
    do {                                                                                           \
        const struct gpu_params open_params = {.graphics = true, __VA_ARGS__};                     \
        struct err open_err = {0};                                                                 \
        if (!gpu_open(&open_params, (gpu), &open_err)) {                                           \
            if (open_err.code == ERR_NO_VULKAN || strstr(open_err.msg, "is not installed") ||      \
                strstr(open_err.msg, "no queue"))                                                  \
                SKIP("%s", open_err.msg);                                                          \
            REQUIRE(false, "%s", open_err.msg);                                                    \
        }                                                                                          \
    } while (0)

static void atlas_fill(uint8_t coverage[ATLAS * ATLAS])
{
    for (uint32_t i = 0; i < ATLAS * ATLAS; i++)
        coverage[i] = (uint8_t)(element(i) >> 24);
    coverage[0] = 255;
}

// A screen, and the image displayed on it.
struct stage {
    struct gpu gpu;
    struct gpu_screen screen;
    struct gpu_buffer pixels;
    struct arena arena;
    uint8_t coverage[ATLAS * ATLAS];
};

static bool stage_resize(struct stage *stage, uint32_t width, uint32_t height, struct err *err)
{
    struct gpu *gpu = &stage->gpu;
    gpu_buffer_finish(gpu, &stage->pixels);
    uint32_t count = width * height;
    uint32_t *data = elements_new(count);
    bool ok = data && gpu_screen_resize(gpu, &stage->screen, width, height, err) &&
              gpu_buffer_create(gpu, "pixels", (uint64_t)count * 4, GPU_DEVICE, false,
                                &stage->pixels, err) &&
              gpu_upload(gpu, &stage->pixels, 0, data, (uint64_t)count * 4, err);
    free(data);
    return ok;
}

static bool stage_create(struct stage *stage, struct err *err)
{
    atlas_fill(stage->coverage);
    const struct gpu_atlas atlas = {stage->coverage, ATLAS, ATLAS};
    return gpu_screen_create(&stage->gpu, &atlas, &stage->screen, err) &&
           stage_resize(stage, WIDTH, HEIGHT, err);
}

static void stage_finish(struct stage *stage)
{
    gpu_screen_finish(&stage->gpu, &stage->screen);
    gpu_buffer_finish(&stage->gpu, &stage->pixels);
    arena_finish(&stage->arena);
    uint64_t left = stage->gpu.allocated_bytes;
    CHECK(left == 0, "%llu bytes are left", (unsigned long long)left);
    gpu_close(&stage->gpu);
    uint32_t messages = stage->gpu.validation_messages;
    CHECK(messages == 0, "%u messages", messages);
}

static bool stage_draw(struct stage *stage, const struct gpu_drawing *drawing, uint8_t (**out)[4],
                       struct err *err)
{
    return gpu_screen_draw(&stage->gpu, &stage->screen, &stage->pixels, drawing, err) &&
           gpu_screen_read(&stage->gpu, &stage->screen, &stage->arena, out, err);
}

// --- the same on the CPU ------------------------------------------------------------------------

// Bilinear lookup, clamped to the edge, with texel centres at halves.
static double atlas_at(const uint8_t *coverage, double u, double v)
{
    double x = u * ATLAS - 0.5, y = v * ATLAS - 0.5, sum = 0;
    for (int corner = 0; corner < 4; corner++) {
        double column = floor(x) + (corner & 1), row = floor(y) + (corner >> 1);
        double weight = (1 - fabs(x - column)) * (1 - fabs(y - row));
        int i = (int)fmin(fmax(column, 0), ATLAS - 1), j = (int)fmin(fmax(row, 0), ATLAS - 1);
        sum += weight * coverage[j * (int)ATLAS + i] / 255;
    }
    return sum;
}

// Returns twice the signed area of a triangle; the sign is its orientation.
static double area(const float a[2], const float b[2], const double c[2])
{
    return ((double)b[0] - a[0]) * (c[1] - a[1]) - ((double)b[1] - a[1]) * (c[0] - a[0]);
}

struct picture {
    double rgba[WIDTH * HEIGHT][4]; // values from 0 to 255
    bool is_on_edge[WIDTH * HEIGHT];
};

static void blend(double pixel[4], const double color[4], double alpha)
{
    for (int c = 0; c < 3; c++)
        pixel[c] = pixel[c] * (1 - alpha) + color[c] * alpha;
    pixel[3] = pixel[3] * (1 - alpha) + 255 * alpha;
}

static void triangle(struct picture *picture, const struct gpu_vertex *v[3], const float clip[4],
                     const uint8_t *coverage)
{
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        const double p[2] = {i % WIDTH + 0.5, i / WIDTH + 0.5};
        // The sides of the clipping rectangle are at whole pixels.
        if (!(p[0] > clip[0] && p[0] < clip[2] && p[1] > clip[1] && p[1] < clip[3]))
            continue;
        double all = area(v[0]->position, v[1]->position,
                          (const double[]){v[2]->position[0], v[2]->position[1]});
        const double weights[3] = {area(v[1]->position, v[2]->position, p) / all,
                                   area(v[2]->position, v[0]->position, p) / all,
                                   area(v[0]->position, v[1]->position, p) / all};
        double least = fmin(weights[0], fmin(weights[1], weights[2]));
        picture->is_on_edge[i] |= fabs(least) < 1e-9;
        if (least < 0)
            continue;
        double color[4] = {0}, u = 0, w = 0;
        for (int corner = 0; corner < 3; corner++) {
            u += weights[corner] * v[corner]->uv[0];
            w += weights[corner] * v[corner]->uv[1];
            for (int c = 0; c < 4; c++)
                color[c] += weights[corner] * (v[corner]->color >> 8 * c & 255);
        }
        blend(picture->rgba[i], color, color[3] / 255 * atlas_at(coverage, u, w));
    }
}

static void draw_on_cpu(const struct gpu_drawing *drawing, const uint8_t *coverage,
                        struct picture *picture)
{
    *picture = (struct picture){0};
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
        for (int c = 0; c < 4; c++)
            picture->rgba[i][c] = element(i) >> 8 * c & 255;
    for (uint32_t d = 0; d < drawing->draw_count; d++) {
        const struct gpu_draw *draw = &drawing->draws[d];
        const uint16_t *index = drawing->indices + draw->first_index;
        for (uint32_t t = 0; t < draw->index_count; t += 3) {
            const struct gpu_vertex *corners[3];
            for (int corner = 0; corner < 3; corner++)
                corners[corner] = &drawing->vertices[draw->first_vertex + index[t + corner]];
            triangle(picture, corners, draw->clip, coverage);
        }
    }
}

// Each layer is rounded to bytes once, and filters have at least 8 bits for positions.
#define TOLERANCE 2.5

static void compare(const struct picture *expected, uint8_t (*got)[4], const char *what)
{
    uint32_t wrong = 0, edges = 0;
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        edges += expected->is_on_edge[i];
        for (int c = 0; c < 4 && !expected->is_on_edge[i]; c++) {
            double off = fabs(got[i][c] - expected->rgba[i][c]);
            if (off > TOLERANCE && wrong++ < 4)
                CHECK(false, "%s: pixel %u, %u, channel %d: %u, expected %.2f", what, i % WIDTH,
                      i / WIDTH, c, got[i][c], expected->rgba[i][c]);
        }
    }
    CHECK(wrong == 0, "%s: %u values", what, wrong);
    CHECK(edges < WIDTH * HEIGHT / 20, "%s: %u pixels are on edges", what, edges);
}

// --- the tests ----------------------------------------------------------------------------------

TEST(pictures_are_copied)
{
    struct stage stage = {0};
    struct err err = {0};
    OPEN_GRAPHICS(&stage.gpu, .validation = true);
    uint8_t(*got)[4] = NULL;
    const struct gpu_drawing nothing = {0};
    if (stage_create(&stage, &err)) {
        for (int with_drawing = 0; with_drawing < 2; with_drawing++) {
            bool ok = stage_draw(&stage, with_drawing ? &nothing : NULL, &got, &err);
            CHECK(ok, "%s", err.msg);
            for (uint32_t i = 0, value; ok && i < WIDTH * HEIGHT; i++) {
                memcpy(&value, got[i], sizeof value);
                if (value != element(i)) {
                    CHECK(false, "pixel %u is %x, expected %x", i, value, element(i));
                    break;
                }
            }
            CHECK(stage.screen.draw_ms > 0 || !stage.gpu.has_timestamps);
        }
    } else {
        CHECK(false, "%s", err.msg);
    }
    stage_finish(&stage);
}

#define TRIANGLES 12u

// Positions are multiples of a sixteenth of a pixel, which devices represent exactly, because
// subPixelPrecisionBits is at least 4.
static void vertices_fill(struct gpu_vertex *vertices, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        uint32_t h = element(i + 77), g = element(i + 991);
        vertices[i] = (struct gpu_vertex){
            .position = {(float)((h >> 8 & 1023) % (WIDTH * 16 + 160)) / 16 - 5,
                         (float)((h >> 18 & 1023) % (HEIGHT * 16 + 160)) / 16 - 5},
            .uv = {(float)(g >> 8 & 255) / 255, (float)(g >> 16 & 255) / 255},
            .color = (g ^ h << 7) | 0x40000000u,
        };
    }
}

// Every draw begins at another place of both arrays and has a clipping rectangle of its own. Some
// of these extend beyond the image or have no area.
TEST(triangles_are_drawn_as_on_the_cpu)
{
    static const float clips[][4] = {
        {0, 0, WIDTH, HEIGHT},         {10, 5, 40, 30},   {-20, -30, 33, 17},
        {30, 20, 4000, 1e30f},         {50, 10, 20, 30},  {-50, -50, -10, -10},
        {WIDTH + 5, 0, WIDTH + 9, 10}, {7, 7, 7, 40},     {0, 40, WIDTH, HEIGHT},
        {-INFINITY, 3, INFINITY, 4},   {NAN, 0, NAN, 43}, {5, 8, 22, HEIGHT},
    };
    static struct picture expected;
    struct gpu_vertex vertices[TRIANGLES * 3 + 5];
    uint16_t indices[TRIANGLES * 3 + 7] = {0};
    struct gpu_draw draws[TRIANGLES];
    vertices_fill(vertices, TRIANGLES * 3 + 5);
    for (uint32_t i = 0; i < TRIANGLES; i++) {
        draws[i] = (struct gpu_draw){.index_count = 3, .first_index = 7 + 3 * i};
        draws[i].first_vertex = i < 4 ? 0 : 3 * i + 1;
        memcpy(draws[i].clip, clips[i], sizeof clips[i]);
        for (uint32_t corner = 0; corner < 3; corner++)
            indices[7 + 3 * i + corner] = (uint16_t)((i < 4 ? 3 * i : 1) + corner);
    }
    const struct gpu_drawing drawing = {vertices,          indices,           draws,
                                        TRIANGLES * 3 + 5, TRIANGLES * 3 + 7, TRIANGLES};
    struct stage stage = {0};
    struct err err = {0};
    OPEN_GRAPHICS(&stage.gpu, .validation = true);
    uint8_t(*got)[4] = NULL;
    if (stage_create(&stage, &err) && stage_draw(&stage, &drawing, &got, &err)) {
        draw_on_cpu(&drawing, stage.coverage, &expected);
        compare(&expected, got, "random triangles");
    } else {
        CHECK(false, "%s", err.msg);
    }
    stage_finish(&stage);
}

// As in panels, boxes are at whole pixels and texels of the atlas map to pixels, so the result is
// exact.
TEST(texels_of_the_atlas_are_exact)
{
    const struct gpu_vertex vertices[] = {
        {{8, 4}, {0, 0}, 0xff102030u},
        {{8 + ATLAS, 4}, {1, 0}, 0xff102030u},
        {{8 + ATLAS, 4 + ATLAS}, {1, 1}, 0xff102030u},
        {{8, 4 + ATLAS}, {0, 1}, 0xff102030u},
    };
    const uint16_t indices[] = {0, 1, 2, 0, 2, 3};
    const struct gpu_draw draw = {6, 0, 0, {0, 0, WIDTH, HEIGHT}};
    const struct gpu_drawing drawing = {vertices, indices, &draw, 4, 6, 1};
    const uint8_t color[4] = {0x30, 0x20, 0x10, 0xff};
    struct stage stage = {0};
    struct err err = {0};
    OPEN_GRAPHICS(&stage.gpu, .validation = true);
    uint8_t(*got)[4] = NULL;
    bool ok = stage_create(&stage, &err) && stage_draw(&stage, &drawing, &got, &err);
    CHECK(ok, "%s", err.msg);
    for (uint32_t i = 0; ok && i < WIDTH * HEIGHT; i++) {
        uint32_t x = i % WIDTH - 8, y = i / WIDTH - 4; // wraps around outside the box
        double alpha = x < ATLAS && y < ATLAS ? stage.coverage[y * ATLAS + x] / 255.0 : 0;
        for (int c = 0; c < 3; c++) {
            double expected = (element(i) >> 8 * c & 255) * (1 - alpha) + color[c] * alpha;
            if (fabs(got[i][c] - expected) > 1) {
                CHECK(false, "pixel %u, channel %d: %u, expected %.2f", i, c, got[i][c], expected);
                ok = false;
            }
        }
    }
    stage_finish(&stage);
}

// Panels have more and more triangles. The last triangle is visible, and the buffers have at most
// twice the required size.
TEST(panels_grow)
{
    const uint32_t most = 65535 / 3 * 3;
    struct gpu_vertex *vertices = calloc(most, sizeof *vertices);
    uint16_t *indices = calloc(most, sizeof *indices);
    struct stage stage = {0};
    struct err err = {0};
    OPEN_GRAPHICS(&stage.gpu, .validation = true);
    bool ok = vertices && indices && stage_create(&stage, &err);
    const uint32_t counts[] = {3, 30, 33, 3000, 300, 60000, most, 3};
    for (uint32_t i = 0; ok && i < sizeof counts / sizeof counts[0]; i++) {
        // Only the last triangle has an area.
        uint32_t count = counts[i];
        for (uint32_t v = 0; v < count; v++) {
            vertices[v] = (struct gpu_vertex){.color = 0xff0000ffu + (i << 16)};
            indices[v] = (uint16_t)v;
        }
        vertices[count - 2].position[0] = vertices[count - 1].position[1] = 2000;
        const struct gpu_draw draw = {count, 0, 0, {0, 0, WIDTH, HEIGHT}};
        const struct gpu_drawing drawing = {vertices, indices, &draw, count, count, 1};
        uint8_t(*got)[4] = NULL;
        ok = stage_draw(&stage, &drawing, &got, &err);
        const uint8_t expected[4] = {255, 0, (uint8_t)i, 255};
        CHECK(ok && memcmp(got[WIDTH * HEIGHT - 1], expected, 4) == 0,
              "%u vertices: %02x %02x %02x", count, ok ? got[WIDTH * HEIGHT - 1][0] : 0,
              ok ? got[WIDTH * HEIGHT - 1][1] : 0, ok ? got[WIDTH * HEIGHT - 1][2] : 0);
    }
    CHECK(ok, "%s", err.msg);
    CHECK(stage.screen.vertices.bytes <= 2 * (uint64_t)most * sizeof *vertices, "%llu bytes",
          (unsigned long long)stage.screen.vertices.bytes);
    stage_finish(&stage);
    free(vertices);
    free(indices);
}

static double resident_megabytes(void)
{
    long all = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file && fscanf(file, "%ld %ld", &all, &resident) != 2)
        resident = 0;
    if (file)
        fclose(file);
    return (double)resident * (double)sysconf(_SC_PAGESIZE) / 1048576;
}

#define RESIZES 500u

// Validation is off, because the layers keep records that take memory themselves.
TEST(resizing_leaks_nothing)
{
    struct stage stage = {0};
    struct err err = {0};
    OPEN_GRAPHICS(&stage.gpu, .validation = false);
    bool ok = stage_create(&stage, &err);
    uint64_t bytes = 0;
    double megabytes = 0;
    for (uint32_t i = 0; ok && i <= RESIZES; i++) {
        uint8_t(*got)[4] = NULL;
        uint32_t width = 1 + element(i % 50) % 300, height = 1 + element(i % 50 + 50) % 200;
        ok = stage_resize(&stage, width, height, &err) && stage_draw(&stage, NULL, &got, &err) &&
             memcmp(got[width * height - 1], &(uint32_t){element(width * height - 1)}, 4) == 0;
        arena_finish(&stage.arena);
        if (i == 50) { // all sizes have occurred once
            bytes = stage.gpu.allocated_bytes;
            megabytes = resident_megabytes();
        }
        CHECK(i % 50 || i == 0 || stage.gpu.allocated_bytes == bytes, "%llu bytes, expected %llu",
              (unsigned long long)stage.gpu.allocated_bytes, (unsigned long long)bytes);
    }
    CHECK(ok, "%s", err.msg);
    // 450 leaked images of these sizes would take 50 MB.
    double grown = resident_megabytes() - megabytes;
    CHECK(grown < 8, "%.1f megabytes more after %u resizes", grown, RESIZES - 50);
    stage_finish(&stage);
}

TEST(resizing_is_silent)
{
    struct stage stage = {0};
    struct err err = {0};
    OPEN_GRAPHICS(&stage.gpu, .validation = true);
    bool ok = stage_create(&stage, &err);
    for (uint32_t i = 0; ok && i < 20; i++) {
        uint8_t(*got)[4] = NULL;
        ok = stage_resize(&stage, 1 + element(i) % 300, 1 + element(i + 50) % 200, &err) &&
             stage_draw(&stage, NULL, &got, &err);
    }
    CHECK(ok, "%s", err.msg);
    stage_finish(&stage);
}

// Some drivers delay timestamps after something was drawn.
TEST(timestamps_after_drawing_are_those_of_what_is_before_them)
{
    struct stage stage = {0};
    struct gpu *gpu = &stage.gpu;
    struct gpu_commands commands = {0};
    struct gpu_buffer buffer = {0};
    struct err err = {0};
    OPEN_GRAPHICS(gpu);
    bool ok = stage_create(&stage, &err) &&
              gpu_screen_draw(gpu, &stage.screen, &stage.pixels, NULL, &err) &&
              gpu_commands_create(gpu, &commands, &err) &&
              gpu_buffer_create(gpu, "filled", 64u << 20, GPU_DEVICE, false, &buffer, &err) &&
              gpu_begin(gpu, &commands, &err);
    REQUIRE(ok, "%s", err.msg);
    const uint64_t bytes[] = {16, buffer.bytes, 16};
    gpu_timestamp(gpu, &commands);
    for (uint32_t i = 0; i < 3; i++) {
        gpu_fill(gpu, &commands, &buffer, 0, bytes[i], i);
        gpu_barrier(gpu, &commands);
        gpu_timestamp(gpu, &commands);
    }
    double ns[GPU_MAX_TIMESTAMPS];
    ok = gpu_submit(gpu, &commands, &err);
    if (ok && gpu->has_timestamps) {
        ok = gpu_timestamps_ns(gpu, &commands, ns, &err);
        double most = fmax(ns[1], ns[3] - ns[2]);
        CHECK(ns[2] - ns[1] > most, "64 MiB took %g ns, 16 bytes %g", ns[2] - ns[1], most);
    }
    CHECK(ok, "%s", err.msg);
    gpu_commands_finish(gpu, &commands);
    gpu_buffer_finish(gpu, &buffer);
    stage_finish(&stage);
}

static void check_refused(bool ok, struct err *err, enum err_code code, const char *word)
{
    CHECK(!ok, "not refused: expected \"%s\"", word);
    CHECK(err->code == code && strstr(err->msg, word), "%d: %s", err->code, err->msg);
    *err = (struct err){0};
}

TEST(bad_calls_are_refused)
{
    struct stage stage = {0};
    struct err err = {0};
    OPEN_GRAPHICS(&stage.gpu, .validation = true);
    struct gpu *gpu = &stage.gpu;
    struct gpu_screen *screen = &stage.screen;
    const uint16_t indices[6] = {0};
    const struct gpu_vertex vertex = {0};
    const struct gpu_draw draws[] = {{4, 3, 0, {0}}, {3, 7, 0, {0}}, {3, 0, 1, {0}}};
    uint8_t(*got)[4];
    CHECK(stage_create(&stage, &err), "%s", err.msg);
    check_refused(gpu_screen_read(gpu, screen, &stage.arena, &got, &err), &err, ERR_BUG,
                  "nothing was drawn");
    for (int i = 0; i < 3; i++) {
        const struct gpu_drawing drawing = {&vertex, indices, &draws[i], 1, 6, 1};
        check_refused(gpu_screen_draw(gpu, screen, &stage.pixels, &drawing, &err), &err, ERR_BUG,
                      "draw 0");
    }
    check_refused(gpu_screen_resize(gpu, screen, 0, 5, &err), &err, ERR_GPU, "0 x 5");
    check_refused(gpu_screen_resize(gpu, screen, 5, 1u << 30, &err), &err, ERR_GPU, "from 1 to");
    CHECK(screen->width == WIDTH && screen->height == HEIGHT);
    CHECK(gpu_screen_resize(gpu, screen, WIDTH, HEIGHT + 1, &err), "%s", err.msg);
    check_refused(gpu_screen_draw(gpu, screen, &stage.pixels, NULL, &err), &err, ERR_BUG,
                  "from a buffer");
    stage_finish(&stage);

    struct gpu other;
    const struct gpu_atlas atlas = {stage.coverage, ATLAS, ATLAS};
    OPEN_GPU(&other, .validation = true);
    check_refused(gpu_screen_create(&other, &atlas, screen, &err), &err, ERR_BUG, "graphics");
    gpu_screen_finish(&other, screen);
    gpu_close(&other);
}

// Each allocation fails once, and the device is lost at each submission. The error is reported, and
// all objects are destroyed.
TEST(failures_leave_nothing)
{
    const struct gpu_draw draw = {0};
    const struct gpu_drawing drawing = {NULL, NULL, &draw, 0, 0, 1};
    for (uint32_t n = 1, failures = 1; failures; n++) {
        failures = 0;
        for (int loses = 0; loses < 2; loses++) {
            struct stage stage = {0};
            struct err err = {0};
            uint8_t(*got)[4];
            OPEN_GRAPHICS(&stage.gpu, .validation = true, .fail_allocation = loses ? 0 : n,
                          .lose_device_at_submit = loses ? n : 0);
            bool ok = stage_create(&stage, &err) && stage_draw(&stage, &drawing, &got, &err);
            CHECK(ok || (err.code == ERR_GPU && stage.gpu.lost == loses), "%s", err.msg);
            failures += !ok;
            stage_finish(&stage);
        }
        REQUIRE(n < 100, "it fails for ever");
    }
}

TEST_MAIN(TEST_CASE(pictures_are_copied), TEST_CASE(triangles_are_drawn_as_on_the_cpu),
          TEST_CASE(texels_of_the_atlas_are_exact), TEST_CASE(panels_grow),
          TEST_CASE(resizing_leaks_nothing), TEST_CASE(resizing_is_silent),
          TEST_CASE(timestamps_after_drawing_are_those_of_what_is_before_them),
          TEST_CASE(bad_calls_are_refused), TEST_CASE(failures_leave_nothing))
