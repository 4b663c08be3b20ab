// See imgui_bridge.h. This is the only C++ file, and it makes no decisions.
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

struct im {
    ImGuiContext *context;
    ImVector<gpu_vertex> vertices;
    ImVector<uint16_t> indices;
    ImVector<gpu_draw> draws;
};

static ImVec2 in(im_vec v)
{
    return ImVec2(v.x, v.y);
}

static im_vec out(ImVec2 v)
{
    return {v.x, v.y};
}

static im_rect out(ImVec2 min, ImVec2 max)
{
    return {min.x, min.y, max.x, max.y};
}

// --- creation and end ----------------------------------------------------------------------------

static void set_colors()
{
    static const struct {
        ImGuiCol color;
        uint32_t rgba;
    } table[] = {
        {ImGuiCol_Text, IM_TEXT},
        {ImGuiCol_TextDisabled, IM_DIM},
        {ImGuiCol_WindowBg, IM_GRAY(0.095f, 0.97f)},
        {ImGuiCol_ChildBg, 0},
        {ImGuiCol_PopupBg, IM_POPUP},
        {ImGuiCol_Border, IM_GRAY(0.25f, 0.6f)},
        {ImGuiCol_FrameBg, IM_FRAME},
        {ImGuiCol_FrameBgHovered, IM_GRAY(0.23f, 1.0f)},
        {ImGuiCol_FrameBgActive, IM_GRAY(0.27f, 1.0f)},
        {ImGuiCol_Header, IM_GRAY(0.15f, 1.0f)},
        {ImGuiCol_HeaderHovered, IM_GRAY(0.22f, 1.0f)},
        {ImGuiCol_HeaderActive, IM_GRAY(0.26f, 1.0f)},
        {ImGuiCol_Button, IM_GRAY(0.21f, 1.0f)},
        {ImGuiCol_ButtonHovered, IM_GRAY(0.28f, 1.0f)},
        {ImGuiCol_ButtonActive, IM_GRAY(0.33f, 1.0f)},
        {ImGuiCol_CheckMark, IM_GLOW},
        {ImGuiCol_TextSelectedBg, IM_DIM_GLOW},
        {ImGuiCol_Separator, IM_LINE},
        {ImGuiCol_TitleBg, IM_FRAME},
        {ImGuiCol_TitleBgActive, IM_GRAY(0.23f, 1.0f)},
        {ImGuiCol_ResizeGrip, IM_DIM_GLOW},
        {ImGuiCol_ResizeGripHovered, IM_GLOW},
        {ImGuiCol_ResizeGripActive, IM_GLOW},
        {ImGuiCol_ScrollbarBg, 0},
        {ImGuiCol_ScrollbarGrab, IM_GRAY(0.24f, 1.0f)},
        {ImGuiCol_ScrollbarGrabHovered, IM_GRAY(0.30f, 1.0f)},
        {ImGuiCol_ScrollbarGrabActive, IM_GRAY(0.36f, 1.0f)},
    };
    StyleColorsDark();
    for (const auto &row : table)
        GetStyle().Colors[row.color] = ColorConvertU32ToFloat4(row.rgba);
}

static void set_style(float scale)
{
    ImGuiStyle &style = GetStyle();
    set_colors();
    style.WindowPadding = ImVec2(8.0f, 8.0f);
    style.FramePadding = ImVec2(6.0f, 3.0f);
    style.ItemSpacing = ImVec2(6.0f, 4.0f);
    style.ItemInnerSpacing = ImVec2(4.0f, 4.0f);
    style.IndentSpacing = 8.0f;
    style.ScrollbarSize = 9.0f;
    style.WindowBorderSize = 0.0f;
    style.FrameRounding = style.GrabRounding = style.PopupRounding = 3.0f;
    style.ScrollbarRounding = 4.0f;
    style.DisabledAlpha = 0.42f;
    style.ScaleAllSizes(scale);
}

