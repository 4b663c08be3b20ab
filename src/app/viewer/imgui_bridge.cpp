// See imgui_bridge.h. The one file of C++: nothing is decided here. One line a function, which
// clang-format would make four of.
// clang-format off
#include "imgui_bridge.h"

#include <GLFW/glfw3.h>
#include <cstddef>
#include <cstring>
#include <imgui.h>

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

static const ImGuiCol colors[] = {
    ImGuiCol_Text, ImGuiCol_TextDisabled, ImGuiCol_WindowBg, ImGuiCol_ChildBg, ImGuiCol_PopupBg,
    ImGuiCol_Border, ImGuiCol_FrameBg, ImGuiCol_FrameBgHovered, ImGuiCol_FrameBgActive,
    ImGuiCol_Header, ImGuiCol_HeaderHovered, ImGuiCol_HeaderActive, ImGuiCol_Button,
    ImGuiCol_ButtonHovered, ImGuiCol_ButtonActive, ImGuiCol_CheckMark, ImGuiCol_SliderGrab,
    ImGuiCol_SliderGrabActive, ImGuiCol_Separator, ImGuiCol_ScrollbarBg, ImGuiCol_ScrollbarGrab,
    ImGuiCol_ScrollbarGrabHovered, ImGuiCol_ScrollbarGrabActive, ImGuiCol_TextSelectedBg,
    ImGuiCol_PlotLines, ImGuiCol_PlotHistogram,
};
static_assert(IM_ARRAYSIZE(colors) == IM_COLOR_COUNT, "enum im_color");

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
static ImGuiIO &io() { return ImGui::GetIO(); }
static ImDrawList *drawn(uint32_t list) { return ImGui::GetDrawData()->CmdLists[list]; }

// --- life ----------------------------------------------------------------------------------------

ImGuiContext *im_create(const char *(*get_clipboard)(void *),
                        void (*set_clipboard)(void *, const char *), void *user)
{
    ImGuiContext *context = ImGui::CreateContext();
    ImGui::SetCurrentContext(context);
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

void im_use(ImGuiContext *context) { ImGui::SetCurrentContext(context); }
void im_destroy(ImGuiContext *context) { ImGui::DestroyContext(context); }

void im_style_set(const im_style *from, float scale)
{
    ImGuiStyle &to = ImGui::GetStyle();
    ImGui::StyleColorsDark(&to);
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
    ImGui::GetStyle().Colors[colors[color]] = ImVec4(r, g, b, a);
}

im_style im_style_now(void)
{
    const ImGuiStyle &s = ImGui::GetStyle();
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

void im_frame_begin(void) { ImGui::NewFrame(); }
void im_frame_end(void) { ImGui::Render(); }
im_vec im_display(void) { return out(io().DisplaySize); }
bool im_is_any_active(void) { return ImGui::IsAnyItemActive(); }
bool im_wants_text(void) { return io().WantTextInput; }
uint32_t im_list_count(void) { return (uint32_t)ImGui::GetDrawData()->CmdListsCount; }

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
    ImGui::SetNextWindowPos(ImVec2(0.0f, 0.0f));
    ImGui::SetNextWindowSize(ImVec2(width, height));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0f);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1.0f, 1.0f));
    ImGui::Begin("panel", NULL,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
                     ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoScrollWithMouse);
    ImGui::PopStyleVar(2);
}

void im_panel_end(void) { ImGui::End(); }

void im_child_begin(const char *id, float height, bool is_padded)
{
    ImGui::BeginChild(id, ImVec2(0.0f, height), false, ImGuiWindowFlags_NoNav |
                      (is_padded ? ImGuiWindowFlags_AlwaysUseWindowPadding : 0));
}

void im_child_end(void) { ImGui::EndChild(); }
void im_group_begin(void) { ImGui::BeginGroup(); }
void im_group_end(void) { ImGui::EndGroup(); }
void im_push_id(const char *id) { ImGui::PushID(id); }
void im_push_id_number(int id) { ImGui::PushID(id); }
void im_pop_id(void) { ImGui::PopID(); }
void im_push_disabled(bool is_disabled) { ImGui::BeginDisabled(is_disabled); }
void im_pop_disabled(void) { ImGui::EndDisabled(); }

void im_push_color(im_color color, uint32_t rgba)
{
    ImGui::PushStyleColor(colors[color], rgba);
}

void im_push_color_of(im_color color, im_color as)
{
    ImGui::PushStyleColor(colors[color], ImGui::GetStyleColorVec4(colors[as]));
}

void im_pop_color(void) { ImGui::PopStyleColor(); }

void im_push_padding(im_vec window, im_vec frame)
{
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, in(window));
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, in(frame));
}

