// Controls. Each is entered into the registry, takes the value that a script has set, and is drawn
// with a label at the left and the value at the right.
#include "base/maths.h"
#include "image/image.h"
#include "viewer/gui/gui_state.h"
#include "viewer/gui/imgui_bridge.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define REFUSAL_SECONDS 4.0

// --- functions for all controls ------------------------------------------------------------------

void controls_note_drawn(struct gui *gui, struct gui_item *item)
{
    struct gui_state *own = gui->own;
    const struct im_item last = im_last();
    const struct im_rect box = last.box, clip = last.clip;
    float y = 0.5f * (box.top + box.bottom);
    item->is_shown =
        y > clip.top && y < clip.bottom && box.left < clip.right && box.right > clip.left;
    item->rect[0] = fmaxf(box.left, clip.left);
    item->rect[1] = fmaxf(box.top, clip.top);
    item->rect[2] = fmaxf(fminf(box.right, clip.right), item->rect[0]);
    item->rect[3] = fmaxf(fminf(box.bottom, clip.bottom), item->rect[1]);
    if (last.is_hovered) {
        gui->hovered_help = item->help;
        own->hovered = item;
    }
    if (own->reveal_frames && strcmp(own->reveal, item->id) == 0)
        im_scroll_here();
}

// Draws the label in its column; the control will fill the rest of the line.
static void put_label(struct gui *gui, struct gui_item *item)
{
    const float column = gui->own->label_width;
    const struct im_place now = im_now();
    const struct im_vec at = now.cursor;
    float width = fmaxf(column - (at.x - now.window.x) - now.inner_spacing, 1.0f);
    const struct im_rect box = {at.x, at.y, at.x + width, at.y + now.frame};
    im_draw_text(im_layer(IM_WINDOW), at.x, at.y + now.frame_padding.y, IM_TEXT, item->label, &box,
                 0.0f);
    im_dummy(width, now.frame);
    controls_note_drawn(gui, item);
    im_same_line(column, -1.0f);
}

// Returns whether a control is not drawn although its group is open.
static bool leaves_out(const struct gui_state *own, const struct gui_item *item)
{
    return own->is_searching ? !search_finds(own, item) : own->is_useless;
}

// Enters a control into the registry, and starts to draw it if it is visible. *wish receives the
// value that a script has set, or NULL.
static struct gui_item *begin(struct gui *gui, const char *id, enum gui_kind kind,
                              const char *label, const char *help, const char **wish)
{
    struct gui_state *own = gui->own;
    struct gui_item *item = items_add(own, id, kind, label, help);
    bool has_label = kind != GUI_GROUP && kind != GUI_BUTTON && kind != GUI_ROW;
    *wish = items_wish(own, item);
    own->was_drawn = own->is_drawn;
    own->is_left_out = own->is_drawn && leaves_out(own, item);
    own->is_drawn = own->is_drawn && !own->is_left_out;
    own->same_line = own->same_line && !own->is_left_out;
    if (!own->is_drawn)
        return item;
    if (own->is_searching && !own->same_line)
        search_heading(own);
    im_item_begin(item->id, !item->is_enabled);
    if (own->same_line)
        im_same_line(0.0f, -1.0f);
    else if (has_label && item->label[0])
        put_label(gui, item);
    return item;
}

static bool end(struct gui *gui, struct gui_item *item, bool is_changed)
{
    struct gui_state *own = gui->own;
    bool is_value = item->kind != GUI_GROUP && item->kind != GUI_BUTTON && item->kind != GUI_ROW;
    if (is_changed && is_value)
        gui->used = item->id;
    if (own->is_drawn) {
        controls_note_drawn(gui, item);
        im_item_end();
    }
    own->same_line = false;
    own->is_drawn = own->was_drawn;
    return is_changed;
}

static float rest_of_line(void)
{
    return fmaxf(im_now().room, 1.0f);
}

// --- groups --------------------------------------------------------------------------------------

