// See imgui_bridge.h. The one file of C++: nothing is decided here. One line a function, which
// clang-format would make four of.
// clang-format off
#include "viewer/gui/imgui_bridge.h"

#include <GLFW/glfw3.h>
#include <cstddef>
#include <cstring>
#include <imgui.h>

using namespace ImGui;

static_assert(sizeof(gpu_vertex) == sizeof(ImDrawVert) &&
                  offsetof(gpu_vertex, uv) == offsetof(ImDrawVert, uv) &&
                  offsetof(gpu_vertex, color) == offsetof(ImDrawVert, col),
              "vertices are copied as they are");
static_assert(sizeof(ImDrawIdx) == sizeof(uint16_t), "and so are indices");
static_assert(sizeof(ImWchar) == sizeof(uint16_t), "ranges of letters are taken as they are");
static_assert(IM_COL32(1, 2, 3, 4) == IM_RGBA(1, 2, 3, 4), "and so are colours");
static_assert(sizeof(ImGuiIO::KeysDown) / sizeof(bool) == IM_KEYS &&
                  sizeof(ImGuiIO::MouseDown) / sizeof(bool) == IM_MOUSE_BUTTONS,
              "what the header says of keys and buttons");

#define COLOR(name, theirs) ImGuiCol_##theirs,
static const ImGuiCol colors[] = {IM_COLORS(COLOR)};
#undef COLOR

static const struct {
    ImGuiKey key;
    int code;
} keys[] = {
    {ImGuiKey_Tab, GLFW_KEY_TAB}, {ImGuiKey_LeftArrow, GLFW_KEY_LEFT},
    {ImGuiKey_RightArrow, GLFW_KEY_RIGHT}, {ImGuiKey_UpArrow, GLFW_KEY_UP},
    {ImGuiKey_DownArrow, GLFW_KEY_DOWN}, {ImGuiKey_PageUp, GLFW_KEY_PAGE_UP},
    {ImGuiKey_PageDown, GLFW_KEY_PAGE_DOWN}, {ImGuiKey_Home, GLFW_KEY_HOME},
    {ImGuiKey_End, GLFW_KEY_END}, {ImGuiKey_Insert, GLFW_KEY_INSERT},
    {ImGuiKey_Delete, GLFW_KEY_DELETE}, {ImGuiKey_Backspace, GLFW_KEY_BACKSPACE},
    {ImGuiKey_Space, GLFW_KEY_SPACE}, {ImGuiKey_Enter, GLFW_KEY_ENTER},
    {ImGuiKey_Escape, GLFW_KEY_ESCAPE}, {ImGuiKey_KeyPadEnter, GLFW_KEY_KP_ENTER},
    {ImGuiKey_A, GLFW_KEY_A}, {ImGuiKey_C, GLFW_KEY_C}, {ImGuiKey_V, GLFW_KEY_V},
    {ImGuiKey_X, GLFW_KEY_X}, {ImGuiKey_Y, GLFW_KEY_Y}, {ImGuiKey_Z, GLFW_KEY_Z},
};

static ImVec2 in(im_vec v) { return ImVec2(v.x, v.y); }
static im_vec out(ImVec2 v) { return {v.x, v.y}; }
static ImGuiIO &io() { return GetIO(); }
static ImDrawList *drawn(uint32_t list) { return GetDrawData()->CmdLists[list]; }

// --- life ----------------------------------------------------------------------------------------

ImGuiContext *im_create(const char *(*get_clipboard)(void *),
                        void (*set_clipboard)(void *, const char *), void *user)
{
    ImGuiContext *context = CreateContext();
    SetCurrentContext(context);
    io().IniFilename = NULL;
    io().LogFilename = NULL;
    io().BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
    io().ConfigInputTextCursorBlink = false; // pictures of it are the same at any time
    io().ClipboardUserData = user;
    io().GetClipboardTextFn = get_clipboard;
    io().SetClipboardTextFn = set_clipboard;
    for (const auto &key : keys)
        io().KeyMap[key.key] = key.code;
    return context;
}

void im_use(ImGuiContext *context) { SetCurrentContext(context); }
void im_destroy(ImGuiContext *context) { DestroyContext(context); }

void im_style_set(const im_style *from, float scale)
{
    ImGuiStyle &to = GetStyle();
    StyleColorsDark(&to);
    to.WindowPadding = in(from->window_padding);
    to.FramePadding = in(from->frame_padding);
    to.ItemSpacing = in(from->item_spacing);
    to.ItemInnerSpacing = in(from->item_inner_spacing);
    to.IndentSpacing = from->indent;
    to.ScrollbarSize = from->scrollbar;
    to.WindowBorderSize = from->window_border;
    to.FrameRounding = from->frame_rounding;
    to.GrabRounding = from->grab_rounding;
    to.PopupRounding = from->popup_rounding;
    to.ScrollbarRounding = from->scrollbar_rounding;
    to.DisabledAlpha = from->disabled_alpha;
    to.ScaleAllSizes(scale);
}

