// Single controls: a label at the left, the value at the right.
#include "image/image.h"
#include "viewer/gui/gui_state.h"
#include "viewer/gui/imgui_bridge.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define REFUSAL_SECONDS 4.0
#define DRAG_POINTS 3.0f // less is a click

// --- what all share ------------------------------------------------------------------------------

static void note_hover(struct gui *gui, const struct gui_item *item)
{
    gui->hovered_help = item->help;
    snprintf(gui->own->hovered_id, sizeof gui->own->hovered_id, "%s", item->id);
}

void widget_note(struct gui *gui, struct gui_item *item)
{
    const struct gui_state *own = gui->own;
    const struct im_rect box = im_item_rect(), clip = im_clip(im_draw_window());
    float y = 0.5f * (box.min.y + box.max.y);
    item->is_shown =
        y > clip.min.y && y < clip.max.y && box.min.x < clip.max.x && box.max.x > clip.min.x;
    item->rect[0] = fmaxf(box.min.x, clip.min.x);
    item->rect[1] = fmaxf(box.min.y, clip.min.y);
    item->rect[2] = fmaxf(fminf(box.max.x, clip.max.x), item->rect[0]);
    item->rect[3] = fmaxf(fminf(box.max.y, clip.max.y), item->rect[1]);
    if (im_is_hovered_even_disabled())
        note_hover(gui, item);
    if (own->reveal_frames && strcmp(own->reveal, item->id) == 0)
        im_scroll_here();
}

static void begin(struct gui *gui, const struct gui_item *item)
{
    im_push_id(item->id);
    im_push_disabled(!item->is_enabled);
    if (gui->own->same_line)
        im_same_line();
}

static void end(struct gui *gui)
{
    gui->own->same_line = false;
    im_pop_disabled();
    im_pop_id();
}

// The label in its column; what follows fills the rest of the line.
static void put_label(struct gui *gui, const struct gui_item *item)
{
    if (gui->own->same_line || !item->label[0])
        return;
    const struct im_style style = im_style_now();
    const struct im_vec at = im_cursor();
    float room = gui->own->label_width - (at.x - im_window_pos().x);
    float width = fmaxf(room - style.item_inner_spacing.x, 1.0f), height = im_frame_height();
    struct ImDrawList *list = im_draw_window();
    im_push_clip(list, at, (struct im_vec){at.x + width, at.y + height}, true);
    im_draw_text(list, (struct im_vec){at.x, at.y + style.frame_padding.y}, im_rgba(IM_COLOR_TEXT),
                 item->label);
    im_pop_clip(list);
    im_dummy(width, height);
    if (im_is_hovered_even_disabled())
        note_hover(gui, item);
    im_same_line_at(gui->own->label_width);
}

static float rest_of_line(void)
{
    return fmaxf(im_room(), 1.0f);
}

static void refuse(struct gui_state *own, const char *id, const char *why)
{
    snprintf(own->refusal, sizeof own->refusal, "%.90s: %.400s", id, why);
    own->refusal_until = own->clock + REFUSAL_SECONDS;
}

// --- simple ones ---------------------------------------------------------------------------------

bool widget_group(struct gui *gui, struct gui_item *item, bool is_open)
{
    bool is_inner = gui->own->depth > 0;
    im_push_id(item->id);
    if (!is_inner)
        im_dummy(0.0f, 0.0f);
    bool now = im_tree(item->label, is_open, !is_inner);
    widget_note(gui, item);
    im_pop_id();
    if (is_inner && now)
        im_indent();
    return now;
}

void widget_group_end(struct gui *gui)
{
    if (gui->own->depth > 1)
        im_unindent();
}

bool widget_button(struct gui *gui, struct gui_item *item)
{
    begin(gui, item);
    bool pressed = im_button(item->label);
    widget_note(gui, item);
    end(gui);
    return pressed;
}

bool widget_switch(struct gui *gui, struct gui_item *item, bool *value)
{
    begin(gui, item);
    bool same_line = gui->own->same_line;
    put_label(gui, item);
    char label[160];
    snprintf(label, sizeof label, "%s##switch", same_line ? item->label : "");
    bool changed = im_checkbox(label, value);
    widget_note(gui, item);
    end(gui);
    return changed;
}

bool widget_row(struct gui *gui, struct gui_item *item, bool is_chosen)
{
    begin(gui, item);
    char label[320];
    snprintf(label, sizeof label, "%s##row", item->label);
    if (is_chosen)
        im_push_color_of(IM_COLOR_TEXT, IM_COLOR_CHECK_MARK);
    bool pressed = im_selectable(label, is_chosen);
    if (is_chosen)
        im_pop_color();
    widget_note(gui, item);
    end(gui);
    return pressed;
}

