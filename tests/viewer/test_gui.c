// Tests the panel's widgets without a device: scripts, simulated events, and the resulting values.
#include "gui_bench.h"

#include <GLFW/glfw3.h>
#include <float.h>

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
    bench_frame(bench);
    set_all(bench);
    bench_free(bench);
}

TEST(scripts_reach_closed_groups)
{
    struct bench *bench = bench_new(1);
    bench_frame(bench);
    CHECK_SET(bench, "kinds", "closed");
    CHECK_VALUE(bench, "kinds", "closed");
    bench_frame(bench);
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
    bench_frame(bench);
    CHECK(bench->gui.width == 0, "%g", (double)bench->gui.width);
    CHECK(bench->drawing.draw_count == 0, "%u draws", bench->drawing.draw_count);
    CHECK(gui_find(&bench->gui, "inner.switch"), "a control in two groups");
    set_all(bench);
    bench_free(bench);
}

TEST(what_cannot_be_is_refused)
{
    struct bench *bench = bench_new(1);
    bench_frame(bench);
    CHECK_REFUSED(bench, "kinds.number", "1.7", "kinds.number: 1.7 is outside [0, 1]");
    CHECK_REFUSED(bench, "kinds.number", "nan", "is not a number");
    CHECK_REFUSED(bench, "kinds.number", "0.5 apples", "other text besides a number");
    CHECK_REFUSED(bench, "kinds.count", "1.5", "not a whole number");
    CHECK_REFUSED(bench, "kinds.count", "-1", "is outside [0, 4294967294] and is not \"all\"");
    CHECK_REFUSED(bench, "kinds.float", "red", "is not a number");
    CHECK_REFUSED(bench, "kinds.switch", "yes", "neither \"on\" nor \"off\"");
    CHECK_REFUSED(bench, "kinds.choice", "delta", "the choices are alpha, beta, gamma");
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
    bench_frame(bench);
    gui_set(&bench->gui, "kinds.switch", "on");
    gui_set(&bench->gui, "kinds.number", "3");
    gui_set(&bench->gui, "kinds.count", "all");
    CHECK(gui_set_result(&bench->gui), "before the frame nothing is done");
    bench_frame(bench);
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
    value_write(&(double){(double)0.1f}, 1, true, &bench_unit, text);
    CHECK(strcmp(text, "0.1") == 0, "%s", text);
    value_write(&(double){12000}, 1, false, &all, text);
    CHECK(strcmp(text, "12000") == 0, "%s", text);
}

// Bounds are those of files and options: a number is compared before it is rounded.
TEST(bounds_belong_to_ranges)
{
    static const struct gui_range survival = {0.01, 1};
    char why[GUI_WHY_MAX];
    double value = 0;
    CHECK(value_read("0.01", 1, true, &survival, &value, why) && value == (double)0.01f, "%s", why);
    CHECK(value_read("1", 1, true, &survival, &value, why) && value == 1.0, "%s", why);
    CHECK(!value_read("0.00999", 1, true, &survival, &value, why), "%g", value);
    CHECK(value_read("4294967294", 1, false, &bench_counts, &value, why), "%s", why);
    CHECK(!value_read("4294967295", 1, false, &bench_counts, &value, why), "%g", value);
    CHECK(strstr(why, "[0, 4294967294]"), "%s", why);
}

TEST(words_stand_for_ends_of_ranges)
{
    struct bench *bench = bench_new(1);
    bench_frame(bench);
    CHECK_SET(bench, "kinds.count", "all");
    CHECK(bench->values.count == UINT32_MAX, "%u", bench->values.count);
    CHECK_VALUE(bench, "kinds.count", "all");
    bench->values.count = 3;
    CHECK_SET(bench, "kinds.count", "off"); // the word in files
    CHECK(bench->values.count == UINT32_MAX, "%u", bench->values.count);
    CHECK_VALUE(bench, "kinds.float", "0.1"); // the shortest text of a float, not of a double
    CHECK_SET(bench, "kinds.float", "none");
    CHECK(bench->values.real == 0, "%g", (double)bench->values.real);
    CHECK_VALUE(bench, "kinds.float", "none");
    bench_free(bench);
}

