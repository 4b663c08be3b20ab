// The panel's widgets without a device: scripts, made-up events, and what comes out.
#include "test.h"
#include "viewer/gui/gui_state.h"

#include <GLFW/glfw3.h>
#include <float.h>
#include <stdarg.h>

#define WIDTH 800u
#define HEIGHT 600u

// One control of each kind; what the panel of the program does with its own.
struct values {
    bool on;
    double number;
    float real;
    uint32_t count, choice, presses, chosen;
    float color[3];
    double vector[3];
    char text[64];
    uint32_t changes; // controls that returned true
};

struct bench {
    struct gui gui;
    struct values values;
    struct gpu_drawing drawing;
    bool disabled;    // the number is
    bool has_twice;   // an id twice
    uint32_t fillers; // lines above the last group
    uint32_t rows, row_calls;
    uint32_t width, height; // of the window; 0: WIDTH and HEIGHT
};

static const char *const words[] = {"alpha", "beta", "gamma", NULL};
static const struct gui_range unit_range = {0, 1};
static const struct gui_range metres = {0, 1e9, .logarithmic = true, .unit = "m", .least = "none"};
static const struct gui_range counts = {0,
                                        4294967295.0,
                                        .logarithmic = true,
                                        .integer = true,
                                        .infinite = "all",
                                        .greatest = 4294967294.0,
                                        .file_word = "off"};
static const struct gui_range wide = {-1e18, 1e18};

static struct bench *bench_new(float scale)
{
    struct bench *bench = calloc(1, sizeof *bench);
    struct err err = {0};
    if (!bench || !gui_create(scale, &bench->gui, &err)) {
        fprintf(stderr, "%s\n", err.msg);
        exit(1);
    }
    bench->values.number = 0.25;
    bench->values.real = 0.1f;
    bench->values.chosen = UINT32_MAX;
    return bench;
}

static void bench_free(struct bench *bench)
{
    gui_finish(&bench->gui);
    free(bench);
}

static void used(struct bench *bench, bool changed)
{
    bench->values.changes += changed;
}

static void draw_kinds(struct bench *bench)
{
    struct gui *gui = &bench->gui;
    struct values *v = &bench->values;
    gui_group_begin(gui, "kinds", "Kinds", "One of each.", true);
    used(bench, gui_switch(gui, "kinds.switch", "Switch", "On or off.", &v->on));
    gui_enabled(gui, !bench->disabled);
    used(bench, gui_number(gui, "kinds.number", "Number", "A part.", &unit_range, &v->number));
    gui_enabled(gui, true);
    used(bench, gui_float(gui, "kinds.float", "Float", "Metres.", &metres, &v->real));
    used(bench, gui_count(gui, "kinds.count", "Count", "Whole.", &counts, &v->count));
    used(bench, gui_choice(gui, "kinds.choice", "Choice", "A word.", words, &v->choice));
    used(bench, gui_color(gui, "kinds.color", "Colour", "Linear.", &unit_range, v->color));
    used(bench, gui_vector(gui, "kinds.vector", "Vector", "Metres.", &wide, v->vector));
    used(bench, gui_text(gui, "kinds.text", "Text", "Any.", v->text, sizeof v->text));
    if (gui_button(gui, "kinds.button", "Button", "Counts."))
        v->presses++;
    if (gui_row(gui, "kinds.row", "Row", "A row.", v->chosen == 7))
        v->chosen = 7;
    if (bench->has_twice)
        gui_button(gui, "kinds.button", "Again", "A mistake.");
    gui_group_end(gui);
}

static void draw_list(struct bench *bench)
{
    struct gui *gui = &bench->gui;
    struct gui_list list = {.count = bench->rows, .chosen = bench->values.chosen, .height = 5};
    bench->row_calls = 0;
    gui_group_begin(gui, "list", "List", "Many rows.", false);
    gui_list_begin(gui, "rows", &list);
    for (uint32_t row; gui_list_next(gui, &list, &row);) {
        char id[32];
        snprintf(id, sizeof id, "rows.%u", row);
        bench->row_calls++;
        if (gui_row(gui, id, id, "A row.", row == bench->values.chosen))
            bench->values.chosen = row;
    }
    gui_list_end(gui, &list);
    gui_group_end(gui);
}