static void set_keys(ImGuiIO &io)
{
    static const struct {
        ImGuiKey key;
        int code;
    } keys[] = {
        {ImGuiKey_Tab, GLFW_KEY_TAB},
        {ImGuiKey_LeftArrow, GLFW_KEY_LEFT},
        {ImGuiKey_RightArrow, GLFW_KEY_RIGHT},
        {ImGuiKey_UpArrow, GLFW_KEY_UP},
        {ImGuiKey_DownArrow, GLFW_KEY_DOWN},
        {ImGuiKey_PageUp, GLFW_KEY_PAGE_UP},
        {ImGuiKey_PageDown, GLFW_KEY_PAGE_DOWN},
        {ImGuiKey_Home, GLFW_KEY_HOME},
        {ImGuiKey_End, GLFW_KEY_END},
        {ImGuiKey_Insert, GLFW_KEY_INSERT},
        {ImGuiKey_Delete, GLFW_KEY_DELETE},
        {ImGuiKey_Backspace, GLFW_KEY_BACKSPACE},
        {ImGuiKey_Space, GLFW_KEY_SPACE},
        {ImGuiKey_Enter, GLFW_KEY_ENTER},
        {ImGuiKey_Escape, GLFW_KEY_ESCAPE},
        {ImGuiKey_KeyPadEnter, GLFW_KEY_KP_ENTER},
        {ImGuiKey_A, GLFW_KEY_A},
        {ImGuiKey_C, GLFW_KEY_C},
        {ImGuiKey_V, GLFW_KEY_V},
        {ImGuiKey_X, GLFW_KEY_X},
        {ImGuiKey_Y, GLFW_KEY_Y},
        {ImGuiKey_Z, GLFW_KEY_Z},
    };
    for (const auto &key : keys)
        io.KeyMap[key.key] = key.code;
}

im *im_create(float scale)
{
    im *im = IM_NEW(struct im)();
    im->context = CreateContext();
    SetCurrentContext(im->context);
    ImGuiIO &io = GetIO();
    io.IniFilename = NULL;
    io.LogFilename = NULL;
    io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
    io.ConfigInputTextCursorBlink = false; // images of the panel do not depend on the time
    io.MouseDragThreshold = 3.0f * scale; // a shorter movement is a click
    set_keys(io);
    set_style(scale);
    return im;
}

void im_destroy(im *im)
{
    if (im)
        DestroyContext(im->context);
    IM_DELETE(im);
}

bool im_font(const char *path, float pixels, const uint16_t *ranges)
{
    ImFontConfig config;
    config.SizePixels = pixels;
    ImFontAtlas *fonts = GetIO().Fonts;
    return path ? fonts->AddFontFromFileTTF(path, pixels, NULL, ranges)
                : fonts->AddFontDefault(&config);
}

bool im_atlas(gpu_atlas *out)
{
    unsigned char *coverage = NULL;
    int width = 0, height = 0;
    GetIO().Fonts->GetTexDataAsAlpha8(&coverage, &width, &height);
    *out = {coverage, (uint32_t)width, (uint32_t)height};
    return coverage != NULL;
}

// --- frames --------------------------------------------------------------------------------------

void im_put(im *im, const event *event)
{
    SetCurrentContext(im->context);
    ImGuiIO &io = GetIO();
    const bool *held = io.KeysDown;
    if (event->kind == EVENT_MOVE) {
        io.MousePos = ImVec2((float)event->x, (float)event->y);
    } else if (event->kind == EVENT_BUTTON) {
        io.MouseDown[event->code] = event->down;
    } else if (event->kind == EVENT_SCROLL) { // scrolls the window under the mouse, if there is one
        io.MouseWheelH += (float)event->x;
        io.MouseWheel += (float)event->y;
    } else if (event->kind == EVENT_KEY) {
        io.KeysDown[event->code] = event->down;
    } else if (event->kind == EVENT_TEXT) {
        io.AddInputCharacter((unsigned)event->code);
    } else if (event->kind == EVENT_FOCUS && !event->down) {
        memset(io.KeysDown, 0, sizeof io.KeysDown);
    }
    // Modifiers are held if this event or earlier key events say so.
    bool has_them = (event->kind == EVENT_KEY || event->kind == EVENT_BUTTON) && event->down;
    uint32_t with = has_them ? event->modifiers : 0;
    io.KeyCtrl =
        held[GLFW_KEY_LEFT_CONTROL] || held[GLFW_KEY_RIGHT_CONTROL] || with & EVENT_CONTROL;
    io.KeyShift = held[GLFW_KEY_LEFT_SHIFT] || held[GLFW_KEY_RIGHT_SHIFT] || with & EVENT_SHIFT;
    io.KeyAlt = held[GLFW_KEY_LEFT_ALT] || held[GLFW_KEY_RIGHT_ALT] || with & EVENT_ALT;
}