static bool draw_group(struct gui *gui, struct gui_item *item, bool is_open)
{
    bool is_inner = gui->own->depth > gui->own->outer;
    im_item_begin(item->id, false);
    if (!is_inner)
        im_dummy(0.0f, 0.0f);
    bool now = im_tree(item->label, is_open, !is_inner);
    controls_note_drawn(gui, item);
    im_item_end();
    if (is_inner && now)
        im_indent(1);
    return now;
}

bool gui_group_begin(struct gui *gui, const char *id, const char *label, const char *help,
                     bool open_at_first)
{
    struct gui_state *own = gui->own;
    gui_enabled(gui, true);
    own->same_line = false;
    struct gui_item *item = items_add(own, id, GUI_GROUP, label, help);
    uint32_t index = items_group(own, id, label, open_at_first);
    struct gui_group *group = index ? &own->groups[index - 1] : NULL;
    bool is_open = group ? group->is_open : true;
    const char *wish = items_wish(own, item);
    if (wish && strcmp(wish, "open") != 0 && strcmp(wish, "closed") != 0)
        items_refuse(own, "%s: \"%.60s\" is neither \"open\" nor \"closed\"", id, wish);
    else if (wish)
        is_open = wish[0] == 'o';
    if (own->is_drawn && !own->is_searching)
        is_open = draw_group(gui, item, is_open);
    if (group)
        group->is_open = is_open;
    snprintf(item->value, sizeof item->value, "%s", is_open ? "open" : "closed");
    assert(own->depth < GUI_DEPTH_MAX);
    own->stack[own->depth] = index;
    own->stack_drawn[own->depth++] = own->is_drawn;
    own->is_drawn = own->is_drawn && (is_open || own->is_searching);
    return is_open;
}

void gui_group_end(struct gui *gui)
{
    struct gui_state *own = gui->own;
    assert(own->depth > 0);
    if (own->is_drawn && own->depth > own->outer + 1 && !own->is_searching)
        im_indent(-1);
    own->is_drawn = own->stack_drawn[--own->depth];
    gui_enabled(gui, true);
    own->same_line = false;
}

void gui_enabled(struct gui *gui, bool enabled)
{
    gui->own->is_enabled = enabled;
    gui->own->is_useless = false;
}

void gui_applies(struct gui *gui, bool applies)
{
    gui->own->is_enabled = applies;
    gui->own->is_useless = !applies;
}

bool gui_is_drawn(const struct gui *gui)
{
    return gui->own->is_drawn && !gui->own->is_searching;
}

void gui_same_line(struct gui *gui)
{
    gui->own->same_line = !gui->own->is_left_out;
}

// --- simple ones ---------------------------------------------------------------------------------

bool gui_button(struct gui *gui, const char *id, const char *label, const char *help)
{
    const char *wish;
    struct gui_item *item = begin(gui, id, GUI_BUTTON, label, help, &wish);
    bool pressed = gui->own->is_drawn && im_button(item->label, (struct im_vec){0}, false);
    return end(gui, item, pressed || wish);
}

bool gui_row(struct gui *gui, const char *id, const char *label, const char *help, bool is_chosen)
{
    const char *wish;
    char text[GUI_LABEL_MAX + 8];
    struct gui_item *item = begin(gui, id, GUI_ROW, label, help, &wish);
    snprintf(text, sizeof text, "%s##row", item->label);
    bool pressed = gui->own->is_drawn && im_row(text, is_chosen);
    snprintf(item->value, sizeof item->value, "%s", is_chosen || pressed || wish ? "on" : "off");
    return end(gui, item, pressed || wish);
}