static void frame(struct bench *bench)
{
    struct gui *gui = &bench->gui;
    gui_begin(gui, bench->width ? bench->width : WIDTH, bench->height ? bench->height : HEIGHT,
              1.0 / 60.0);
    gui_panel_begin(gui, "Test", "");
    draw_kinds(bench);
    for (uint32_t i = 0; i < bench->fillers; i++)
        gui_line(gui, "line %u", i);
    draw_list(bench);
    gui_group_begin(gui, "outer", "Outer", "Closed at first.", false);
    gui_group_begin(gui, "inner", "Inner", "Closed, too.", false);
    bool on = bench->values.choice == 2;
    if (gui_switch(gui, "inner.switch", "Deep", "In two groups.", &on))
        bench->values.choice = on ? 2 : 0;
    gui_group_end(gui);
    gui_group_end(gui);
    gui_panel_end(gui);
    gui_end(gui, &bench->drawing);
}

static void frames(struct bench *bench, int count)
{
    while (count-- > 0)
        frame(bench);
}

// --- what users do -------------------------------------------------------------------------------

static void move(struct bench *bench, double x, double y)
{
    gui_event(&bench->gui, &(struct event){.kind = EVENT_MOVE, .x = x, .y = y});
}

static void button(struct bench *bench, bool down, uint32_t modifiers)
{
    gui_event(&bench->gui,
              &(struct event){.kind = EVENT_BUTTON, .down = down, .modifiers = modifiers});
}

static void key(struct bench *bench, int code)
{
    gui_event(&bench->gui, &(struct event){.kind = EVENT_KEY, .code = code, .down = true});
    gui_event(&bench->gui, &(struct event){.kind = EVENT_KEY, .code = code});
}

static void type(struct bench *bench, const char *text)
{
    for (; *text; text++)
        gui_event(&bench->gui, &(struct event){.kind = EVENT_TEXT, .code = *text});
}

// Part of the control's width, where the mouse goes.
static bool point(struct bench *bench, const char *id, double part, double *x, double *y)
{
    const struct gui_item *item = gui_find(&bench->gui, id);
    CHECK(item && item->is_shown, "%s is not shown", id);
    if (!item || !item->is_shown)
        return false;
    *x = (double)item->rect[0] + part * (double)(item->rect[2] - item->rect[0]);
    *y = 0.5 * (double)(item->rect[1] + item->rect[3]);
    return true;
}

// All at once, as it comes when frames take long: the panel must not lose a click between frames.
static void click_with(struct bench *bench, const char *id, uint32_t modifiers)
{
    double x, y;
    if (!point(bench, id, 0.5, &x, &y))
        return;
    move(bench, x, y);
    button(bench, true, modifiers);
    button(bench, false, modifiers);
    frames(bench, 4);
}

static void click(struct bench *bench, const char *id)
{
    click_with(bench, id, 0);
}

static void drag(struct bench *bench, const char *id, double part, double pixels)
{
    double x, y;
    if (!point(bench, id, part, &x, &y))
        return;
    move(bench, x, y);
    button(bench, true, 0);
    move(bench, x + pixels, y);
    button(bench, false, 0);
    frames(bench, 5);
}

static const char *set(struct bench *bench, const char *id, const char *value)
{
    gui_set(&bench->gui, id, value);
    frame(bench);
    return gui_set_result(&bench->gui);
}

static const char *value_of(const struct bench *bench, const char *id)
{
    const struct gui_item *item = gui_find(&bench->gui, id);
    return item ? item->value : "(no such control)";
}

#define CHECK_VALUE(bench, id, expected)                                                           \
    CHECK(strcmp(value_of(bench, id), expected) == 0, "%s is \"%s\", expected \"%s\"", id,         \
          value_of(bench, id), expected)
