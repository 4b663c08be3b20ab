// Single controls, drawn by Dear ImGui: a label at the left, the value at the right.
extern "C" {
#include "gui_state.h"
}

#include <cfloat>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <imgui.h>

#define REFUSAL_SECONDS 4.0
#define DRAG_POINTS 3.0f // less is a click

// --- what all share ------------------------------------------------------------------------------

void widget_note(struct gui *gui, struct gui_item *item)
{
    struct gui_state *own = gui->own;
    ImVec2 min = ImGui::GetItemRectMin(), max = ImGui::GetItemRectMax();
    const ImDrawList *list = ImGui::GetWindowDrawList();
    ImVec2 clip_min = list->GetClipRectMin(), clip_max = list->GetClipRectMax();
    float y = 0.5f * (min.y + max.y);
    item->is_shown = y > clip_min.y && y < clip_max.y && min.x < clip_max.x && max.x > clip_min.x;
    item->rect[0] = fmaxf(min.x, clip_min.x);
    item->rect[1] = fmaxf(min.y, clip_min.y);
    item->rect[2] = fmaxf(fminf(max.x, clip_max.x), item->rect[0]);
    item->rect[3] = fmaxf(fminf(max.y, clip_max.y), item->rect[1]);
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
        gui->hovered_help = item->help;
        snprintf(own->hovered_id, sizeof own->hovered_id, "%s", item->id);
    }
    if (own->reveal_frames && strcmp(own->reveal, item->id) == 0)
        ImGui::SetScrollHereY(0.5f);
}

static void begin(struct gui *gui, const struct gui_item *item)
{
    ImGui::PushID(item->id);
    ImGui::BeginDisabled(!item->is_enabled);
    if (gui->own->same_line)
        ImGui::SameLine();
}

static void end(struct gui *gui)
{
    gui->own->same_line = false;
    ImGui::EndDisabled();
    ImGui::PopID();
}

// The label in its column; what follows fills the rest of the line.
static void put_label(struct gui *gui, const struct gui_item *item)
{
    if (gui->own->same_line || !item->label[0])
        return;
    ImVec2 at = ImGui::GetCursorScreenPos();
    float width = gui->own->label_width - (at.x - ImGui::GetWindowPos().x);
    ImVec2 size(fmaxf(width - ImGui::GetStyle().ItemInnerSpacing.x, 1.0f), ImGui::GetFrameHeight());
    ImGui::PushClipRect(at, ImVec2(at.x + size.x, at.y + size.y), true);
    ImGui::GetWindowDrawList()->AddText(ImVec2(at.x, at.y + ImGui::GetStyle().FramePadding.y),
                                        ImGui::GetColorU32(ImGuiCol_Text), item->label);
    ImGui::PopClipRect();
    ImGui::Dummy(size);
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
        gui->hovered_help = item->help;
        snprintf(gui->own->hovered_id, GUI_ID_MAX, "%s", item->id);
    }
    ImGui::SameLine(gui->own->label_width);
}

static float rest_of_line(void)
{
    return fmaxf(ImGui::GetContentRegionAvail().x, 1.0f);
}

static void refuse(struct gui_state *own, const char *id, const char *why)
{
    snprintf(own->refusal, sizeof own->refusal, "%.90s: %.400s", id, why);
    own->refusal_until = own->clock + REFUSAL_SECONDS;
}

// --- simple ones ---------------------------------------------------------------------------------

bool widget_group(struct gui *gui, struct gui_item *item, bool is_open)
{
    struct gui_state *own = gui->own;
    bool is_inner = own->depth > 0;
    ImGuiTreeNodeFlags flags = ImGuiTreeNodeFlags_NoTreePushOnOpen |
                               ImGuiTreeNodeFlags_SpanAvailWidth | ImGuiTreeNodeFlags_FramePadding;
    if (!is_inner)
        flags |= ImGuiTreeNodeFlags_Framed;
    ImGui::PushID(item->id);
    if (!is_inner)
        ImGui::Dummy(ImVec2(0.0f, 0.0f));
    ImGui::SetNextItemOpen(is_open);
    bool now = ImGui::TreeNodeEx("group", flags, "%s", item->label);
    widget_note(gui, item);
    ImGui::PopID();
    if (is_inner && now)
        ImGui::Indent();
    return now;
}