bool gui_switch(struct gui *gui, const char *id, const char *label, const char *help, bool *value)
{
    struct gui_state *own = gui->own;
    const char *wish;
    char why[GUI_WHY_MAX], text[GUI_LABEL_MAX + 8];
    bool before = *value, same_line = own->same_line;
    struct gui_item *item = begin(gui, id, GUI_SWITCH, label, help, &wish);
    if (wish && !value_read_switch(wish, value, why))
        items_refuse(own, "%s: %s", id, why);
    snprintf(text, sizeof text, "%s##switch", same_line ? item->label : "");
    if (own->is_drawn)
        im_checkbox(text, value);
    snprintf(item->value, sizeof item->value, "%s", *value ? "on" : "off");
    return end(gui, item, *value != before);
}

bool gui_flag(struct gui *gui, const char *id, const char *label, const char *help, uint32_t *value)
{
    bool on = *value != 0;
    if (!gui_switch(gui, id, label, help, &on))
        return false;
    *value = on;
    return true;
}

// Draws a choice. While it is open, its words are drawn as rows, which are items of their own.
static void draw_choice(struct gui *gui, const struct gui_item *item, const char *const *names,
                        uint32_t *value)
{
    struct gui_state *own = gui->own;
    if (!im_combo_begin("##choice", names[*value]))
        return;
    own->has_popup = true;
    for (uint32_t i = 0; names[i]; i++) {
        char id[GUI_ID_MAX];
        if (snprintf(id, sizeof id, "%s=%s", item->id, names[i]) >= GUI_ID_MAX)
            id[GUI_ID_MAX - 1] = '\0'; // names in a scene may be longer than ids
        struct gui_item *entry = items_add(own, id, GUI_ROW, names[i], item->help);
        bool wished = items_wish(own, entry) != NULL;
        if (im_row(names[i], i == *value) || wished)
            *value = i;
        controls_note_drawn(gui, entry);
        snprintf(entry->value, sizeof entry->value, "%s", i == *value ? "on" : "off");
    }
    im_combo_end();
}

bool gui_choice(struct gui *gui, const char *id, const char *label, const char *help,
                const char *const *names, uint32_t *value)
{
    const char *wish;
    char why[GUI_WHY_MAX];
    uint32_t before = *value;
    struct gui_item *item = begin(gui, id, GUI_CHOICE, label, help, &wish);
    if (wish && !value_read_choice(wish, names, value, why))
        items_refuse(gui->own, "%s: %s", id, why);
    if (gui->own->is_drawn)
        draw_choice(gui, item, names, value);
    snprintf(item->value, sizeof item->value, "%s", names[*value]);
    return end(gui, item, *value != before);
}

// --- typing --------------------------------------------------------------------------------------

static bool is_editing(const struct gui_state *own, const char *id)
{
    return own->edit_id[0] && strcmp(own->edit_id, id) == 0;
}

static void edit_start(struct gui_state *own, const char *id, const char *text)
{
    snprintf(own->edit_id, sizeof own->edit_id, "%s", id);
    snprintf(own->edit_text, sizeof own->edit_text, "%s", text);
    own->edit_idle = 0;
}

// Draws a text box for typing. Returns true when typing has ended; edit_text then has the text.
static bool text_box(struct gui_state *own, const char *id, const char *text, uint32_t size,
                     float width)
{
    char copy[GUI_TEXT_MAX];
    bool is_mine = is_editing(own, id), begins = is_mine && own->edit_begins;
    snprintf(copy, sizeof copy, "%s", text);
    im_input("##edit", is_mine ? own->edit_text : copy, size < GUI_TEXT_MAX ? size : GUI_TEXT_MAX,
             width, begins);
    const struct im_item last = im_last();
    if (!is_mine && last.is_active && !own->edit_id[0]) // otherwise typing ends in this frame
        edit_start(own, id, copy);
    if (!is_mine)
        return false;
    own->edit_begins = false;
    own->edit_idle = 0;
    if (!last.was_deactivated)
        return false;
    own->edit_id[0] = '\0';
    return last.was_edited; // the text was edited, and typing was not cancelled
}