#define CHECK_SET(bench, id, value)                                                                \
    do {                                                                                           \
        const char *why = set(bench, id, value);                                                   \
        CHECK(!why, "%s to %s: %s", id, value, why);                                               \
    } while (0)
#define CHECK_REFUSED(bench, id, value, expected)                                                  \
    do {                                                                                           \
        const char *why = set(bench, id, value);                                                   \
        CHECK(why &&strstr(why, expected), "%s to %s: \"%s\", expected \"%s\"", id, value,         \
              why ? why : "done", expected);                                                       \
    } while (0)

// --- scripts -------------------------------------------------------------------------------------

static void set_all(struct bench *bench)
{
    struct values *v = &bench->values;
    CHECK_SET(bench, "kinds.switch", "on");
    CHECK_SET(bench, "kinds.number", "0.75");
    CHECK_SET(bench, "kinds.float", "2.5 m");
    CHECK_SET(bench, "kinds.count", "12");
    CHECK_SET(bench, "kinds.choice", "beta");
    CHECK_SET(bench, "kinds.color", "0.1, 0.2,0.3");
    CHECK_SET(bench, "kinds.vector", "-1,2,1e6");
    CHECK_SET(bench, "kinds.text", "some text");
    CHECK_SET(bench, "kinds.button", "");
    CHECK_SET(bench, "kinds.row", "on");
    CHECK(v->on && v->number == 0.75 && v->real == 2.5f && v->count == 12 && v->choice == 1,
          "%d %g %g %u %u", v->on, v->number, (double)v->real, v->count, v->choice);
    CHECK(v->color[0] == 0.1f && v->color[1] == 0.2f && v->color[2] == 0.3f, "%g",
          (double)v->color[0]);
    CHECK(v->vector[0] == -1 && v->vector[1] == 2 && v->vector[2] == 1e6, "%g", v->vector[2]);
    CHECK(strcmp(v->text, "some text") == 0 && v->presses == 1 && v->chosen == 7, "%s %u", v->text,
          v->presses);
    CHECK_VALUE(bench, "kinds.switch", "on");
    CHECK_VALUE(bench, "kinds.number", "0.75");
    CHECK_VALUE(bench, "kinds.color", "0.1,0.2,0.3");
    CHECK_VALUE(bench, "kinds.vector", "-1,2,1000000");
    CHECK_VALUE(bench, "kinds.choice", "beta");
    CHECK(v->changes == 8, "%u controls told of a change", v->changes);
}

TEST(scripts_set_every_kind)
{
    struct bench *bench = bench_new(1);
    frame(bench);
    set_all(bench);
    bench_free(bench);
}

TEST(scripts_reach_closed_groups)
{
    struct bench *bench = bench_new(1);
    frame(bench);
    CHECK_SET(bench, "kinds", "closed");
    CHECK_VALUE(bench, "kinds", "closed");
    frame(bench);
    CHECK(!gui_find(&bench->gui, "kinds.number")->is_shown, "in a closed group");
    set_all(bench);
    CHECK_SET(bench, "inner.switch", "on");
    CHECK(bench->values.choice == 2, "%u", bench->values.choice);
    bench_free(bench);
}

TEST(scripts_reach_a_hidden_panel)
{
    struct bench *bench = bench_new(1);
    bench->gui.is_hidden = true;
    frame(bench);
    CHECK(bench->gui.width == 0, "%g", (double)bench->gui.width);
    CHECK(bench->drawing.draw_count == 0, "%u draws", bench->drawing.draw_count);
    CHECK(gui_find(&bench->gui, "inner.switch"), "a control in two groups");
    set_all(bench);
    bench_free(bench);
}