void im_begin(im *im, float width, float height, float seconds)
{
    SetCurrentContext(im->context);
    GetIO().DisplaySize = ImVec2(width, height);
    GetIO().DeltaTime = seconds;
    NewFrame();
}

template <typename To, typename From>
static void append(ImVector<To> *to, const ImVector<From> &from)
{
    const int before = to->Size;
    to->resize(before + from.Size);
    if (from.Size)
        memcpy(to->Data + before, from.Data, (size_t)from.size_in_bytes());
}

void im_end(im *im, gpu_drawing *out, bool *is_busy, bool *is_typing)
{
    Render();
    const ImDrawData *data = GetDrawData();
    const ImVec2 size = GetIO().DisplaySize;
    im->vertices.resize(0);
    im->indices.resize(0);
    im->draws.resize(0);
    for (int list = 0; list < data->CmdListsCount; list++) {
        const ImDrawList *from = data->CmdLists[list];
        for (const ImDrawCmd &command : from->CmdBuffer) {
            const ImVec4 clip = command.ClipRect;
            const gpu_draw draw = {command.ElemCount,
                                   command.IdxOffset + (uint32_t)im->indices.Size,
                                   command.VtxOffset + (uint32_t)im->vertices.Size,
                                   {clip.x > 0.0f ? clip.x : 0.0f, clip.y > 0.0f ? clip.y : 0.0f,
                                    clip.z < size.x ? clip.z : size.x,
                                    clip.w < size.y ? clip.w : size.y}};
            if (draw.index_count && draw.clip[0] < draw.clip[2] && draw.clip[1] < draw.clip[3])
                im->draws.push_back(draw);
        }
        append(&im->vertices, from->VtxBuffer);
        append(&im->indices, from->IdxBuffer);
    }
    *out = {im->vertices.Data,           im->indices.Data,           im->draws.Data,
            (uint32_t)im->vertices.Size, (uint32_t)im->indices.Size, (uint32_t)im->draws.Size};
    *is_busy = IsAnyItemActive();
    *is_typing = GetIO().WantTextInput;
}

// --- layout --------------------------------------------------------------------------------------

struct im_place im_now(void)
{
    const ImGuiStyle &style = GetStyle();
    struct im_place now = {};
    now.display = out(GetIO().DisplaySize);
    now.window = out(GetWindowPos());
    now.cursor = out(GetCursorScreenPos());
    now.window_height = GetWindowHeight();
    now.scroll = GetScrollY();
    now.room = GetContentRegionAvail().x;
    now.line = GetTextLineHeight();
    now.line_spaced = GetTextLineHeightWithSpacing();
    now.frame = GetFrameHeight();
    now.window_padding = out(style.WindowPadding);
    now.frame_padding = out(style.FramePadding);
    now.spacing = out(style.ItemSpacing);
    now.inner_spacing = style.ItemInnerSpacing.x;
    now.rounding = style.FrameRounding;
    return now;
}

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