void im_pop_padding(void) { ImGui::PopStyleVar(2); }
void im_push_wrap(float x) { ImGui::PushTextWrapPos(x); }
void im_pop_wrap(void) { ImGui::PopTextWrapPos(); }
void im_same_line(void) { ImGui::SameLine(); }
void im_same_line_at(float x) { ImGui::SameLine(x); }
void im_same_line_after(float space) { ImGui::SameLine(0.0f, space); }
void im_separator(void) { ImGui::Separator(); }
void im_indent(void) { ImGui::Indent(); }
void im_unindent(void) { ImGui::Unindent(); }
void im_dummy(float width, float height) { ImGui::Dummy(ImVec2(width, height)); }
void im_next_width(float width) { ImGui::SetNextItemWidth(width); }
im_vec im_cursor(void) { return out(ImGui::GetCursorScreenPos()); }
void im_cursor_set_y(float y) { ImGui::SetCursorPosY(y); }
im_vec im_window_pos(void) { return out(ImGui::GetWindowPos()); }
float im_window_height(void) { return ImGui::GetWindowHeight(); }
float im_room(void) { return ImGui::GetContentRegionAvail().x; }
float im_line_height(void) { return ImGui::GetTextLineHeight(); }
float im_line_height_spaced(void) { return ImGui::GetTextLineHeightWithSpacing(); }
float im_frame_height(void) { return ImGui::GetFrameHeight(); }
float im_scroll(void) { return ImGui::GetScrollY(); }
void im_scroll_set(float y) { ImGui::SetScrollY(y); }
void im_scroll_here(void) { ImGui::SetScrollHereY(0.5f); }
uint32_t im_rgba(im_color color) { return ImGui::GetColorU32(colors[color]); }

im_vec im_text_size(const char *text, float wrap)
{
    return out(ImGui::CalcTextSize(text, NULL, false, wrap));
}

// --- the last item -------------------------------------------------------------------------------

im_rect im_item_rect(void) { return {out(ImGui::GetItemRectMin()), out(ImGui::GetItemRectMax())}; }
bool im_is_hovered(void) { return ImGui::IsItemHovered(); }

bool im_is_hovered_even_disabled(void)
{
    return ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled);
}

bool im_is_active(void) { return ImGui::IsItemActive(); }
bool im_is_activated(void) { return ImGui::IsItemActivated(); }
bool im_is_deactivated(void) { return ImGui::IsItemDeactivated(); }
bool im_is_deactivated_after_edit(void) { return ImGui::IsItemDeactivatedAfterEdit(); }
bool im_is_double_clicked(void) { return ImGui::IsMouseDoubleClicked(0); }
bool im_is_dragged(float threshold) { return ImGui::IsMouseDragging(0, threshold); }
im_vec im_mouse_delta(void) { return out(io().MouseDelta); }
bool im_is_control_held(void) { return io().KeyCtrl; }
bool im_is_shift_held(void) { return io().KeyShift; }
void im_show_resize_cursor(void) { ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW); }

// --- widgets -------------------------------------------------------------------------------------

void im_text(const char *text) { ImGui::TextUnformatted(text); }
void im_text_dim(const char *text) { ImGui::TextDisabled("%s", text); }
void im_text_v(const char *format, va_list arguments) { ImGui::TextV(format, arguments); }

bool im_tree(const char *label, bool is_open, bool is_framed)
{
    ImGui::SetNextItemOpen(is_open);
    return ImGui::TreeNodeEx("group", ImGuiTreeNodeFlags_NoTreePushOnOpen |
                             ImGuiTreeNodeFlags_SpanAvailWidth | ImGuiTreeNodeFlags_FramePadding |
                             (is_framed ? ImGuiTreeNodeFlags_Framed : 0), "%s", label);
}

bool im_button(const char *label) { return ImGui::Button(label); }
bool im_hit(const char *id, im_vec size) { return ImGui::InvisibleButton(id, in(size)); }
bool im_checkbox(const char *label, bool *value) { return ImGui::Checkbox(label, value); }
bool im_selectable(const char *label, bool is_on) { return ImGui::Selectable(label, is_on); }

bool im_combo_begin(const char *id, const char *shown)
{
    return ImGui::BeginCombo(id, shown, ImGuiComboFlags_HeightLarge);
}

void im_combo_end(void) { ImGui::EndCombo(); }
void im_focus_next(void) { ImGui::SetKeyboardFocusHere(); }

void im_input(const char *id, char *text, uint32_t size)
{
    ImGui::InputText(id, text, size, ImGuiInputTextFlags_AutoSelectAll);
}

bool im_color_button(const char *id, const float rgb[3], float size)
{
    return ImGui::ColorButton(id, ImVec4(rgb[0], rgb[1], rgb[2], 1.0f),
                              ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoDragDrop,
                              ImVec2(size, size));
}

void im_popup_open(const char *id) { ImGui::OpenPopup(id); }
bool im_popup_begin(const char *id) { return ImGui::BeginPopup(id); }
void im_popup_end(void) { ImGui::EndPopup(); }

bool im_color_wheel(const char *id, float rgb[3])
{
    return ImGui::ColorPicker3(id, rgb,
                               ImGuiColorEditFlags_PickerHueWheel |
                                   ImGuiColorEditFlags_NoSidePreview |
                                   ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoLabel |
                                   ImGuiColorEditFlags_NoOptions);
}

// --- drawing -------------------------------------------------------------------------------------

ImDrawList *im_draw_window(void) { return ImGui::GetWindowDrawList(); }
ImDrawList *im_draw_background(void) { return ImGui::GetBackgroundDrawList(); }
ImDrawList *im_draw_foreground(void) { return ImGui::GetForegroundDrawList(); }
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