TEST(what_cannot_be_is_refused)
{
    struct bench *bench = bench_new(1);
    frame(bench);
    CHECK_REFUSED(bench, "kinds.number", "1.7", "kinds.number: 1.7 is outside [0, 1]");
    CHECK_REFUSED(bench, "kinds.number", "nan", "is no number");
    CHECK_REFUSED(bench, "kinds.number", "0.5 apples", "more than a number");
    CHECK_REFUSED(bench, "kinds.count", "1.5", "no whole number");
    CHECK_REFUSED(bench, "kinds.count", "-1", "is outside [0, 4294967294], and not \"all\"");
    CHECK_REFUSED(bench, "kinds.float", "red", "is no number");
    CHECK_REFUSED(bench, "kinds.switch", "yes", "neither \"on\" nor \"off\"");
    CHECK_REFUSED(bench, "kinds.choice", "delta", "there are alpha, beta, gamma");
    CHECK_REFUSED(bench, "kinds.color", "0.5,0.5", "three numbers");
    CHECK_REFUSED(bench, "kinds.color", "0.5,0.5,0.5,0.5", "three numbers");
    CHECK_REFUSED(bench, "kinds.color", "0.5,2,0.5", "2 is outside [0, 1]");
    CHECK_REFUSED(bench, "kinds", "ajar", "neither \"open\" nor \"closed\"");
    CHECK_REFUSED(bench, "kinds.numbr", "1", "no control kinds.numbr; did you mean kinds.number?");
    CHECK_REFUSED(bench, "elsewhere", "1", "no control elsewhere");
    CHECK_REFUSED(bench, "kinds.text",
                  "0123456789012345678901234567890123456789012345678901234567890123456789",
                  "longer than 63 bytes");
    bench->disabled = true;
    CHECK_REFUSED(bench, "kinds.number", "0.5", "kinds.number is disabled");
    CHECK(bench->values.changes == 0 && bench->values.number == 0.25, "%u changes, %g",
          bench->values.changes, bench->values.number);
    bench_free(bench);
}

TEST(several_wishes_in_one_frame)
{
    struct bench *bench = bench_new(1);
    frame(bench);
    gui_set(&bench->gui, "kinds.switch", "on");
    gui_set(&bench->gui, "kinds.number", "3");
    gui_set(&bench->gui, "kinds.count", "all");
    CHECK(gui_set_result(&bench->gui), "before the frame nothing is done");
    frame(bench);
    const char *why = gui_set_result(&bench->gui);
    CHECK(why && strstr(why, "3 is outside"), "%s", why ? why : "done");
    CHECK(bench->values.on && bench->values.count == UINT32_MAX, "the others are done");
    bench_free(bench);
}

// --- values --------------------------------------------------------------------------------------

TEST(texts_read_back_to_the_same_bits)
{
    const struct gui_range all = {-DBL_MAX, DBL_MAX};
    uint64_t state = 1;
    char text[GUI_VALUE_MAX], why[512] = "";
    for (int i = 0; i < 20000; i++) {
        state = state * 6364136223846793005u + 1442695040888963407u; // Knuth's MMIX generator
        union {
            uint64_t bits;
            double value;
        } wide_value = {state ^ state >> 29};
        union {
            uint32_t bits;
            float value;
        } narrow = {(uint32_t)(state >> 32)};
        double back = 0;
        if (isfinite(wide_value.value)) {
            value_write(&wide_value.value, 1, false, &all, text);
            CHECK(value_read(text, 1, false, &all, &back, why) && back == wide_value.value,
                  "%s: %s", text, why);
        }
        if (isfinite(narrow.value)) {
            value_write(&(double){(double)narrow.value}, 1, true, &all, text);
            CHECK(value_read(text, 1, true, &all, &back, why) && (float)back == narrow.value, "%s",
                  text);
        }
    }
    value_write(&(double){(double)0.1f}, 1, true, &unit_range, text);
    CHECK(strcmp(text, "0.1") == 0, "%s", text);
    value_write(&(double){12000}, 1, false, &all, text);
    CHECK(strcmp(text, "12000") == 0, "%s", text);
}

// Bounds are those that files and options have: a number is compared before it is rounded.
TEST(bounds_belong_to_ranges)
{
    static const struct gui_range survival = {0.01, 1};
    char why[GUI_WHY_MAX];
    double value = 0;
    CHECK(value_read("0.01", 1, true, &survival, &value, why) && value == (double)0.01f, "%s", why);
    CHECK(value_read("1", 1, true, &survival, &value, why) && value == 1.0, "%s", why);
    CHECK(!value_read("0.00999", 1, true, &survival, &value, why), "%g", value);
    CHECK(value_read("4294967294", 1, false, &counts, &value, why), "%s", why);
    CHECK(!value_read("4294967295", 1, false, &counts, &value, why), "%g", value);
    CHECK(strstr(why, "[0, 4294967294]"), "%s", why);
}

