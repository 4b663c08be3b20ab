// Helpers for the tests of the panel's widgets: a panel with one control of each kind, without a
// device, and a simulated user who moves the mouse and types.
#ifndef LAMPYRIS_TESTS_GUI_BENCH_H
#define LAMPYRIS_TESTS_GUI_BENCH_H

#include "test.h"
#include "viewer/gui/gui_state.h"

#define BENCH_WIDTH 800u
#define BENCH_HEIGHT 600u

// One control of each kind, and its value, as the program's panel has them.
struct values {
    bool on;
    double number;
    float real;
    uint32_t count, choice, presses, chosen;
    float color[3];
    double vector[3];
    char text[64];
    uint32_t changes; // number of calls of controls that returned true
};

struct bench {
    struct gui gui;
    struct values values;
    struct gpu_drawing drawing;
    bool disabled;    // the number is disabled
    bool useless;     // the float does not apply
    bool has_twice;   // an id occurs twice
    bool has_tabs;    // the first two groups are in one tab, the others in another
    uint32_t fillers; // lines above the last group
    uint32_t rows, row_calls;
    uint32_t width, height; // size of the window; 0: BENCH_WIDTH and BENCH_HEIGHT
};

// The ranges of the controls.
extern const struct gui_range bench_unit, bench_metres, bench_counts, bench_wide;

struct bench *bench_new(float scale); // exits the program when out of memory
void bench_free(struct bench *bench);
void bench_frame(struct bench *bench);
void bench_frames(struct bench *bench, int count);

// --- what users do -------------------------------------------------------------------------------

void bench_move(struct bench *bench, double x, double y);
void bench_button(struct bench *bench, bool down, uint32_t modifiers);
void bench_key(struct bench *bench, int code);
void bench_type(struct bench *bench, const char *text);
// Finds the point at this fraction of the control's width. If the control is not visible, records a
// failure and returns false.
bool bench_point(struct bench *bench, const char *id, double part, double *x, double *y);
// Moves the mouse, presses and releases a button between two frames, as happens when frames take
// long: the panel must not lose the click.
void bench_click_with(struct bench *bench, const char *id, uint32_t modifiers);
void bench_click(struct bench *bench, const char *id);
void bench_drag(struct bench *bench, const char *id, double part, double pixels);
// Sets a control as scripts do. Returns why it was refused, or NULL.
const char *bench_set(struct bench *bench, const char *id, const char *value);
const char *bench_value(const struct bench *bench, const char *id);

#define CHECK_VALUE(bench, id, expected)                                                           \
    CHECK(strcmp(bench_value(bench, id), expected) == 0, "%s is \"%s\", expected \"%s\"", id,      \
          bench_value(bench, id), expected)
#define CHECK_SET(bench, id, value)                                                                \
    do {                                                                                           \
        const char *why = bench_set(bench, id, value);                                             \
        CHECK(!why, "%s to %s: %s", id, value, why);                                               \
    } while (0)
#define CHECK_REFUSED(bench, id, value, expected)                                                  \
    do {                                                                                           \
        const char *why = bench_set(bench, id, value);                                             \
        CHECK(why &&strstr(why, expected), "%s to %s: \"%s\", expected \"%s\"", id, value,         \
              why ? why : "done", expected);                                                       \
    } while (0)

#endif