void im_style_color(im_color color, float r, float g, float b, float a)
{
    GetStyle().Colors[colors[color]] = ImVec4(r, g, b, a);
}

im_style im_style_now(void)
{
    const ImGuiStyle &s = GetStyle();
    return {out(s.WindowPadding), out(s.FramePadding), out(s.ItemSpacing), out(s.ItemInnerSpacing),
            s.IndentSpacing, s.ScrollbarSize, s.WindowBorderSize, s.FrameRounding, s.GrabRounding,
            s.PopupRounding, s.ScrollbarRounding, s.DisabledAlpha};
}

bool im_font_file(const char *path, float pixels, const uint16_t *ranges)
{
    return io().Fonts->AddFontFromFileTTF(path, pixels, NULL, ranges) != NULL;
}

void im_font_default(float pixels)
{
    ImFontConfig config;
    config.SizePixels = pixels;
    io().Fonts->AddFontDefault(&config);
}

const uint8_t *im_font_coverage(uint32_t *width, uint32_t *height)
{
    unsigned char *coverage = NULL;
    int size[2] = {0, 0};
    io().Fonts->GetTexDataAsAlpha8(&coverage, &size[0], &size[1]);
    *width = (uint32_t)size[0];
    *height = (uint32_t)size[1];
    return coverage;
}

// --- events --------------------------------------------------------------------------------------

void im_put_mouse(float x, float y) { io().MousePos = ImVec2(x, y); }
void im_put_button(uint32_t button, bool down) { io().MouseDown[button] = down; }
void im_put_wheel(float x, float y) { io().MouseWheelH += x; io().MouseWheel += y; }
void im_put_key(int code, bool down) { io().KeysDown[code] = down; }
void im_put_no_keys(void) { memset(io().KeysDown, 0, sizeof io().KeysDown); }
void im_put_character(uint32_t code) { io().AddInputCharacter(code); }
bool im_key_is_down(int code) { return io().KeysDown[code]; }

void im_put_modifiers(bool control, bool shift, bool alt)
{
    io().KeyCtrl = control;
    io().KeyShift = shift;
    io().KeyAlt = alt;
}

// --- frames --------------------------------------------------------------------------------------

void im_frame_setup(float width, float height, float seconds)
{
    io().DisplaySize = ImVec2(width, height);
    io().DeltaTime = seconds;
}

void im_frame_begin(void) { NewFrame(); }
void im_frame_end(void) { Render(); }
im_vec im_display(void) { return out(io().DisplaySize); }
bool im_is_any_active(void) { return IsAnyItemActive(); }
bool im_wants_text(void) { return io().WantTextInput; }
uint32_t im_list_count(void) { return (uint32_t)GetDrawData()->CmdListsCount; }

im_list im_list_at(uint32_t list)
{
    const ImDrawList *from = drawn(list);
    return {reinterpret_cast<const gpu_vertex *>(from->VtxBuffer.Data), from->IdxBuffer.Data,
            (uint32_t)from->VtxBuffer.Size, (uint32_t)from->IdxBuffer.Size,
            (uint32_t)from->CmdBuffer.Size};
}

gpu_draw im_list_command(uint32_t list, uint32_t command)
{
    const ImDrawCmd &from = drawn(list)->CmdBuffer[(int)command];
    return {from.ElemCount, from.IdxOffset, from.VtxOffset,
            {from.ClipRect.x, from.ClipRect.y, from.ClipRect.z, from.ClipRect.w}};
}

// --- layout --------------------------------------------------------------------------------------

void im_panel_begin(float width, float height)
{
    SetNextWindowPos(ImVec2(0.0f, 0.0f));
    SetNextWindowSize(ImVec2(width, height));
    PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0f);
    PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1.0f, 1.0f));
    Begin("panel", NULL,
          ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
              ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
              ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoScrollWithMouse);
    PopStyleVar(2);
}