TEST(words_stand_for_ends_of_ranges)
{
    struct bench *bench = bench_new(1);
    frame(bench);
    CHECK_SET(bench, "kinds.count", "all");
    CHECK(bench->values.count == UINT32_MAX, "%u", bench->values.count);
    CHECK_VALUE(bench, "kinds.count", "all");
    bench->values.count = 3;
    CHECK_SET(bench, "kinds.count", "off"); // as files say it
    CHECK(bench->values.count == UINT32_MAX, "%u", bench->values.count);
    CHECK_VALUE(bench, "kinds.float", "0.1"); // a float's shortest text, not a double's
    CHECK_SET(bench, "kinds.float", "none");
    CHECK(bench->values.real == 0, "%g", (double)bench->values.real);
    CHECK_VALUE(bench, "kinds.float", "none");
    bench_free(bench);
}

TEST(drags_stay_in_their_range)
{
    const struct gui_range ranges[] = {
        unit_range,
        metres,
        counts,
        wide,
        {1, 255, .integer = true},
        {-100, 100, .drag = 10},
        {1e-30, INFINITY, .logarithmic = true, .infinite = "any", .greatest = 3e38},
    };
    const double starts[] = {0, 1e-12, 0.1, 1, 3, 200, 1e6, 4294967295.0, 1e18, INFINITY};
    for (size_t r = 0; r < sizeof ranges / sizeof *ranges; r++)
        for (size_t s = 0; s < sizeof starts / sizeof *starts; s++) {
            const struct gui_range *range = &ranges[r];
            double start = fmin(fmax(starts[s], range->min), range->max), last = range->min;
            CHECK(value_dragged(start, 0, range, false) == start, "a click moves nothing");
            for (double widths = -3; widths <= 3; widths += 0.01) {
                double to = value_dragged(start, widths, range, false);
                CHECK(to >= range->min && to <= range->max, "%g by %g: %g", start, widths, to);
                CHECK(to >= last, "%g by %g: %g after %g", start, widths, to, last);
                CHECK(!range->integer || to == rint(to), "%g by %g: %g", start, widths, to);
                last = to;
            }
        }
}

// --- the mouse -----------------------------------------------------------------------------------

TEST(mouse_reaches_every_kind)
{
    struct bench *bench = bench_new(1);
    struct values *v = &bench->values;
    frames(bench, 2);
    click(bench, "kinds.switch");
    CHECK(v->on, "a click switches");
    click(bench, "kinds.button");
    CHECK(v->presses == 1, "%u presses", v->presses);
    click(bench, "kinds.row");
    CHECK(v->chosen == 7, "%u", v->chosen);
    drag(bench, "kinds.number", 0.5, 60);
    CHECK(v->number > 0.25 && v->number < 1, "%g", v->number);
    drag(bench, "kinds.number", 0.5, 6000);
    CHECK(v->number == 1, "%g", v->number);
    drag(bench, "kinds.float", 0.5, -6000);
    CHECK(v->real == 0, "%g", (double)v->real);
    drag(bench, "kinds.float", 0.5, 50);
    CHECK(v->real > 0, "%g", (double)v->real);
    drag(bench, "kinds.count", 0.5, 80);
    CHECK(v->count > 0, "%u", v->count);
    drag(bench, "kinds.color", 0.5, 40);
    CHECK(v->color[0] == 0 && v->color[1] > 0 && v->color[2] == 0, "%g", (double)v->color[1]);
    drag(bench, "kinds.vector", 0.9, -40);
    CHECK(v->vector[0] == 0 && v->vector[2] < 0, "%g", v->vector[2]);
    click(bench, "kinds.choice");
    click(bench, "kinds.choice=gamma");
    CHECK(v->choice == 2, "%u", v->choice);
    CHECK(!gui_find(&bench->gui, "kinds.choice=gamma"), "the list is closed again");
    click(bench, "kinds");
    CHECK_VALUE(bench, "kinds", "closed");
    click(bench, "kinds");
    CHECK_VALUE(bench, "kinds", "open");
    bench_free(bench);
}