TEST(drags_stay_in_their_range)
{
    const struct gui_range ranges[] = {
        bench_unit,
        bench_metres,
        bench_counts,
        bench_wide,
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
    bench_frames(bench, 2);
    bench_click(bench, "kinds.switch");
    CHECK(v->on, "a click switches");
    bench_click(bench, "kinds.button");
    CHECK(v->presses == 1, "%u presses", v->presses);
    bench_click(bench, "kinds.row");
    CHECK(v->chosen == 7, "%u", v->chosen);
    bench_drag(bench, "kinds.number", 0.5, 60);
    CHECK(v->number > 0.25 && v->number < 1, "%g", v->number);
    bench_drag(bench, "kinds.number", 0.5, 6000);
    CHECK(v->number == 1, "%g", v->number);
    bench_drag(bench, "kinds.float", 0.5, -6000);
    CHECK(v->real == 0, "%g", (double)v->real);
    bench_drag(bench, "kinds.float", 0.5, 50);
    CHECK(v->real > 0, "%g", (double)v->real);
    bench_drag(bench, "kinds.count", 0.5, 80);
    CHECK(v->count > 0, "%u", v->count);
    bench_drag(bench, "kinds.color", 0.5, 40);
    CHECK(v->color[0] == 0 && v->color[1] > 0 && v->color[2] == 0, "%g", (double)v->color[1]);
    bench_drag(bench, "kinds.vector", 0.9, -40);
    CHECK(v->vector[0] == 0 && v->vector[2] < 0, "%g", v->vector[2]);
    bench_click(bench, "kinds.choice");
    bench_click(bench, "kinds.choice=gamma");
    CHECK(v->choice == 2, "%u", v->choice);
    CHECK(!gui_find(&bench->gui, "kinds.choice=gamma"), "the list is closed again");
    bench_click(bench, "kinds");
    CHECK_VALUE(bench, "kinds", "closed");
    bench_click(bench, "kinds");
    CHECK_VALUE(bench, "kinds", "open");
    bench_free(bench);
}

TEST(numbers_and_texts_are_typed)
{
    struct bench *bench = bench_new(1);
    bench_frames(bench, 2);
    bench_click_with(bench, "kinds.number", EVENT_CONTROL);
    CHECK(bench->gui.wants_keys, "typing takes the keys");
    bench_type(bench, "0.5");
    bench_key(bench, GLFW_KEY_ENTER);
    bench_frames(bench, 4);
    CHECK(bench->values.number == 0.5, "%g", bench->values.number);
    CHECK(!bench->gui.wants_keys, "Enter gives the keys back");
    bench_click_with(bench, "kinds.number", EVENT_CONTROL);
    bench_type(bench, "7");
    bench_key(bench, GLFW_KEY_ENTER);
    bench_frames(bench, 4);
    CHECK(bench->values.number == 0.5, "7 is refused, not clipped: %g", bench->values.number);
    CHECK(strstr(bench->gui.own->refusal, "7 is outside [0, 1]"), "%s", bench->gui.own->refusal);
    bench_click_with(bench, "kinds.number", EVENT_CONTROL);
    bench_type(bench, "0.1");
    bench_key(bench, GLFW_KEY_ESCAPE);
    bench_frames(bench, 4);
    CHECK(bench->values.number == 0.5, "Escape leaves it: %g", bench->values.number);
    bench_click(bench, "kinds.text");
    bench_type(bench, "ab");
    bench_key(bench, GLFW_KEY_BACKSPACE);
    bench_type(bench, "c");
    bench_frames(bench, 6);
    CHECK(bench->values.text[0] == '\0', "not before Enter: %s", bench->values.text);
    bench_click(bench, "kinds.switch"); // has the same effect as Enter
    CHECK(strcmp(bench->values.text, "ac") == 0, "%s", bench->values.text);
    bench_free(bench);
}

TEST(disabled_controls_take_no_mouse)
{
    struct bench *bench = bench_new(1);
    bench->disabled = true;
    bench_frames(bench, 2);
    bench_drag(bench, "kinds.number", 0.5, 60);
    bench_click_with(bench, "kinds.number", EVENT_CONTROL);
    bench_type(bench, "0.5");
    bench_key(bench, GLFW_KEY_ENTER);
    bench_frames(bench, 4);
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
    bench_frames(bench, 2);
    bench_drag(bench, "kinds.number", 0.5, 1); // a click during which the mouse moves by a pixel
    bench_click_with(bench, "kinds.number", EVENT_CONTROL);
    bench_key(bench, GLFW_KEY_ENTER);
    bench_frames(bench, 4);
    bench_drag(bench, "kinds.vector", 0.1, 50); // another component
    CHECK(bench->values.number == before.number, "%.17g", bench->values.number);
    CHECK(bench->values.vector[1] == before.vector[1], "%.17g", bench->values.vector[1]);
    CHECK(bench->values.color[2] == 0.7f && bench->values.real == 0.1f, "floats changed");
    bench_free(bench);
}

TEST(events_go_where_they_belong)
{
    struct bench *bench = bench_new(1);
    struct gui *gui = &bench->gui;
    bench_frames(bench, 2);
    bench_move(bench, 20, 300);
    CHECK(gui->wants_mouse, "over the panel");
    bench_move(bench, 700, 300);
    CHECK(!gui->wants_mouse, "over the picture");
    bench_button(bench, true, 0);
    CHECK(!gui->wants_mouse, "pressed over the picture");
    bench_move(bench, 20, 300);
    bench_frame(bench);
    CHECK(!gui->wants_mouse, "a drag of the picture that comes over the panel");
    bench_button(bench, false, 0);
    CHECK(!gui->wants_mouse, "and ends there");
    bench_move(bench, 21, 300);
    CHECK(gui->wants_mouse, "afterwards it is the panel's");
    double x, y;
    if (bench_point(bench, "kinds.number", 0.5, &x, &y)) {
        bench_move(bench, x, y);
        bench_button(bench, true, 0);
        bench_frame(bench);
        bench_move(bench, 700, 300);
        bench_frames(bench, 2);
        CHECK(gui->wants_mouse && gui->is_busy, "a drag of the panel that leaves it");
        bench_button(bench, false, 0);
        bench_frames(bench, 2);
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
    bench_frames(bench, 2);
    check_help(bench, "kinds.choice", "A word.");
    check_help(bench, "kinds.number", "A part. From 0 to 1.");
    check_help(bench, "kinds.color", "Linear. From 0 to 1.");
    bench_free(bench);
}

TEST(help_of_what_the_mouse_is_over)
{
    struct bench *bench = bench_new(1);
    double x, y;
    bench_frames(bench, 2);
    CHECK(!bench->gui.hovered_help, "nothing is hovered");
    if (bench_point(bench, "kinds.choice", 0.5, &x, &y)) {
        bench_move(bench, x, y);
        bench_frames(bench, 2);
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
    bench_frames(bench, 2);
    CHECK(!gui_find(&bench->gui, "inner.switch")->is_shown, "closed and far below");
    gui_reveal(&bench->gui, "inner.switch");
    bench_frames(bench, 2);
    bench_click(bench, "inner.switch");
    CHECK(bench->values.choice == 2, "%u", bench->values.choice);
    bench_free(bench);
}

// --- tabs and search -----------------------------------------------------------------------------

static struct bench *bench_with_tabs(void)
{
    struct bench *bench = bench_new(1);
    bench->has_tabs = true;
    bench_frames(bench, 2);
    return bench;
}

static bool is_shown(const struct bench *bench, const char *id)
{
    const struct gui_item *item = gui_find(&bench->gui, id);
    CHECK(item, "there is no %s", id);
    return item && item->is_shown;
}

TEST(one_tab_is_open)
{
    struct bench *bench = bench_with_tabs();
    CHECK_VALUE(bench, "tabs.first", "on");
    CHECK_VALUE(bench, "tabs.second", "off");
    CHECK(is_shown(bench, "kinds.number") && !is_shown(bench, "outer"), "the first tab");
    bench_click(bench, "tabs.second");
    CHECK_VALUE(bench, "tabs.first", "off");
    CHECK_VALUE(bench, "tabs.second", "on");
    CHECK(!is_shown(bench, "kinds.number") && is_shown(bench, "outer"), "the second tab");
    CHECK_SET(bench, "tabs.first", "on");
    CHECK_VALUE(bench, "tabs.first", "on");
    CHECK_REFUSED(bench, "tabs.first", "off", "another tab closes this one");
    set_all(bench);
    CHECK_SET(bench, "inner.switch", "on"); // it is in the other tab
    CHECK(bench->values.choice == 2, "%u", bench->values.choice);
    bench_free(bench);
}

TEST(reveal_opens_tabs)
{
    struct bench *bench = bench_with_tabs();
    CHECK_SET(bench, "panel.search", "number");
    gui_reveal(&bench->gui, "inner.switch");
    bench_frames(bench, 2);
    CHECK_VALUE(bench, "tabs.second", "on");
    CHECK_VALUE(bench, "panel.search", "");
    bench_click(bench, "inner.switch");
    CHECK(bench->values.choice == 2, "%u", bench->values.choice);
    bench_free(bench);
}

TEST(a_search_shows_controls_of_all_tabs)
{
    static const struct {
        const char *words, *shown, *not_shown;
    } searches[] = {
        {"NUMBER", "kinds.number", "kinds.switch"},       // a label
        {"two groups", "inner.switch", "kinds.switch"},   // a help, in a closed group
        {"kinds metres", "kinds.vector", "kinds.number"}, // an id and a help
        {"  colour ", "kinds.color", "kinds.choice"},     // blanks are not part of words
        {"switch", "inner.switch", "kinds.number"},       // controls of two tabs
        {"switch", "kinds.switch", "kinds.row"},
    };
    struct bench *bench = bench_with_tabs();
    for (size_t i = 0; i < sizeof searches / sizeof *searches; i++) {
        CHECK_SET(bench, "panel.search", searches[i].words);
        bench_frames(bench, 2);
        CHECK(is_shown(bench, searches[i].shown), "\"%s\" finds %s", searches[i].words,
              searches[i].shown);
        CHECK(!is_shown(bench, searches[i].not_shown), "\"%s\" does not find %s", searches[i].words,
              searches[i].not_shown);
        CHECK(!is_shown(bench, "outer"), "groups have no headings of their own");
    }
    bench_click(bench, "kinds.switch");
    CHECK(bench->values.on, "what was found can be used");
    bench_click(bench, "tabs.second");
    CHECK_VALUE(bench, "panel.search", "");
    CHECK(is_shown(bench, "outer") && !is_shown(bench, "kinds.switch"), "a tab ends the search");
    bench_free(bench);
}

TEST(a_search_follows_the_words_that_are_typed)
{
    struct bench *bench = bench_with_tabs();
    bench_click(bench, "panel.search");
    bench_type(bench, "deep");
    bench_frames(bench, 6);
    CHECK_VALUE(bench, "panel.search", "");
    CHECK(is_shown(bench, "inner.switch") && !is_shown(bench, "kinds.switch"), "before Enter");
    bench_key(bench, GLFW_KEY_ESCAPE);
    bench_frames(bench, 4);
    CHECK(!is_shown(bench, "inner.switch") && is_shown(bench, "kinds.switch"), "Escape");
    bench_free(bench);
}

TEST(a_search_finds_rows_of_lists)
{
    struct bench *bench = bench_with_tabs();
    bench->rows = 1000000;
    CHECK_SET(bench, "panel.search", "rows.12");
    bench_frames(bench, 2);
    CHECK(bench->row_calls <= GUI_LIST_IDS, "%u rows", bench->row_calls);
    CHECK(is_shown(bench, "rows.12") && !is_shown(bench, "rows.13"), "rows");
    bench_click(bench, "rows.12");
    CHECK(bench->values.chosen == 12, "%u", bench->values.chosen);
    bench_free(bench);
}

TEST(what_does_not_apply_is_shown_to_searches_alone)
{
    struct bench *bench = bench_with_tabs();
    CHECK(is_shown(bench, "kinds.float"), "it applies");
    bench->useless = true;
    bench_frames(bench, 2);
    CHECK(!is_shown(bench, "kinds.float") && is_shown(bench, "kinds.count"), "hidden");
    CHECK_REFUSED(bench, "kinds.float", "1", "kinds.float is disabled");
    CHECK_SET(bench, "panel.search", "float");
    bench_frames(bench, 2);
    CHECK(is_shown(bench, "kinds.float"), "found");
    bench_free(bench);
}

TEST(reveal_scrolls_lists)
{
    struct bench *bench = bench_new(1);
    bench->fillers = 100;
    bench->rows = 1000;
    bench_frames(bench, 2);
    gui_reveal(&bench->gui, "rows.40");
    bench_frames(bench, 3);
    bench_click(bench, "rows.40");
    CHECK(bench->values.chosen == 40, "%u", bench->values.chosen);
    bench_free(bench);
}

TEST(long_lists_cost_what_is_seen_of_them)
{
    struct bench *bench = bench_new(1);
    bench->rows = 1000000;
    bench->values.chosen = 765432;
    bench_frame(bench);
    CHECK_SET(bench, "list", "open");
    bench_frames(bench, 2);
    CHECK(bench->row_calls <= GUI_LIST_IDS + 1 + 8, "%u rows", bench->row_calls);
    CHECK(gui_find(&bench->gui, "list.after")->rect[0] < 40.0f, "it begins a line: %g",
          (double)gui_find(&bench->gui, "list.after")->rect[0]);
    CHECK(gui_find(&bench->gui, "rows.63"), "the first ones");
    CHECK(!gui_find(&bench->gui, "rows.64"), "and no others");
    CHECK(gui_find(&bench->gui, "rows.765432"), "but the chosen one");
    gui_reveal(&bench->gui, "rows.765432");
    bench_frames(bench, 3);
    const struct gui_item *item = gui_find(&bench->gui, "rows.765432");
    CHECK(item && item->is_shown, "scrolled to");
    CHECK(gui_find(&bench->gui, "rows.765431"), "and its neighbours are there");
    bench_free(bench);
}

TEST(an_id_twice_is_told)
{
    struct bench *bench = bench_new(1);
    bench_frame(bench);
    CHECK(!gui_duplicate(&bench->gui), "%s", gui_duplicate(&bench->gui));
    bench->has_twice = true;
    bench_frame(bench);
    const char *id = gui_duplicate(&bench->gui);
    CHECK(id && strcmp(id, "kinds.button") == 0, "%s", id ? id : "none");
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
          TEST_CASE(one_tab_is_open), TEST_CASE(reveal_opens_tabs),
          TEST_CASE(a_search_shows_controls_of_all_tabs),
          TEST_CASE(a_search_follows_the_words_that_are_typed),
          TEST_CASE(a_search_finds_rows_of_lists),
          TEST_CASE(what_does_not_apply_is_shown_to_searches_alone),
          TEST_CASE(reveal_opens_and_scrolls), TEST_CASE(reveal_scrolls_lists),
          TEST_CASE(long_lists_cost_what_is_seen_of_them), TEST_CASE(an_id_twice_is_told))