im_rect im_panel_begin_floating(const char *title, im_rect at_first)
{
    ImVec2 min(at_first.min.x, at_first.min.y), max(at_first.max.x, at_first.max.y);
    ImVec2 size(max.x - min.x, max.y - min.y);
    SetNextWindowPos(min, ImGuiCond_FirstUseEver);
    SetNextWindowSize(size, ImGuiCond_FirstUseEver);
    // Narrower or lower ones have no room for a control and its help.
    SetNextWindowSizeConstraints(ImVec2(0.6f * size.x, 0.3f * size.y), GetIO().DisplaySize);
    const ImVec4 *paint = GetStyle().Colors;
    PushStyleColor(ImGuiCol_TitleBg, paint[ImGuiCol_FrameBg]);
    PushStyleColor(ImGuiCol_TitleBgActive, paint[ImGuiCol_FrameBgHovered]);
    PushStyleColor(ImGuiCol_ResizeGrip, paint[ImGuiCol_SliderGrab]);
    PushStyleColor(ImGuiCol_ResizeGripHovered, paint[ImGuiCol_SliderGrabActive]);
    PushStyleColor(ImGuiCol_ResizeGripActive, paint[ImGuiCol_SliderGrabActive]);
    Begin(title, NULL,
          ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
              ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
    PopStyleColor(5);
    ImVec2 place = GetWindowPos(), extent = GetWindowSize();
    return {{place.x, place.y}, {place.x + extent.x, place.y + extent.y}};
}

void im_panel_end(void) { End(); }

void im_child_begin(const char *id, float height, bool is_padded)
{
    BeginChild(id, ImVec2(0.0f, height), false,
               ImGuiWindowFlags_NoNav |
                   (is_padded ? ImGuiWindowFlags_AlwaysUseWindowPadding : 0));
}

void im_child_end(void) { EndChild(); }
void im_group_begin(void) { BeginGroup(); }
void im_group_end(void) { EndGroup(); }
void im_push_id(const char *id) { PushID(id); }
void im_push_id_number(int id) { PushID(id); }
void im_pop_id(void) { PopID(); }
void im_push_disabled(bool is_disabled) { BeginDisabled(is_disabled); }
void im_pop_disabled(void) { EndDisabled(); }
void im_push_color(im_color color, uint32_t rgba) { PushStyleColor(colors[color], rgba); }

void im_push_color_of(im_color color, im_color as)
{
    PushStyleColor(colors[color], GetStyleColorVec4(colors[as]));
}

void im_pop_color(void) { PopStyleColor(); }

void im_push_padding(im_vec window, im_vec frame)
{
    PushStyleVar(ImGuiStyleVar_WindowPadding, in(window));
    PushStyleVar(ImGuiStyleVar_FramePadding, in(frame));
}

void im_pop_padding(void) { PopStyleVar(2); }
void im_push_wrap(float x) { PushTextWrapPos(x); }
void im_pop_wrap(void) { PopTextWrapPos(); }
void im_same_line(void) { SameLine(); }
void im_same_line_at(float x) { SameLine(x); }
void im_same_line_after(float space) { SameLine(0.0f, space); }
void im_separator(void) { Separator(); }
void im_indent(void) { Indent(); }
void im_unindent(void) { Unindent(); }
void im_dummy(float width, float height) { Dummy(ImVec2(width, height)); }
void im_next_width(float width) { SetNextItemWidth(width); }
im_vec im_cursor(void) { return out(GetCursorScreenPos()); }
void im_cursor_set_y(float y) { SetCursorPosY(y); }
im_vec im_window_pos(void) { return out(GetWindowPos()); }
float im_window_height(void) { return GetWindowHeight(); }
float im_room(void) { return GetContentRegionAvail().x; }
float im_line_height(void) { return GetTextLineHeight(); }
float im_line_height_spaced(void) { return GetTextLineHeightWithSpacing(); }
float im_frame_height(void) { return GetFrameHeight(); }
float im_scroll(void) { return GetScrollY(); }
void im_scroll_set(float y) { SetScrollY(y); }
void im_scroll_here(void) { SetScrollHereY(0.5f); }
uint32_t im_rgba(im_color color) { return GetColorU32(colors[color]); }

im_vec im_text_size(const char *text, float wrap)
{
    return out(CalcTextSize(text, NULL, false, wrap));
}

// --- the last item -------------------------------------------------------------------------------

im_rect im_item_rect(void) { return {out(GetItemRectMin()), out(GetItemRectMax())}; }
bool im_is_hovered(void) { return IsItemHovered(); }

bool im_is_hovered_even_disabled(void)
{
    return IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled);
}