TEST(numbers_and_texts_are_typed)
{
    struct bench *bench = bench_new(1);
    frames(bench, 2);
    click_with(bench, "kinds.number", EVENT_CONTROL);
    CHECK(bench->gui.wants_keys, "typing takes the keys");
    type(bench, "0.5");
    key(bench, GLFW_KEY_ENTER);
    frames(bench, 4);
    CHECK(bench->values.number == 0.5, "%g", bench->values.number);
    CHECK(!bench->gui.wants_keys, "Enter gives the keys back");
    click_with(bench, "kinds.number", EVENT_CONTROL);
    type(bench, "7");
    key(bench, GLFW_KEY_ENTER);
    frames(bench, 4);
    CHECK(bench->values.number == 0.5, "7 is refused, not clipped: %g", bench->values.number);
    CHECK(strstr(bench->gui.own->refusal, "7 is outside [0, 1]"), "%s", bench->gui.own->refusal);
    click_with(bench, "kinds.number", EVENT_CONTROL);
    type(bench, "0.1");
    key(bench, GLFW_KEY_ESCAPE);
    frames(bench, 4);
    CHECK(bench->values.number == 0.5, "Escape leaves it: %g", bench->values.number);
    click(bench, "kinds.text");
    type(bench, "ab");
    key(bench, GLFW_KEY_BACKSPACE);
    type(bench, "c");
    frames(bench, 6);
    CHECK(bench->values.text[0] == '\0', "not before Enter: %s", bench->values.text);
    click(bench, "kinds.switch"); // as good as Enter
    CHECK(strcmp(bench->values.text, "ac") == 0, "%s", bench->values.text);
    bench_free(bench);
}

TEST(disabled_controls_take_no_mouse)
{
    struct bench *bench = bench_new(1);
    bench->disabled = true;
    frames(bench, 2);
    drag(bench, "kinds.number", 0.5, 60);
    click_with(bench, "kinds.number", EVENT_CONTROL);
    type(bench, "0.5");
    key(bench, GLFW_KEY_ENTER);
    frames(bench, 4);
    CHECK(bench->values.number == 0.25, "%g", bench->values.number);
    bench_free(bench);
}

TEST(untouched_values_keep_their_bits)
{
    struct bench *bench = bench_new(1);
    struct values before = bench->values;
    before.number = 0.1 + 0.2;
    before.vector[1] = 1.0 / 3.0;
    before.color[2] = 0.7f;
    bench->values = before;
    frames(bench, 2);
    drag(bench, "kinds.number", 0.5, 1); // a click that trembles
    click_with(bench, "kinds.number", EVENT_CONTROL);
    key(bench, GLFW_KEY_ENTER);
    frames(bench, 4);
    drag(bench, "kinds.vector", 0.1, 50); // another component
    CHECK(bench->values.number == before.number, "%.17g", bench->values.number);
    CHECK(bench->values.vector[1] == before.vector[1], "%.17g", bench->values.vector[1]);
    CHECK(bench->values.color[2] == 0.7f && bench->values.real == 0.1f, "floats changed");
    bench_free(bench);
}