bool gui_text(struct gui *gui, const char *id, const char *label, const char *help, char *value,
              uint32_t size)
{
    struct gui_state *own = gui->own;
    const char *wish, *to = NULL;
    struct gui_item *item = begin(gui, id, GUI_TEXT, label, help, &wish);
    if (wish && strlen(wish) >= size)
        items_refuse(own, "%s: the text is longer than %u bytes", id, size - 1);
    else
        to = wish;
    if (own->is_drawn && text_box(own, item->id, value, size, rest_of_line()))
        to = own->edit_text;
    bool is_changed = to && strcmp(value, to) != 0;
    if (is_changed)
        snprintf(value, size, "%s", to);
    snprintf(item->value, sizeof item->value, "%s", value);
    return end(gui, item, is_changed);
}

// --- numbers -------------------------------------------------------------------------------------

static void type_number(struct gui_state *own, const char *id, float width,
                        const struct gui_range *range, bool is_float, double *value)
{
    char why[GUI_WHY_MAX];
    if (!text_box(own, id, "", GUI_VALUE_MAX, width) ||
        value_read(own->edit_text, 1, is_float, range, value, why))
        return;
    snprintf(own->refusal, sizeof own->refusal, "%.90s: %.400s", id, why);
    own->refusal_until = own->clock + REFUSAL_SECONDS;
}

// Changes a number by dragging the last item, which has the given width. A click with Ctrl, or a
// double click, starts typing.
static void drag_number(struct gui_state *own, const char *id, float width,
                        const struct gui_range *range, bool is_float, double *value)
{
    const struct im_item last = im_last();
    if (last.was_activated) {
        own->drag_start = *value;
        own->drag_widths = 0.0;
        own->drag_types = last.has_control || last.is_double_clicked;
    }
    if (last.is_dragged) {
        own->drag_types = false;
        own->drag_widths += (double)(last.drag / width);
        *value = value_dragged(own->drag_start, own->drag_widths, range, is_float);
    }
    if (last.was_deactivated && own->drag_types) {
        char text[GUI_VALUE_MAX];
        value_write(value, 1, is_float, range, text);
        edit_start(own, id, text);
        own->edit_begins = true;
    }
}

// Draws a number with as many digits as fit, and below it, if it has a range, a bar that shows its
// position in the range.
static void draw_number(float width, const struct gui_range *range, double value)
{
    const struct im_place now = im_now();
    const float x = now.cursor.x, bottom = now.cursor.y + now.frame;
    const double span = range->max - range->min;
    char text[GUI_VALUE_MAX], label[GUI_VALUE_MAX + 16];
    float shown = FLT_MAX;
    for (int digits = 6; digits >= 3 && shown > width; digits--) {
        value_show(value, range, digits, text);
        shown = im_text_width(text);
    }
    snprintf(label, sizeof label, "%s###number", text);
    im_button(label, (struct im_vec){width, now.frame}, true);
    if (range->logarithmic || range->drag > 0.0 || !(span <= 1e4))
        return;
    const struct im_rect bar = {x, bottom - floorf(0.15f * now.frame),
                                x + width * (float)((value - range->min) / span), bottom};
    im_draw_rect(im_layer(IM_WINDOW), bar, IM_DIM_GLOW, now.rounding);
}

// Draws boxes for `count` numbers in the rest of the line, as a single item.
static void draw_boxes(struct gui_state *own, const char *id, uint32_t count,
                       const struct gui_range *range, bool is_float, double *value)
{
    static const char *const axes[3] = {".x", ".y", ".z"};
    const float space = im_now().inner_spacing * 0.5f;
    const float all = rest_of_line() - (float)(count - 1) * space;
    const float width = fmaxf(count > 1 ? floorf(all / (float)count) : all, 1.0f);
    im_group_begin();
    for (uint32_t i = 0; i < count; i++) {
        char part[GUI_ID_MAX];
        snprintf(part, sizeof part, "%.90s%s", id, count > 1 ? axes[i] : "");
        if (i)
            im_same_line(0.0f, space);
        im_item_begin(part, false);
        if (is_editing(own, part)) {
            type_number(own, part, width, range, is_float, &value[i]);
        } else {
            draw_number(width, range, value[i]);
            drag_number(own, part, width, range, is_float, &value[i]);
        }
        im_item_end();
    }
    im_group_end();
}

