// Tests the panel's drawing without a device: its triangles, for windows of any size and any
// numbers.
#include "gui_bench.h"

static void check_drawing(const struct gpu_drawing *drawing)
{
    CHECK(drawing->draw_count > 0, "nothing is drawn");
    for (uint32_t i = 0; i < drawing->vertex_count; i++) {
        const float *at = drawing->vertices[i].position;
        CHECK(isfinite(at[0]) && isfinite(at[1]), "vertex %u: %g, %g", i, (double)at[0],
              (double)at[1]);
    }
    for (uint32_t i = 0; i < drawing->draw_count; i++) {
        const struct gpu_draw *draw = &drawing->draws[i];
        CHECK(draw->first_index + draw->index_count <= drawing->index_count, "draw %u", i);
        CHECK(draw->clip[0] >= 0 && draw->clip[1] >= 0 && draw->clip[2] <= (float)BENCH_WIDTH &&
                  draw->clip[3] <= (float)BENCH_HEIGHT && draw->clip[0] < draw->clip[2] &&
                  draw->clip[1] < draw->clip[3],
              "draw %u: clip %g, %g, %g, %g", i, (double)draw->clip[0], (double)draw->clip[1],
              (double)draw->clip[2], (double)draw->clip[3]);
        for (uint32_t k = 0; k < draw->index_count; k++) {
            uint32_t vertex = draw->first_vertex + drawing->indices[draw->first_index + k];
            CHECK(vertex < drawing->vertex_count, "draw %u: vertex %u", i, vertex);
        }
    }
}

TEST(triangles_are_in_range_and_in_the_window)
{
    const float scales[] = {1, 1.5f, 2};
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        struct bench *bench = bench_new(scales[i]);
        struct gpu_atlas atlas;
        gui_atlas(&bench->gui, &atlas);
        CHECK(atlas.coverage && atlas.width && atlas.height, "letters");
        bench->rows = 100;
        bench_frame(bench);
        CHECK_SET(bench, "list", "open");
        gui_reveal(&bench->gui, "kinds.choice");
        bench_frames(bench, 2);
        bench_click(bench, "kinds.choice");
        check_drawing(&bench->drawing);
        CHECK(bench->gui.width <= 0.4f * (float)BENCH_WIDTH, "%g pixels wide",
              (double)bench->gui.width);
        bench_free(bench);
    }
}

TEST(windows_may_be_of_any_size)
{
    const uint32_t sizes[] = {1, 2, 7, 20, 50, 16384};
    struct bench *bench = bench_new(2);
    bench->rows = 100;
    bench_frame(bench);
    CHECK_SET(bench, "list", "open");
    for (size_t x = 0; x < sizeof sizes / sizeof *sizes; x++)
        for (size_t y = 0; y < sizeof sizes / sizeof *sizes; y++) {
            bench->width = sizes[x];
            bench->height = sizes[y];
            bench_frames(bench, 2);
            CHECK(bench->gui.width <= 0.4f * (float)sizes[x], "%g of %u pixels",
                  (double)bench->gui.width, sizes[x]);
            CHECK_SET(bench, "kinds.number", x % 2 ? "0.5" : "0.25");
        }
    bench->width = bench->height = 0;
    bench_frames(bench, 2);
    check_drawing(&bench->drawing);
    bench_free(bench);
}

static void draw_charts(struct bench *bench, uint32_t count, const struct gui_curve *curves)
{
    const struct gui_bar bars[] = {{"one", 0}, {"two", 1e-9}, {"three", 1e9}};
    gui_begin(&bench->gui, BENCH_WIDTH, BENCH_HEIGHT, 1.0 / 60.0);
    gui_panel_begin(&bench->gui, "Test", "", NULL);
    gui_bars(&bench->gui, bars, 3, "ms");
    gui_bars(&bench->gui, bars, 1, "ms");
    gui_curves(&bench->gui, curves, count, "seconds", "relMSE");
    gui_panel_end(&bench->gui);
    gui_progress(&bench->gui, "Building", 0.5);
    const uint32_t colors[] = {0xff000000u, 0xffffffffu};
    gui_legend(&bench->gui, colors, 2, (const char *const[3]){"0", "1", "2 m"});
    const struct gui_pair rows[] = {{"F1", "the panel"}, {"A long key", "and what it does"}};
    gui_table(&bench->gui, rows, 2);
    gui_note(&bench->gui, 700, 580, true, "A text that is longer than there is room for %d", 1);
    gui_end(&bench->gui, &bench->drawing);
    check_drawing(&bench->drawing);
}

TEST(charts_take_any_numbers)
{
    struct bench *bench = bench_new(1);
    const double x[] = {NAN, 0, 1e-3, 1, 1e3, INFINITY, 1e9}, y[] = {1, 1, 1e30, NAN, 1e-30, 1, -1};
    const double low[] = {1, 1, 1e20, 1, 0, 1, 1}, high[] = {1, 1, 1e31, 1, 1, 1, 1};
    const struct gui_curve curves[] = {
        {.label = "A", .x = x, .y = y, .low = low, .high = high, .count = 7},
        {.label = "B", .x = x + 2, .y = y + 2, .count = 1},
    };
    draw_charts(bench, 0, NULL);
    draw_charts(bench, 1, curves + 1);
    draw_charts(bench, 2, curves);
    bench_free(bench);
}

// A bound is drawn where there is no value.
TEST(charts_show_bounds)
{
    struct bench *bench = bench_new(1);
    const double x[] = {1, 2}, y[] = {NAN, 0.1}, most[] = {0.3, 0.2}, none[] = {INFINITY, INFINITY};
    struct gui_curve curves[] = {{.label = "A", .x = x, .y = y, .most = most, .count = 1},
                                 {.label = "A", .x = x, .y = y, .most = none, .count = 1}};
    uint32_t vertices[4];
    for (int i = 0; i < 4; i++) {
        struct gui_curve curve = curves[i % 2];
        curve.x += i / 2; // the second point has a value
        curve.y += i / 2;
        curve.most += i / 2;
        draw_charts(bench, 1, &curve);
        vertices[i] = bench->drawing.vertex_count;
    }
    CHECK(vertices[0] > vertices[1], "%u and %u", vertices[0], vertices[1]);
    CHECK(vertices[2] == vertices[3], "%u and %u", vertices[2], vertices[3]);
    bench_free(bench);
}

// The height of a note must be that of its lines, because the next one is drawn below.
TEST(notes_are_as_high_as_their_lines)
{
    struct bench *bench = bench_new(1);
    gui_begin(&bench->gui, BENCH_WIDTH, BENCH_HEIGHT, 1.0 / 60.0);
    float one = gui_note(&bench->gui, 10, 20, false, "one line");
    float four = gui_note(&bench->gui, 10, 20 + one, true, "%s", "one\ntwo\nthree\nfour");
    gui_end(&bench->gui, &bench->drawing);
    float lowest = 0;
    for (uint32_t i = 0; i < bench->drawing.vertex_count; i++)
        lowest = fmaxf(lowest, bench->drawing.vertices[i].position[1]);
    CHECK(one >= 13 && four >= 4 * 13, "%g and %g pixels", (double)one, (double)four);
    CHECK(fabsf(lowest - (20 + one + four)) < 1, "%g, not %g", (double)lowest,
          (double)(20 + one + four));
    bench_free(bench);
}

TEST_MAIN(TEST_CASE(triangles_are_in_range_and_in_the_window),
          TEST_CASE(windows_may_be_of_any_size), TEST_CASE(charts_take_any_numbers),
          TEST_CASE(charts_show_bounds), TEST_CASE(notes_are_as_high_as_their_lines))