bool im_is_active(void) { return IsItemActive(); }
bool im_is_activated(void) { return IsItemActivated(); }
bool im_is_deactivated(void) { return IsItemDeactivated(); }
bool im_is_deactivated_after_edit(void) { return IsItemDeactivatedAfterEdit(); }
bool im_is_double_clicked(void) { return IsMouseDoubleClicked(0); }
bool im_is_dragged(float threshold) { return IsMouseDragging(0, threshold); }
im_vec im_mouse_delta(void) { return out(io().MouseDelta); }
bool im_is_control_held(void) { return io().KeyCtrl; }
bool im_is_shift_held(void) { return io().KeyShift; }
void im_show_resize_cursor(void) { SetMouseCursor(ImGuiMouseCursor_ResizeEW); }

// --- widgets -------------------------------------------------------------------------------------

void im_text(const char *text) { TextUnformatted(text); }
void im_text_dim(const char *text) { TextDisabled("%s", text); }
void im_text_v(const char *format, va_list arguments) { TextV(format, arguments); }

bool im_tree(const char *label, bool is_open, bool is_framed)
{
    SetNextItemOpen(is_open);
    return TreeNodeEx("group",
                      ImGuiTreeNodeFlags_NoTreePushOnOpen | ImGuiTreeNodeFlags_SpanAvailWidth |
                          ImGuiTreeNodeFlags_FramePadding |
                          (is_framed ? ImGuiTreeNodeFlags_Framed : 0),
                      "%s", label);
}

bool im_button(const char *label) { return Button(label); }
bool im_hit(const char *id, im_vec size) { return InvisibleButton(id, in(size)); }
bool im_checkbox(const char *label, bool *value) { return Checkbox(label, value); }
bool im_selectable(const char *label, bool is_on) { return Selectable(label, is_on); }

bool im_combo_begin(const char *id, const char *shown)
{
    return BeginCombo(id, shown, ImGuiComboFlags_HeightLarge);
}

void im_combo_end(void) { EndCombo(); }
void im_focus_next(void) { SetKeyboardFocusHere(); }

void im_input(const char *id, char *text, uint32_t size)
{
    InputText(id, text, size, ImGuiInputTextFlags_AutoSelectAll);
}

bool im_color_button(const char *id, const float rgb[3], float size)
{
    return ColorButton(id, ImVec4(rgb[0], rgb[1], rgb[2], 1.0f),
                       ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoDragDrop,
                       ImVec2(size, size));
}

void im_popup_open(const char *id) { OpenPopup(id); }
bool im_popup_begin(const char *id) { return BeginPopup(id); }
void im_popup_end(void) { EndPopup(); }

bool im_color_wheel(const char *id, float rgb[3])
{
    return ColorPicker3(id, rgb,
                        ImGuiColorEditFlags_PickerHueWheel | ImGuiColorEditFlags_NoSidePreview |
                            ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoLabel |
                            ImGuiColorEditFlags_NoOptions);
}

// --- drawing -------------------------------------------------------------------------------------

ImDrawList *im_draw_window(void) { return GetWindowDrawList(); }
ImDrawList *im_draw_background(void) { return GetBackgroundDrawList(); }
ImDrawList *im_draw_foreground(void) { return GetForegroundDrawList(); }
void im_pop_clip(ImDrawList *list) { list->PopClipRect(); }

im_rect im_clip(ImDrawList *list)
{
    return {out(list->GetClipRectMin()), out(list->GetClipRectMax())};
}

void im_push_clip(ImDrawList *list, im_vec min, im_vec max, bool intersect)
{
    list->PushClipRect(in(min), in(max), intersect);
}

void im_draw_rect(ImDrawList *list, im_vec min, im_vec max, uint32_t rgba, float rounding)
{
    list->AddRectFilled(in(min), in(max), rgba, rounding);
}

void im_draw_gradient(ImDrawList *list, im_vec min, im_vec max, uint32_t left, uint32_t right)
{
    list->AddRectFilledMultiColor(in(min), in(max), left, right, right, left);
}

void im_draw_line(ImDrawList *list, im_vec from, im_vec to, uint32_t rgba, float thickness)
{
    list->AddLine(in(from), in(to), rgba, thickness);
}

void im_draw_quad(ImDrawList *list, const im_vec corners[4], uint32_t rgba)
{
    list->AddQuadFilled(in(corners[0]), in(corners[1]), in(corners[2]), in(corners[3]), rgba);
}

void im_draw_circle(ImDrawList *list, im_vec center, float radius, uint32_t rgba)
{
    list->AddCircleFilled(in(center), radius, rgba);
}

void im_draw_text(ImDrawList *list, im_vec at, uint32_t rgba, const char *text)
{
    list->AddText(in(at), rgba, text);
}

void im_draw_text_wrapped(ImDrawList *list, im_vec at, uint32_t rgba, const char *text, float wrap)
{
    list->AddText(NULL, 0.0f, in(at), rgba, text, NULL, wrap);
}