// Draws a colour. Its values are linear; the swatch and the colour wheel show them sRGB-encoded
// (IEC 61966-2-1). A colour with a component above 1 is shown and edited after scaling its greatest
// component to 1.
static void draw_swatch(struct gui *gui, struct gui_item *item, const struct gui_range *range,
                        double value[3])
{
    struct gui_state *own = gui->own;
    const struct im_place now = im_now();
    float shown[3];
    double most = fmax(fmax(value[0], value[1]), value[2]);
    double strength = most > 1.0 && most <= (double)FLT_MAX ? most : 1.0;
    for (int c = 0; c < 3; c++)
        shown[c] = image_srgb_from_linear(fminf((float)(value[c] / strength), 1.0f));
    bool is_open;
    bool is_changed = im_color("##swatch", shown, now.frame, 180.0f * own->scale, &is_open);
    own->has_popup = own->has_popup || is_open;
    for (int c = 0; is_changed && c < 3; c++) {
        float to = (float)((double)image_srgb_to_linear(shown[c]) * strength);
        value[c] = fmin(fmax((double)to, range->min), range->max);
    }
    controls_note_drawn(gui, item);
    im_same_line(0.0f, now.inner_spacing);
}

// Draws controls for numbers of any type. They are handled as doubles, which represent the other
// types exactly.
static bool numbers(struct gui *gui, const char *id, enum gui_kind kind, const char *label,
                    const char *help, const struct gui_range *range, bool is_float, double *value)
{
    struct gui_state *own = gui->own;
    const char *wish;
    char why[GUI_WHY_MAX];
    const uint32_t count = kind == GUI_NUMBER ? 1 : 3;
    double before[3];
    memcpy(before, value, count * sizeof *value);
    struct gui_item *item = begin(gui, id, kind, label, help, &wish);
    item->range[0] = range->min;
    item->range[1] = range->infinite ? range->greatest : range->max;
    if (wish && !value_read(wish, count, is_float, range, value, why))
        items_refuse(own, "%s: %s", id, why);
    if (own->is_drawn && kind == GUI_COLOR)
        draw_swatch(gui, item, range, value);
    if (own->is_drawn)
        draw_boxes(own, item->id, count, range, is_float, value);
    value_write(value, count, is_float, range, item->value);
    bool is_changed = false;
    for (uint32_t i = 0; i < count; i++)
        is_changed = is_changed || value[i] != before[i];
    return end(gui, item, is_changed);
}

bool gui_number(struct gui *gui, const char *id, const char *label, const char *help,
                const struct gui_range *range, double *value)
{
    return numbers(gui, id, GUI_NUMBER, label, help, range, false, value);
}

bool gui_vector(struct gui *gui, const char *id, const char *label, const char *help,
                const struct gui_range *range, double value[3])
{
    return numbers(gui, id, GUI_VECTOR, label, help, range, false, value);
}

bool gui_float(struct gui *gui, const char *id, const char *label, const char *help,
               const struct gui_range *range, float *value)
{
    double wide = (double)*value;
    if (!numbers(gui, id, GUI_NUMBER, label, help, range, true, &wide))
        return false;
    *value = (float)wide;
    return true;
}

bool gui_count(struct gui *gui, const char *id, const char *label, const char *help,
               const struct gui_range *range, uint32_t *value)
{
    double wide = (double)*value;
    if (!numbers(gui, id, GUI_NUMBER, label, help, range, false, &wide))
        return false;
    *value = (uint32_t)wide;
    return true;
}

bool gui_angle(struct gui *gui, const char *id, const char *label, const char *help,
               const struct gui_range *range, double *radians)
{
    double degrees = *radians * (180.0 / M_PI);
    if (!numbers(gui, id, GUI_NUMBER, label, help, range, false, &degrees))
        return false;
    *radians = degrees * DEGREE;
    return true;
}