void widget_group_end(struct gui *gui)
{
    if (gui->own->depth > 1)
        ImGui::Unindent();
}

bool widget_button(struct gui *gui, struct gui_item *item)
{
    begin(gui, item);
    bool pressed = ImGui::Button(item->label);
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
    bool changed = ImGui::Checkbox(label, value);
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
        ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_CheckMark));
    bool pressed = ImGui::Selectable(label, is_chosen);
    if (is_chosen)
        ImGui::PopStyleColor();
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
    ImGui::SetNextItemWidth(rest_of_line());
    bool is_open = ImGui::BeginCombo("##choice", names[*value], ImGuiComboFlags_HeightLarge);
    if (!is_open)
        widget_note(gui, item);
    for (uint32_t i = 0; is_open && names[i]; i++) {
        char id[GUI_ID_MAX];
        if (snprintf(id, sizeof id, "%s=%s", item->id, names[i]) >= GUI_ID_MAX)
            id[GUI_ID_MAX - 1] = '\0'; // names of a scene may be of any length
        struct gui_item *entry = items_add(own, id, GUI_ROW, names[i], item->help);
        bool wished = items_wish(own, entry) != NULL;
        if (ImGui::Selectable(names[i], i == *value) || wished) {
            changed = changed || i != *value;
            *value = i;
        }
        widget_note(gui, entry);
        snprintf(entry->value, sizeof entry->value, "%s", i == *value ? "on" : "off");
    }
    if (is_open) {
        own->has_popup = true;
        ImGui::EndCombo();
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
        ImGui::SetKeyboardFocusHere();
    own->edit_begins = false;
    ImGui::SetNextItemWidth(width);
    ImGui::InputText("##edit", own->edit_text, size < GUI_TEXT_MAX ? size : GUI_TEXT_MAX,
                     ImGuiInputTextFlags_AutoSelectAll);
    if (!ImGui::IsItemDeactivated())
        return false;
    *is_given_up = !ImGui::IsItemDeactivatedAfterEdit();
    own->edit_id[0] = '\0';
    return true;
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
    } else {
        // Looks like what it becomes when it is clicked.
        ImVec2 at = ImGui::GetCursorScreenPos();
        ImVec2 extent(rest_of_line(), ImGui::GetFrameHeight());
        bool pressed = ImGui::InvisibleButton("##text", extent);
        ImGuiCol color = ImGui::IsItemHovered() ? ImGuiCol_FrameBgHovered : ImGuiCol_FrameBg;
        const ImGuiStyle &style = ImGui::GetStyle();
        ImDrawList *list = ImGui::GetWindowDrawList();
        ImVec2 corner(at.x + extent.x, at.y + extent.y);
        list->AddRectFilled(at, corner, ImGui::GetColorU32(color), style.FrameRounding);
        list->PushClipRect(at, ImVec2(corner.x - style.FramePadding.x, corner.y), true);
        list->AddText(ImVec2(at.x + style.FramePadding.x, at.y + style.FramePadding.y),
                      ImGui::GetColorU32(ImGuiCol_Text), value);
        list->PopClipRect();
        if (pressed)
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

static void draw_number(ImVec2 at, ImVec2 size, const struct gui_range *range, double value)
{
    const ImGuiStyle &style = ImGui::GetStyle();
    ImDrawList *list = ImGui::GetWindowDrawList();
    ImVec2 corner(at.x + size.x, at.y + size.y);
    ImGuiCol ground = ImGui::IsItemActive()    ? ImGuiCol_FrameBgActive
                      : ImGui::IsItemHovered() ? ImGuiCol_FrameBgHovered
                                               : ImGuiCol_FrameBg;
    list->AddRectFilled(at, corner, ImGui::GetColorU32(ground), style.FrameRounding);
    float part = fminf(fmaxf(filled(range, value), 0.0f), 1.0f);
    if (part * size.x >= 1.0f) {
        list->PushClipRect(at, ImVec2(at.x + part * size.x, corner.y), true);
        list->AddRectFilled(at, corner, ImGui::GetColorU32(ImGuiCol_SliderGrab),
                            style.FrameRounding);
        list->PopClipRect();
    }
    // As many digits as there is room for.
    char text[GUI_VALUE_MAX];
    float width = FLT_MAX;
    for (int digits = 6; digits >= 3 && width > size.x; digits--) {
        value_show(value, range, digits, text);
        width = ImGui::CalcTextSize(text).x;
    }
    float x = at.x + fmaxf(0.5f * (size.x - width), style.FramePadding.x * 0.5f);
    list->PushClipRect(at, corner, true);
    list->AddText(ImVec2(floorf(x), at.y + style.FramePadding.y), ImGui::GetColorU32(ImGuiCol_Text),
                  text);
    list->PopClipRect();
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

// One box; its rect is the last item's. id: of what is typed into.
static bool number_box(struct gui *gui, const char *id, float width, const struct gui_range *range,
                       bool is_float, double *value)
{
    struct gui_state *own = gui->own;
    if (is_editing(own, id))
        return type_number(own, id, width, range, is_float, value);
    ImVec2 at = ImGui::GetCursorScreenPos(), size(width, ImGui::GetFrameHeight());
    ImGui::InvisibleButton("##number", size);
    const ImGuiIO &io = ImGui::GetIO();
    bool changed = false;
    if (ImGui::IsItemHovered() || ImGui::IsItemActive())
        ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (ImGui::IsItemActivated()) {
        own->drag_start = *value;
        own->drag_pixels = 0.0;
        own->drag_types = io.KeyCtrl || ImGui::IsMouseDoubleClicked(0);
    }
    if (ImGui::IsItemActive() && ImGui::IsMouseDragging(0, DRAG_POINTS * own->scale)) {
        own->drag_types = false;
        own->drag_pixels += (double)io.MouseDelta.x * (io.KeyShift ? 0.1 : 1.0);
        double to =
            value_dragged(own->drag_start, own->drag_pixels / (double)width, range, is_float);
        changed = to != *value;
        if (changed)
            *value = to;
    }
    if (ImGui::IsItemDeactivated() && own->drag_types) {
        char text[GUI_VALUE_MAX];
        value_write(*value, is_float, range, text);
        edit_start(own, id, text);
    }
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
    float space = ImGui::GetStyle().ItemInnerSpacing.x * 0.5f;
    float each = floorf((width - 2.0f * space) / 3.0f);
    ImGui::BeginGroup();
    for (int c = 0; c < 3; c++) {
        char part[GUI_ID_MAX + 2];
        snprintf(part, sizeof part, "%s.%s", id, axes[c]);
        part[GUI_ID_MAX - 1] = '\0';
        ImGui::PushID(c);
        if (c)
            ImGui::SameLine(0.0f, space);
        if (number_box(gui, part, fmaxf(each, 1.0f), range, is_float, &value[c]))
            changed = true;
        ImGui::PopID();
    }
    ImGui::EndGroup();
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

static float encode(float linear)
{
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf(linear, 1.0f / 2.4f) - 0.055f;
}

static float decode(float encoded)
{
    return encoded <= 0.04045f ? encoded / 12.92f : powf((encoded + 0.055f) / 1.055f, 2.4f);
}

static float strength_of(const float value[3])
{
    float most = fmaxf(fmaxf(value[0], value[1]), value[2]);
    return most > 1.0f && most <= FLT_MAX ? most : 1.0f;
}

static void encode_three(const float value[3], float out[3])
{
    float strength = strength_of(value);
    for (int c = 0; c < 3; c++)
        out[c] = encode(fminf(value[c] / strength, 1.0f));
}

static bool color_popup(struct gui_state *own, const struct gui_range *range, float value[3])
{
    if (!ImGui::BeginPopup("color"))
        return false;
    own->has_popup = true;
    float shown[3], strength = strength_of(value);
    encode_three(value, shown);
    ImGui::SetNextItemWidth(180.0f * own->scale);
    bool changed =
        ImGui::ColorPicker3("##picker", shown,
                            ImGuiColorEditFlags_PickerHueWheel | ImGuiColorEditFlags_NoSidePreview |
                                ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoLabel |
                                ImGuiColorEditFlags_NoOptions);
    for (int c = 0; changed && c < 3; c++)
        value[c] = fminf(fmaxf(decode(shown[c]) * strength, (float)range->min), (float)range->max);
    ImGui::EndPopup();
    return changed;
}

bool widget_color(struct gui *gui, struct gui_item *item, const struct gui_range *range,
                  float value[3])
{
    struct gui_state *own = gui->own;
    begin(gui, item);
    put_label(gui, item);
    float shown[3], height = ImGui::GetFrameHeight();
    encode_three(value, shown);
    float width = rest_of_line() - height - ImGui::GetStyle().ItemInnerSpacing.x;
    double wide[3] = {(double)value[0], (double)value[1], (double)value[2]};
    if (ImGui::ColorButton("##swatch", ImVec4(shown[0], shown[1], shown[2], 1.0f),
                           ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoDragDrop,
                           ImVec2(height, height)))
        ImGui::OpenPopup("color");
    if (ImGui::IsItemHovered()) {
        gui->hovered_help = item->help;
        snprintf(own->hovered_id, sizeof own->hovered_id, "%s", item->id);
    }
    bool changed = color_popup(own, range, value);
    ImGui::SameLine(0.0f, ImGui::GetStyle().ItemInnerSpacing.x);
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

static float row_height(void)
{
    return ImGui::GetTextLineHeightWithSpacing();
}

void widget_list_begin(struct gui *gui, const char *id, struct gui_list *list)
{
    (void)gui;
    uint32_t rows = list->count < list->height ? list->count : list->height;
    const ImGuiStyle &style = ImGui::GetStyle();
    ImGui::PushStyleColor(ImGuiCol_ChildBg, ImGui::GetStyleColorVec4(ImGuiCol_PopupBg));
    float pad = style.FramePadding.y;
    float height = (float)(rows ? rows : 1) * row_height() + 2.0f * pad;
    // Switches in rows are as high as letters.
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(style.WindowPadding.x, pad));
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(style.FramePadding.x, 0.0f));
    ImGui::BeginChild(id, ImVec2(0.0f, height), false,
                      ImGuiWindowFlags_AlwaysUseWindowPadding | ImGuiWindowFlags_NoNav);
    ImGui::PopStyleColor();
    // In doubles: 10^6 rows are more pixels than single precision tells apart, and rows would
    // tremble; where ImGui itself rounds, all rows are moved together.
    double scroll = (double)ImGui::GetScrollY(), each = (double)row_height();
    list->first = (uint32_t)fmax(floor(scroll / each), 0.0);
    list->last = (uint32_t)ceil((scroll + (double)height) / each) + 1u;
    if (list->last > list->count)
        list->last = list->count;
    if (list->first > list->last)
        list->first = list->last;
    ImGui::Dummy(ImVec2(0.0f, 0.0f));
}

static float list_top(void)
{
    return ImGui::GetStyle().WindowPadding.y;
}

void widget_list_row(struct gui *gui, const struct gui_list *list, uint32_t row)
{
    (void)gui;
    (void)list;
    ImGui::SetCursorPosY(list_top() + (float)((double)row * (double)row_height()));
}

void widget_list_end(struct gui *gui, struct gui_list *list)
{
    struct gui_state *own = gui->own;
    ImGui::SetCursorPosY(list_top() + (float)((double)list->count * (double)row_height()));
    ImGui::Dummy(ImVec2(1.0f, 0.0f));
    if (own->list_reveal >= 0.0) {
        float center = (float)((own->list_reveal + 0.5) * (double)row_height());
        ImGui::SetScrollY(fmaxf(center - 0.5f * ImGui::GetWindowHeight(), 0.0f));
    }
    ImGui::PopStyleVar(2);
    ImGui::EndChild();
    if (own->list_reveal >= 0.0)
        ImGui::SetScrollHereY(0.5f);
}