TEST(events_go_where_they_belong)
{
    struct bench *bench = bench_new(1);
    struct gui *gui = &bench->gui;
    frames(bench, 2);
    move(bench, 20, 300);
    CHECK(gui->wants_mouse, "over the panel");
    move(bench, 700, 300);
    CHECK(!gui->wants_mouse, "over the picture");
    button(bench, true, 0);
    CHECK(!gui->wants_mouse, "pressed over the picture");
    move(bench, 20, 300);
    frame(bench);
    CHECK(!gui->wants_mouse, "a drag of the picture that comes over the panel");
    button(bench, false, 0);
    CHECK(!gui->wants_mouse, "and ends there");
    move(bench, 21, 300);
    CHECK(gui->wants_mouse, "afterwards it is the panel's");
    double x, y;
    if (point(bench, "kinds.number", 0.5, &x, &y)) {
        move(bench, x, y);
        button(bench, true, 0);
        frame(bench);
        move(bench, 700, 300);
        frames(bench, 2);
        CHECK(gui->wants_mouse && gui->is_busy, "a drag of the panel that leaves it");
        button(bench, false, 0);
        frames(bench, 2);
        CHECK(!gui->wants_mouse && !gui->is_busy, "over");
    }
    bench_free(bench);
}

static void check_help(const struct bench *bench, const char *id, const char *expected)
{
    const struct gui_item *item = gui_find(&bench->gui, id);
    char help[GUI_HELP_MAX] = "";
    if (item)
        gui_item_help(item, help);
    CHECK(strcmp(help, expected) == 0, "%s: \"%s\", expected \"%s\"", id, help, expected);
}

TEST(help_on_numbers_has_their_range)
{
    struct bench *bench = bench_new(1);
    frames(bench, 2);
    check_help(bench, "kinds.choice", "A word.");
    check_help(bench, "kinds.number", "A part. From 0 to 1.");
    check_help(bench, "kinds.color", "Linear. From 0 to 1.");
    bench_free(bench);
}

TEST(help_of_what_the_mouse_is_over)
{
    struct bench *bench = bench_new(1);
    double x, y;
    frames(bench, 2);
    CHECK(!bench->gui.hovered_help, "nothing is hovered");
    if (point(bench, "kinds.choice", 0.5, &x, &y)) {
        move(bench, x, y);
        frames(bench, 2);
        CHECK(bench->gui.hovered_help && strcmp(bench->gui.hovered_help, "A word.") == 0, "%s",
              bench->gui.hovered_help ? bench->gui.hovered_help : "none");
    }
    bench_free(bench);
}

// --- finding -------------------------------------------------------------------------------------

TEST(reveal_opens_and_scrolls)
{
    struct bench *bench = bench_new(1);
    bench->fillers = 200;
    frames(bench, 2);
    CHECK(!gui_find(&bench->gui, "inner.switch")->is_shown, "closed and far below");
    gui_reveal(&bench->gui, "inner.switch");
    frames(bench, 2);
    click(bench, "inner.switch");
    CHECK(bench->values.choice == 2, "%u", bench->values.choice);
    bench_free(bench);
}

TEST(reveal_scrolls_lists)
{
    struct bench *bench = bench_new(1);
    bench->fillers = 100;
    bench->rows = 1000;
    frames(bench, 2);
    gui_reveal(&bench->gui, "rows.40");
    frames(bench, 3);
    click(bench, "rows.40");
    CHECK(bench->values.chosen == 40, "%u", bench->values.chosen);
    bench_free(bench);
}

TEST(long_lists_cost_what_is_seen_of_them)
{
    struct bench *bench = bench_new(1);
    bench->rows = 1000000;
    bench->values.chosen = 765432;
    frame(bench);
    CHECK_SET(bench, "list", "open");
    frames(bench, 2);
    CHECK(bench->row_calls <= GUI_LIST_IDS + 1 + 8, "%u rows", bench->row_calls);
    CHECK(gui_find(&bench->gui, "rows.63"), "the first ones");
    CHECK(!gui_find(&bench->gui, "rows.64"), "and no others");
    CHECK(gui_find(&bench->gui, "rows.765432"), "but the chosen one");
    gui_reveal(&bench->gui, "rows.765432");
    frames(bench, 3);
    const struct gui_item *item = gui_find(&bench->gui, "rows.765432");
    CHECK(item && item->is_shown, "scrolled to");
    CHECK(gui_find(&bench->gui, "rows.765431"), "and its neighbours are there");
    bench_free(bench);
}