bool gui_color(struct gui *gui, const char *id, const char *label, const char *help,
               const struct gui_range *range, float value[3])
{
    double wide[3] = {(double)value[0], (double)value[1], (double)value[2]};
    if (!numbers(gui, id, GUI_COLOR, label, help, range, true, wide))
        return false;
    for (int c = 0; c < 3; c++)
        value[c] = (float)wide[c];
    return true;
}

// --- lists ---------------------------------------------------------------------------------------
// In a search, the rows that scripts may find are drawn as other controls are, if they are found.

// Computes which rows of a list are visible. Positions are doubles, because 10^6 rows are more
// pixels than single precision resolves, and rows would jitter. ImGui's own rounding moves all rows
// by the same amount.
static void find_rows(struct gui_list *list, float height)
{
    const struct im_place now = im_now();
    double scroll = (double)now.scroll, each = (double)now.line_spaced;
    list->last = (uint32_t)ceil((scroll + (double)height) / each) + 1u;
    list->last = list->last < list->count ? list->last : list->count;
    list->first = (uint32_t)fmax(floor(scroll / each), 0.0);
    list->first = list->first < list->last ? list->first : list->last;
}

// Moves the cursor to the start of a row.
static void go_to_row(uint32_t row)
{
    const struct im_place now = im_now();
    im_cursor_set_y(now.window_padding.y + (float)((double)row * (double)now.line_spaced));
}

void gui_list_begin(struct gui *gui, const char *id, struct gui_list *list)
{
    struct gui_state *own = gui->own;
    list->first = list->last = list->next = 0;
    list->was_drawn = own->is_drawn;
    own->reveal_hit = false;
    own->list_reveal = -1.0;
    if (!gui_is_drawn(gui))
        return;
    const struct im_place now = im_now();
    uint32_t rows = list->count < list->height ? list->count : list->height;
    float height = (float)(rows ? rows : 1) * now.line_spaced + 2.0f * now.frame_padding.y;
    im_child_begin(id, height, true);
    find_rows(list, height);
    im_dummy(0.0f, 0.0f);
}

// Returns the first row, starting with `row`, that the caller must draw.
static uint32_t next_row(const struct gui_list *list, uint32_t row)
{
    if (row < GUI_LIST_IDS || (row >= list->first && row < list->last) || row == list->chosen)
        return row;
    uint32_t next = list->count;
    if (row < list->first)
        next = list->first;
    if (row < list->chosen && list->chosen < next)
        next = list->chosen;
    return next;
}

bool gui_list_next(struct gui *gui, struct gui_list *list, uint32_t *row)
{
    struct gui_state *own = gui->own;
    if (own->reveal_hit) {
        own->list_reveal = (double)list->next - 1.0;
        own->reveal_hit = false;
    }
    uint32_t next = next_row(list, list->next);
    if (next >= list->count)
        return false;
    *row = next;
    list->next = next + 1;
    bool is_in_view = next >= list->first && next < list->last;
    own->is_drawn = list->was_drawn && (is_in_view || own->is_searching);
    own->same_line = false;
    if (gui_is_drawn(gui))
        go_to_row(next);
    return true;
}

void gui_list_end(struct gui *gui, struct gui_list *list)
{
    struct gui_state *own = gui->own;
    own->is_drawn = list->was_drawn;
    if (!gui_is_drawn(gui))
        return;
    const struct im_place now = im_now();
    go_to_row(list->count);
    im_dummy(1.0f, 0.0f);
    if (own->list_reveal >= 0.0) {
        float center = (float)((own->list_reveal + 0.5) * (double)now.line_spaced);
        im_scroll_set(fmaxf(center - 0.5f * now.window_height, 0.0f));
    }
    im_child_end(true);
    if (own->list_reveal >= 0.0)
        im_scroll_here();
}