bool widget_choice(struct gui *gui, struct gui_item *item, const char *const *names,
                   uint32_t *value)
{
    struct gui_state *own = gui->own;
    bool changed = false;
    begin(gui, item);
    put_label(gui, item);
    im_next_width(rest_of_line());
    bool is_open = im_combo_begin("##choice", names[*value]);
    if (!is_open)
        widget_note(gui, item);
    for (uint32_t i = 0; is_open && names[i]; i++) {
        char id[GUI_ID_MAX];
        if (snprintf(id, sizeof id, "%s=%s", item->id, names[i]) >= GUI_ID_MAX)
            id[GUI_ID_MAX - 1] = '\0'; // names of a scene may be of any length
        struct gui_item *entry = items_add(own, id, GUI_ROW, names[i], item->help);
        bool wished = items_wish(own, entry) != NULL;
        if (im_selectable(names[i], i == *value) || wished) {
            changed = changed || i != *value;
            *value = i;
        }
        widget_note(gui, entry);
        snprintf(entry->value, sizeof entry->value, "%s", i == *value ? "on" : "off");
    }
    if (is_open) {
        own->has_popup = true;
        im_combo_end();
        widget_note(gui, item);
    }
    end(gui);
    return changed;
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
    own->edit_begins = true;
    own->edit_idle = 0;
}

// The text that is being typed, in place of its control. True: it ended, and edit_text is what was
// typed, unless *is_given_up.
static bool edit_draw(struct gui_state *own, float width, uint32_t size, bool *is_given_up)
{
    own->edit_idle = 0;
    bool begins = own->edit_begins;
    if (begins)
        im_focus_next();
    own->edit_begins = false;
    im_next_width(width);
    im_input("##edit", own->edit_text, size < GUI_TEXT_MAX ? size : GUI_TEXT_MAX);
    if (!im_is_deactivated())
        return false;
    *is_given_up = !im_is_deactivated_after_edit();
    own->edit_id[0] = '\0';
    return true;
}

// What is typed into, while it is not: looks like what it becomes when it is clicked.
static bool text_box(const char *text)
{
    const struct im_style style = im_style_now();
    const struct im_vec at = im_cursor(), size = {rest_of_line(), im_frame_height()};
    const struct im_vec corner = {at.x + size.x, at.y + size.y};
    bool pressed = im_hit("##text", size);
    enum im_color ground = im_is_hovered() ? IM_COLOR_FRAME_HOVERED : IM_COLOR_FRAME;
    struct ImDrawList *list = im_draw_window();
    im_draw_rect(list, at, corner, im_rgba(ground), style.frame_rounding);
    im_push_clip(list, at, (struct im_vec){corner.x - style.frame_padding.x, corner.y}, true);
    im_draw_text(list, (struct im_vec){at.x + style.frame_padding.x, at.y + style.frame_padding.y},
                 im_rgba(IM_COLOR_TEXT), text);
    im_pop_clip(list);
    return pressed;
}

bool widget_text(struct gui *gui, struct gui_item *item, char *value, uint32_t size)
{
    struct gui_state *own = gui->own;
    bool changed = false;
    begin(gui, item);
    put_label(gui, item);
    if (is_editing(own, item->id)) {
        bool is_given_up;
        if (edit_draw(own, rest_of_line(), size, &is_given_up) && !is_given_up &&
            strcmp(own->edit_text, value) != 0) {
            snprintf(value, size, "%s", own->edit_text);
            changed = true;
        }
    } else if (text_box(value)) {
        edit_start(own, item->id, value);
    }
    widget_note(gui, item);
    end(gui);
    return changed;
}

// --- numbers -------------------------------------------------------------------------------------

// How much of its range a number fills; 0 where the range is no picture of it.
static float filled(const struct gui_range *range, double value)
{
    double span = range->max - range->min;
    if (range->logarithmic || range->drag > 0.0 || !(span <= 1e4))
        return 0.0f;
    return (float)((value - range->min) / span);
}

// In the middle of the box, with as many digits as there is room for.
static void draw_digits(struct ImDrawList *list, struct im_vec at, struct im_vec size,
                        const struct gui_range *range, double value)
{
    const struct im_vec pad = im_style_now().frame_padding;
    char text[GUI_VALUE_MAX];
    float width = FLT_MAX;
    for (int digits = 6; digits >= 3 && width > size.x; digits--) {
        value_show(value, range, digits, text);
        width = im_text_size(text, -1.0f).x;
    }
    float x = at.x + fmaxf(0.5f * (size.x - width), pad.x * 0.5f);
    im_push_clip(list, at, (struct im_vec){at.x + size.x, at.y + size.y}, true);
    im_draw_text(list, (struct im_vec){floorf(x), at.y + pad.y}, im_rgba(IM_COLOR_TEXT), text);
    im_pop_clip(list);
}