struct im_rect im_panel_begin_floating(const char *title, im_rect at_first)
{
    const ImVec2 size(at_first.right - at_first.left, at_first.bottom - at_first.top);
    SetNextWindowPos(ImVec2(at_first.left, at_first.top), ImGuiCond_FirstUseEver);
    SetNextWindowSize(size, ImGuiCond_FirstUseEver);
    // A smaller window has no room for a control and its help.
    SetNextWindowSizeConstraints(ImVec2(0.6f * size.x, 0.3f * size.y), GetIO().DisplaySize);
    Begin(title, NULL,
          ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
              ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
    const ImVec2 at = GetWindowPos(), extent = GetWindowSize();
    return {at.x, at.y, at.x + extent.x, at.y + extent.y};
}

void im_panel_end(void)
{
    End();
}

void im_child_begin(const char *id, float height, bool is_list)
{
    const ImGuiStyle &style = GetStyle();
    if (is_list) {
        const ImVec2 padding = style.FramePadding;
        PushStyleColor(ImGuiCol_ChildBg, IM_POPUP);
        PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(style.WindowPadding.x, padding.y));
        PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(padding.x, 0.0f));
    }
    BeginChild(id, ImVec2(0.0f, height), false,
               ImGuiWindowFlags_NoNav |
                   (is_list ? ImGuiWindowFlags_AlwaysUseWindowPadding : ImGuiWindowFlags_None));
    if (is_list)
        PopStyleColor();
}

void im_child_end(bool is_list)
{
    PopStyleVar(is_list ? 2 : 0);
    EndChild();
}

void im_item_begin(const char *id, bool is_disabled)
{
    PushID(id);
    BeginDisabled(is_disabled);
}

void im_item_end(void)
{
    EndDisabled();
    PopID();
}

void im_group_begin(void)
{
    BeginGroup();
}

void im_group_end(void)
{
    EndGroup();
}

void im_same_line(float at, float space)
{
    SameLine(at, space);
}

void im_separator(void)
{
    Separator();
}

void im_indent(int levels)
{
    Indent((float)levels * GetStyle().IndentSpacing);
}

void im_dummy(float width, float height)
{
    Dummy(ImVec2(width, height));
}

void im_cursor_set_y(float y)
{
    SetCursorPosY(y);
}

void im_scroll_set(float y)
{
    SetScrollY(y);
}

void im_scroll_here(void)
{
    SetScrollHereY(0.5f);
}

// --- items ---------------------------------------------------------------------------------------

struct im_item im_last(void)
{
    const ImGuiIO &io = GetIO();
    const ImDrawList *list = GetWindowDrawList();
    struct im_item last = {};
    last.box = out(GetItemRectMin(), GetItemRectMax());
    last.clip = out(list->GetClipRectMin(), list->GetClipRectMax());
    last.is_hovered = IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled);
    last.is_active = IsItemActive();
    last.was_activated = IsItemActivated();
    last.was_deactivated = IsItemDeactivated();
    last.was_edited = IsItemDeactivatedAfterEdit();
    last.is_double_clicked = IsMouseDoubleClicked(0);
    last.has_control = io.KeyCtrl;
    last.is_dragged = last.is_active && IsMouseDragging(0);
    if (last.is_dragged)
        last.drag = io.MouseDelta.x * (io.KeyShift ? 0.1f : 1.0f);
    return last;
}

void im_text(uint32_t rgba, float wrap, const char *format, va_list arguments)
{
    PushStyleColor(ImGuiCol_Text, rgba);
    PushTextWrapPos(wrap);
    TextV(format, arguments);
    PopTextWrapPos();
    PopStyleColor();
}

im_vec im_text_size(const char *text, float wrap)
{
    return out(CalcTextSize(text, NULL, false, wrap));
}

bool im_tree(const char *label, bool is_open, bool is_framed)
{
    SetNextItemOpen(is_open);
    return TreeNodeEx("group",
                      ImGuiTreeNodeFlags_NoTreePushOnOpen | ImGuiTreeNodeFlags_SpanAvailWidth |
                          ImGuiTreeNodeFlags_FramePadding |
                          (is_framed ? ImGuiTreeNodeFlags_Framed : ImGuiTreeNodeFlags_None),
                      "%s", label);
}