TEST(an_id_twice_is_told)
{
    struct bench *bench = bench_new(1);
    frame(bench);
    CHECK(!gui_duplicate(&bench->gui), "%s", gui_duplicate(&bench->gui));
    bench->has_twice = true;
    frame(bench);
    const char *id = gui_duplicate(&bench->gui);
    CHECK(id && strcmp(id, "kinds.button") == 0, "%s", id ? id : "none");
    bench_free(bench);
}

// --- what is drawn -------------------------------------------------------------------------------

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
        CHECK(draw->clip[0] >= 0 && draw->clip[1] >= 0 && draw->clip[2] <= (float)WIDTH &&
                  draw->clip[3] <= (float)HEIGHT && draw->clip[0] < draw->clip[2] &&
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
        frame(bench);
        CHECK_SET(bench, "list", "open");
        gui_reveal(&bench->gui, "kinds.choice");
        frames(bench, 2);
        click(bench, "kinds.choice");
        check_drawing(&bench->drawing);
        CHECK(bench->gui.width <= 0.4f * (float)WIDTH, "%g pixels wide", (double)bench->gui.width);
        bench_free(bench);
    }
}

TEST(windows_may_be_of_any_size)
{
    const uint32_t sizes[] = {1, 2, 7, 20, 50, 16384};
    struct bench *bench = bench_new(2);
    bench->rows = 100;
    frame(bench);
    CHECK_SET(bench, "list", "open");
    for (size_t x = 0; x < sizeof sizes / sizeof *sizes; x++)
        for (size_t y = 0; y < sizeof sizes / sizeof *sizes; y++) {
            bench->width = sizes[x];
            bench->height = sizes[y];
            frames(bench, 2);
            CHECK(bench->gui.width <= 0.4f * (float)sizes[x], "%g of %u pixels",
                  (double)bench->gui.width, sizes[x]);
            CHECK_SET(bench, "kinds.number", x % 2 ? "0.5" : "0.25");
        }
    bench->width = bench->height = 0;
    frames(bench, 2);
    check_drawing(&bench->drawing);
    bench_free(bench);
}

static void draw_charts(struct bench *bench, uint32_t count, const struct gui_curve *curves)
{
    const struct gui_bar bars[] = {{"one", 0}, {"two", 1e-9}, {"three", 1e9}};
    gui_begin(&bench->gui, WIDTH, HEIGHT, 1.0 / 60.0);
    gui_panel_begin(&bench->gui, "Test", "");
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

// Where there is no value, a bound is drawn; where there is one, none.
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

// So that the next one goes below: the height is that of what is drawn.
TEST(notes_are_as_high_as_their_lines)
{
    struct bench *bench = bench_new(1);
    gui_begin(&bench->gui, WIDTH, HEIGHT, 1.0 / 60.0);
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

TEST_MAIN(TEST_CASE(scripts_set_every_kind), TEST_CASE(scripts_reach_closed_groups),
          TEST_CASE(scripts_reach_a_hidden_panel), TEST_CASE(what_cannot_be_is_refused),
          TEST_CASE(several_wishes_in_one_frame), TEST_CASE(texts_read_back_to_the_same_bits),
          TEST_CASE(bounds_belong_to_ranges), TEST_CASE(words_stand_for_ends_of_ranges),
          TEST_CASE(drags_stay_in_their_range), TEST_CASE(mouse_reaches_every_kind),
          TEST_CASE(numbers_and_texts_are_typed), TEST_CASE(disabled_controls_take_no_mouse),
          TEST_CASE(untouched_values_keep_their_bits), TEST_CASE(events_go_where_they_belong),
          TEST_CASE(help_on_numbers_has_their_range), TEST_CASE(help_of_what_the_mouse_is_over),
          TEST_CASE(reveal_opens_and_scrolls), TEST_CASE(reveal_scrolls_lists),
          TEST_CASE(long_lists_cost_what_is_seen_of_them), TEST_CASE(an_id_twice_is_told),
          TEST_CASE(triangles_are_in_range_and_in_the_window),
          TEST_CASE(windows_may_be_of_any_size), TEST_CASE(charts_take_any_numbers),
          TEST_CASE(charts_show_bounds), TEST_CASE(notes_are_as_high_as_their_lines))