static void draw_number(struct im_vec at, struct im_vec size, const struct gui_range *range,
                        double value)
{
    struct ImDrawList *list = im_draw_window();
    const struct im_vec corner = {at.x + size.x, at.y + size.y};
    float rounding = im_style_now().frame_rounding;
    enum im_color ground = im_is_active()    ? IM_COLOR_FRAME_ACTIVE
                           : im_is_hovered() ? IM_COLOR_FRAME_HOVERED
                                             : IM_COLOR_FRAME;
    im_draw_rect(list, at, corner, im_rgba(ground), rounding);
    float part = fminf(fmaxf(filled(range, value), 0.0f), 1.0f);
    if (part * size.x >= 1.0f) {
        im_push_clip(list, at, (struct im_vec){at.x + part * size.x, corner.y}, true);
        im_draw_rect(list, at, corner, im_rgba(IM_COLOR_GRAB), rounding);
        im_pop_clip(list);
    }
    draw_digits(list, at, size, range, value);
}

static bool type_number(struct gui_state *own, const char *id, float width,
                        const struct gui_range *range, bool is_float, double *value)
{
    bool is_given_up;
    if (!edit_draw(own, width, GUI_VALUE_MAX, &is_given_up) || is_given_up)
        return false;
    double to = *value;
    char why[512];
    if (!value_read(own->edit_text, is_float, range, &to, why))
        refuse(own, id, why);
    bool changed = to != *value;
    if (changed)
        *value = to;
    return changed;
}

// The mouse drags the last item, whose width is given. A click with Ctrl, or two, begin to type.
static bool drag_number(struct gui_state *own, const char *id, float width,
                        const struct gui_range *range, bool is_float, double *value)
{
    bool changed = false;
    if (im_is_activated()) {
        own->drag_start = *value;
        own->drag_pixels = 0.0;
        own->drag_types = im_is_control_held() || im_is_double_clicked();
    }
    if (im_is_active() && im_is_dragged(DRAG_POINTS * own->scale)) {
        own->drag_types = false;
        own->drag_pixels += (double)im_mouse_delta().x * (im_is_shift_held() ? 0.1 : 1.0);
        double to =
            value_dragged(own->drag_start, own->drag_pixels / (double)width, range, is_float);
        changed = to != *value;
        if (changed)
            *value = to;
    }
    if (im_is_deactivated() && own->drag_types) {
        char text[GUI_VALUE_MAX];
        value_write(*value, is_float, range, text);
        edit_start(own, id, text);
    }
    return changed;
}

// One box; its rect is the last item's. id: of what is typed into.
static bool number_box(struct gui *gui, const char *id, float width, const struct gui_range *range,
                       bool is_float, double *value)
{
    struct gui_state *own = gui->own;
    if (is_editing(own, id))
        return type_number(own, id, width, range, is_float, value);
    const struct im_vec at = im_cursor(), size = {width, im_frame_height()};
    im_hit("##number", size);
    if (im_is_hovered() || im_is_active())
        im_show_resize_cursor();
    bool changed = drag_number(own, id, width, range, is_float, value);
    draw_number(at, size, range, *value);
    return changed;
}

bool widget_number(struct gui *gui, struct gui_item *item, const struct gui_range *range,
                   bool is_float, double *value)
{
    begin(gui, item);
    put_label(gui, item);
    bool changed = number_box(gui, item->id, rest_of_line(), range, is_float, value);
    widget_note(gui, item);
    end(gui);
    return changed;
}

// Three boxes in the width; they become one thing for widget_note.
static bool three_boxes(struct gui *gui, const char *id, float width, const struct gui_range *range,
                        bool is_float, double value[3])
{
    static const char *const axes[3] = {"x", "y", "z"};
    bool changed = false;
    float space = im_style_now().item_inner_spacing.x * 0.5f;
    float each = floorf((width - 2.0f * space) / 3.0f);
    im_group_begin();
    for (int c = 0; c < 3; c++) {
        char part[GUI_ID_MAX + 2];
        snprintf(part, sizeof part, "%s.%s", id, axes[c]);
        part[GUI_ID_MAX - 1] = '\0';
        im_push_id_number(c);
        if (c)
            im_same_line_after(space);
        if (number_box(gui, part, fmaxf(each, 1.0f), range, is_float, &value[c]))
            changed = true;
        im_pop_id();
    }
    im_group_end();
    return changed;
}

