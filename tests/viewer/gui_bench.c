#include "gui_bench.h"

static const struct gui_tab tabs[] = {{"tabs.first", "First", "Kinds and a list."},
                                      {"tabs.second", "Second", "Nested groups."},
                                      {NULL, NULL, NULL}};
static const char *const words[] = {"alpha", "beta", "gamma", NULL};
const struct gui_range bench_unit = {0, 1};
const struct gui_range bench_metres = {0, 1e9, .logarithmic = true, .unit = "m", .least = "none"};
const struct gui_range bench_counts = {0,
                                       4294967295.0,
                                       .logarithmic = true,
                                       .integer = true,
                                       .infinite = "all",
                                       .greatest = 4294967294.0,
                                       .file_word = "off"};
const struct gui_range bench_wide = {-1e18, 1e18};

struct bench *bench_new(float scale)
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

void bench_free(struct bench *bench)
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
    used(bench, gui_number(gui, "kinds.number", "Number", "A part.", &bench_unit, &v->number));
    gui_applies(gui, !bench->useless);
    used(bench, gui_float(gui, "kinds.float", "Float", "Metres.", &bench_metres, &v->real));
    gui_applies(gui, true);
    used(bench, gui_count(gui, "kinds.count", "Count", "Whole.", &bench_counts, &v->count));
    used(bench, gui_choice(gui, "kinds.choice", "Choice", "A word.", words, &v->choice));
    used(bench, gui_color(gui, "kinds.color", "Colour", "Linear.", &bench_unit, v->color));
    used(bench, gui_vector(gui, "kinds.vector", "Vector", "Metres.", &bench_wide, v->vector));
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
        bool on = true;
        char part[40];
        snprintf(part, sizeof part, "%s.on", id);
        gui_switch(gui, part, "", "A switch in front of a row.", &on);
        gui_same_line(gui);
        if (gui_row(gui, id, id, "A row.", row == bench->values.chosen))
            bench->values.chosen = row;
    }
    gui_list_end(gui, &list);
    gui_button(gui, "list.after", "After", "Below the list.");
    gui_group_end(gui);
}

void bench_frame(struct bench *bench)
{
    struct gui *gui = &bench->gui;
    gui_begin(gui, bench->width ? bench->width : BENCH_WIDTH,
              bench->height ? bench->height : BENCH_HEIGHT, 1.0 / 60.0);
    gui_panel_begin(gui, "Test", "", bench->has_tabs ? tabs : NULL);
    if (bench->has_tabs)
        gui_tab_begin(gui, "tabs.first");
    draw_kinds(bench);
    for (uint32_t i = 0; i < bench->fillers; i++)
        gui_line(gui, "line %u", i);
    draw_list(bench);
    if (bench->has_tabs) {
        gui_tab_end(gui);
        gui_tab_begin(gui, "tabs.second");
    }
    gui_group_begin(gui, "outer", "Outer", "Closed at first.", false);
    gui_group_begin(gui, "inner", "Inner", "Closed, too.", false);
    bool on = bench->values.choice == 2;
    if (gui_switch(gui, "inner.switch", "Deep", "In two groups.", &on))
        bench->values.choice = on ? 2 : 0;
    gui_group_end(gui);
    gui_group_end(gui);
    if (bench->has_tabs)
        gui_tab_end(gui);
    gui_panel_end(gui);
    gui_end(gui, &bench->drawing);
}

void bench_frames(struct bench *bench, int count)
{
    while (count-- > 0)
        bench_frame(bench);
}

// --- what users do -------------------------------------------------------------------------------

void bench_move(struct bench *bench, double x, double y)
{
    gui_event(&bench->gui, &(struct event){.kind = EVENT_MOVE, .x = x, .y = y});
}

void bench_button(struct bench *bench, bool down, uint32_t modifiers)
{
    gui_event(&bench->gui,
              &(struct event){.kind = EVENT_BUTTON, .down = down, .modifiers = modifiers});
}

void bench_key(struct bench *bench, int code)
{
    gui_event(&bench->gui, &(struct event){.kind = EVENT_KEY, .code = code, .down = true});
    gui_event(&bench->gui, &(struct event){.kind = EVENT_KEY, .code = code});
}

void bench_type(struct bench *bench, const char *text)
{
    for (; *text; text++)
        gui_event(&bench->gui, &(struct event){.kind = EVENT_TEXT, .code = *text});
}

bool bench_point(struct bench *bench, const char *id, double part, double *x, double *y)
{
    const struct gui_item *item = gui_find(&bench->gui, id);
    CHECK(item && item->is_shown, "%s is not shown", id);
    if (!item || !item->is_shown)
        return false;
    *x = (double)item->rect[0] + part * (double)(item->rect[2] - item->rect[0]);
    *y = 0.5 * (double)(item->rect[1] + item->rect[3]);
    return true;
}

void bench_click_with(struct bench *bench, const char *id, uint32_t modifiers)
{
    double x, y;
    if (!bench_point(bench, id, 0.5, &x, &y))
        return;
    bench_move(bench, x, y);
    bench_button(bench, true, modifiers);
    bench_button(bench, false, modifiers);
    bench_frames(bench, 4);
}

void bench_click(struct bench *bench, const char *id)
{
    bench_click_with(bench, id, 0);
}

void bench_drag(struct bench *bench, const char *id, double part, double pixels)
{
    double x, y;
    if (!bench_point(bench, id, part, &x, &y))
        return;
    bench_move(bench, x, y);
    bench_button(bench, true, 0);
    bench_move(bench, x + pixels, y);
    bench_button(bench, false, 0);
    bench_frames(bench, 5);
}

const char *bench_set(struct bench *bench, const char *id, const char *value)
{
    gui_set(&bench->gui, id, value);
    bench_frame(bench);
    return gui_set_result(&bench->gui);
}

const char *bench_value(const struct bench *bench, const char *id)
{
    const struct gui_item *item = gui_find(&bench->gui, id);
    return item ? item->value : "(no such control)";
}