bool im_button(const char *label, im_vec size, bool is_field)
{
    static const ImGuiCol frames[] = {ImGuiCol_FrameBg, ImGuiCol_FrameBgHovered,
                                      ImGuiCol_FrameBgActive};
    for (int i = 0; is_field && i < 3; i++)
        PushStyleColor(ImGuiCol_Button + i, GetStyleColorVec4(frames[i]));
    bool is_pressed = Button(label, in(size));
    PopStyleColor(is_field ? 3 : 0);
    return is_pressed;
}

bool im_tab(const char *label, im_vec size, bool is_on)
{
    PushStyleColor(ImGuiCol_Text, is_on ? IM_GLOW : IM_TEXT);
    PushStyleColor(ImGuiCol_Button,
                   GetStyleColorVec4(is_on ? ImGuiCol_ButtonHovered : ImGuiCol_FrameBg));
    bool is_pressed = Button(label, in(size));
    PopStyleColor(2);
    return is_pressed;
}

bool im_checkbox(const char *label, bool *value)
{
    return Checkbox(label, value);
}

bool im_row(const char *label, bool is_on)
{
    PushStyleColor(ImGuiCol_Text, is_on ? IM_GLOW : IM_TEXT);
    bool is_pressed = Selectable(label, is_on);
    PopStyleColor();
    return is_pressed;
}

bool im_combo_begin(const char *id, const char *shown)
{
    SetNextItemWidth(-FLT_MIN);
    return BeginCombo(id, shown, ImGuiComboFlags_HeightLarge);
}

void im_combo_end(void)
{
    EndCombo();
}

void im_input(const char *id, char *text, uint32_t size, float width, bool takes_focus)
{
    if (takes_focus)
        SetKeyboardFocusHere();
    SetNextItemWidth(width);
    InputText(id, text, size, ImGuiInputTextFlags_AutoSelectAll);
}

bool im_color(const char *id, float rgb[3], float size, float width, bool *is_open)
{
    if (ColorButton(id, ImVec4(rgb[0], rgb[1], rgb[2], 1.0f),
                    ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoDragDrop,
                    ImVec2(size, size)))
        OpenPopup("wheel");
    *is_open = BeginPopup("wheel");
    if (!*is_open)
        return false;
    SetNextItemWidth(width);
    bool is_changed =
        ColorPicker3("##wheel", rgb,
                     ImGuiColorEditFlags_PickerHueWheel | ImGuiColorEditFlags_NoSidePreview |
                         ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoLabel |
                         ImGuiColorEditFlags_NoOptions);
    EndPopup();
    return is_changed;
}

// --- drawing -------------------------------------------------------------------------------------

ImDrawList *im_layer(enum im_layer layer)
{
    return layer == IM_WINDOW       ? GetWindowDrawList()
           : layer == IM_BACKGROUND ? GetBackgroundDrawList()
                                    : GetForegroundDrawList();
}

void im_clip_begin(ImDrawList *list, im_rect clip)
{
    list->PushClipRect(ImVec2(clip.left, clip.top), ImVec2(clip.right, clip.bottom), true);
}

void im_clip_end(ImDrawList *list)
{
    list->PopClipRect();
}

void im_draw_rect(ImDrawList *list, im_rect box, uint32_t rgba, float rounding)
{
    list->AddRectFilled(ImVec2(box.left, box.top), ImVec2(box.right, box.bottom), GetColorU32(rgba),
                        rounding);
}

void im_draw_gradient(ImDrawList *list, im_rect box, uint32_t left, uint32_t right)
{
    list->AddRectFilledMultiColor(ImVec2(box.left, box.top), ImVec2(box.right, box.bottom), left,
                                  right, right, left);
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

void im_draw_text(ImDrawList *list, float x, float y, uint32_t rgba, const char *text,
                  const im_rect *clip, float wrap)
{
    const ImVec4 box = clip ? ImVec4(clip->left, clip->top, clip->right, clip->bottom) : ImVec4();
    list->AddText(NULL, 0.0f, ImVec2(x, y), GetColorU32(rgba), text, NULL, wrap,
                  clip ? &box : NULL);
}