bool widget_vector(struct gui *gui, struct gui_item *item, const struct gui_range *range,
                   bool is_float, double value[3])
{
    begin(gui, item);
    put_label(gui, item);
    bool changed = three_boxes(gui, item->id, rest_of_line(), range, is_float, value);
    widget_note(gui, item);
    end(gui);
    return changed;
}

// --- colours -------------------------------------------------------------------------------------
// Values are linear; what a screen shows and people choose from is encoded as sRGB has it (IEC
// 61966-2-1). Above 1 a colour is shown, and chosen, as what it is with its greatest component
// at 1.

static float strength_of(const float value[3])
{
    float most = fmaxf(fmaxf(value[0], value[1]), value[2]);
    return most > 1.0f && most <= FLT_MAX ? most : 1.0f;
}

static void encode_three(const float value[3], float out[3])
{
    float strength = strength_of(value);
    for (int c = 0; c < 3; c++)
        out[c] = image_srgb_from_linear(fminf(value[c] / strength, 1.0f));
}

static bool color_popup(struct gui_state *own, const struct gui_range *range, float value[3])
{
    if (!im_popup_begin("color"))
        return false;
    own->has_popup = true;
    float shown[3], strength = strength_of(value);
    encode_three(value, shown);
    im_next_width(180.0f * own->scale);
    bool changed = im_color_wheel("##picker", shown);
    for (int c = 0; changed && c < 3; c++)
        value[c] = fminf(fmaxf(image_srgb_to_linear(shown[c]) * strength, (float)range->min),
                         (float)range->max);
    im_popup_end();
    return changed;
}

bool widget_color(struct gui *gui, struct gui_item *item, const struct gui_range *range,
                  float value[3])
{
    begin(gui, item);
    put_label(gui, item);
    float space = im_style_now().item_inner_spacing.x;
    float shown[3], height = im_frame_height();
    encode_three(value, shown);
    float width = rest_of_line() - height - space;
    double wide[3] = {(double)value[0], (double)value[1], (double)value[2]};
    if (im_color_button("##swatch", shown, height))
        im_popup_open("color");
    if (im_is_hovered())
        note_hover(gui, item);
    bool changed = color_popup(gui->own, range, value);
    im_same_line_after(space);
    if (three_boxes(gui, item->id, width, range, true, wide)) {
        for (int c = 0; c < 3; c++)
            value[c] = (float)wide[c];
        changed = true;
    }
    widget_note(gui, item);
    end(gui);
    return changed;
}

// --- lists ---------------------------------------------------------------------------------------

// In doubles: 10^6 rows are more pixels than single precision tells apart, and rows would tremble;
// where ImGui itself rounds, all rows are moved together.
static void find_rows(struct gui_list *list, float height)
{
    double scroll = (double)im_scroll(), each = (double)im_line_height_spaced();
    list->first = (uint32_t)fmax(floor(scroll / each), 0.0);
    list->last = (uint32_t)ceil((scroll + (double)height) / each) + 1u;
    if (list->last > list->count)
        list->last = list->count;
    if (list->first > list->last)
        list->first = list->last;
}

void widget_list_begin(struct gui *gui, const char *id, struct gui_list *list)
{
    (void)gui;
    uint32_t rows = list->count < list->height ? list->count : list->height;
    const struct im_style style = im_style_now();
    im_push_color_of(IM_COLOR_CHILD, IM_COLOR_POPUP);
    float pad = style.frame_padding.y;
    float height = (float)(rows ? rows : 1) * im_line_height_spaced() + 2.0f * pad;
    // Switches in rows are as high as letters.
    im_push_padding((struct im_vec){style.window_padding.x, pad},
                    (struct im_vec){style.frame_padding.x, 0.0f});
    im_child_begin(id, height, true);
    im_pop_color();
    find_rows(list, height);
    im_dummy(0.0f, 0.0f);
}

// Goes to where the row begins.
static void go_to_row(uint32_t row)
{
    float top = im_style_now().window_padding.y;
    im_cursor_set_y(top + (float)((double)row * (double)im_line_height_spaced()));
}

void widget_list_row(struct gui *gui, const struct gui_list *list, uint32_t row)
{
    (void)gui;
    (void)list;
    go_to_row(row);
}

void widget_list_end(struct gui *gui, struct gui_list *list)
{
    const struct gui_state *own = gui->own;
    go_to_row(list->count);
    im_dummy(1.0f, 0.0f);
    if (own->list_reveal >= 0.0) {
        float center = (float)((own->list_reveal + 0.5) * (double)im_line_height_spaced());
        im_scroll_set(fmaxf(center - 0.5f * im_window_height(), 0.0f));
    }
    im_pop_padding();
    im_child_end();
    if (own->list_reveal >= 0.0)
        im_scroll_here();
}
