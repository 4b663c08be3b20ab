// Dear ImGui as the panel uses it: created, fed with events, laid out, and turned into triangles.
// Only its core: windows and devices are this program's own.
extern "C" {
#include "gui_state.h"
}

#include <GLFW/glfw3.h>
#include <cmath>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <imgui.h>

static_assert(sizeof(gpu_vertex) == sizeof(ImDrawVert) &&
                  offsetof(gpu_vertex, uv) == offsetof(ImDrawVert, uv) &&
                  offsetof(gpu_vertex, color) == offsetof(ImDrawVert, col),
              "vertices are copied as they are");
static_assert(sizeof(ImDrawIdx) == sizeof(uint16_t), "and so are indices");

// Letters, points: what fits a column of some forty letters into a panel of 320 points.
#define FONT_POINTS 13.0f
#define PANEL_POINTS 340.0f
#define PANEL_PART 0.4f // of the window's width, at most
#define HELP_LINES 3.0f

// --- looks ---------------------------------------------------------------------------------------

static ImVec4 gray(float value, float alpha)
{
    return ImVec4(value * 0.97f, value, value * 1.04f, alpha);
}

static void set_colors(ImGuiStyle *style)
{
    ImGui::StyleColorsDark(style);
    ImVec4 *c = style->Colors;
    const ImVec4 glow(0.66f, 0.79f, 0.33f, 1.0f); // of a glow-worm
    const ImVec4 dim_glow(0.45f, 0.55f, 0.22f, 0.55f);
    c[ImGuiCol_Text] = gray(0.86f, 1.0f);
    c[ImGuiCol_TextDisabled] = gray(0.53f, 1.0f);
    c[ImGuiCol_WindowBg] = gray(0.095f, 0.97f);
    c[ImGuiCol_ChildBg] = ImVec4(0.0f, 0.0f, 0.0f, 0.0f);
    c[ImGuiCol_PopupBg] = gray(0.12f, 0.99f);
    c[ImGuiCol_Border] = gray(0.25f, 0.6f);
    c[ImGuiCol_FrameBg] = gray(0.17f, 1.0f);
    c[ImGuiCol_FrameBgHovered] = gray(0.23f, 1.0f);
    c[ImGuiCol_FrameBgActive] = gray(0.27f, 1.0f);
    c[ImGuiCol_Header] = gray(0.15f, 1.0f);
    c[ImGuiCol_HeaderHovered] = gray(0.22f, 1.0f);
    c[ImGuiCol_HeaderActive] = gray(0.26f, 1.0f);
    c[ImGuiCol_Button] = gray(0.21f, 1.0f);
    c[ImGuiCol_ButtonHovered] = gray(0.28f, 1.0f);
    c[ImGuiCol_ButtonActive] = gray(0.33f, 1.0f);
    c[ImGuiCol_CheckMark] = glow;
    c[ImGuiCol_SliderGrab] = dim_glow;
    c[ImGuiCol_SliderGrabActive] = glow;
    c[ImGuiCol_Separator] = gray(0.22f, 1.0f);
    c[ImGuiCol_ScrollbarBg] = ImVec4(0.0f, 0.0f, 0.0f, 0.0f);
    c[ImGuiCol_ScrollbarGrab] = gray(0.24f, 1.0f);
    c[ImGuiCol_ScrollbarGrabHovered] = gray(0.30f, 1.0f);
    c[ImGuiCol_ScrollbarGrabActive] = gray(0.36f, 1.0f);
    c[ImGuiCol_TextSelectedBg] = dim_glow;
    c[ImGuiCol_PlotLines] = glow;
    c[ImGuiCol_PlotHistogram] = dim_glow;
}

static void set_style(float scale)
{
    ImGuiStyle *style = &ImGui::GetStyle();
    set_colors(style);
    style->WindowPadding = ImVec2(8.0f, 8.0f);
    style->FramePadding = ImVec2(6.0f, 3.0f);
    style->ItemSpacing = ImVec2(6.0f, 4.0f);
    style->ItemInnerSpacing = ImVec2(4.0f, 4.0f);
    style->IndentSpacing = 8.0f;
    style->ScrollbarSize = 9.0f;
    style->FrameRounding = 3.0f;
    style->GrabRounding = 3.0f;
    style->PopupRounding = 3.0f;
    style->ScrollbarRounding = 4.0f;
    style->WindowBorderSize = 0.0f;
    style->DisabledAlpha = 0.42f;
    style->ScaleAllSizes(scale);
}

// The distribution's font where it is, with the letters of most names; else the one that Dear ImGui
// has within itself.
static void add_font(ImFontAtlas *fonts, float pixels)
{
    static const char *const paths[] = {
        "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
        "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
        "/usr/share/fonts/TTF/DejaVuSans.ttf",
    };
    // Latin, Greek, Cyrillic; dashes and quotation marks, arrows, a few signs of mathematics.
    static const ImWchar ranges[] = {0x20,   0x24f,  0x370,  0x3ff,  0x400,  0x45f,
                                     0x2010, 0x2026, 0x2070, 0x209c, 0x2190, 0x2193,
                                     0x2202, 0x2265, 0x25b4, 0x25c3, 0};
    for (const char *path : paths) {
        FILE *file = fopen(path, "rb");
        if (!file)
            continue;
        fclose(file);
        if (fonts->AddFontFromFileTTF(path, pixels, NULL, ranges))
            return;
    }
    ImFontConfig config;
    config.SizePixels = pixels;
    fonts->AddFontDefault(&config);
}

static bool make_atlas(struct gui_state *own, struct err *err)
{
    ImFontAtlas *fonts = ImGui::GetIO().Fonts;
    add_font(fonts, floorf(FONT_POINTS * own->scale + 0.5f));
    unsigned char *coverage = NULL;
    int width = 0, height = 0;
    fonts->GetTexDataAsAlpha8(&coverage, &width, &height);
    if (!coverage)
        return err_memory(err, "letters", (unsigned long long)width * (unsigned)height);
    own->coverage = coverage;
    own->atlas_width = (uint32_t)width;
    own->atlas_height = (uint32_t)height;
    return true;
}

// --- life ----------------------------------------------------------------------------------------

static const char *get_clipboard(void *user)
{
    const struct gui_state *own = static_cast<const struct gui_state *>(user);
    return own->clipboard ? own->clipboard : "";
}

static void set_clipboard(void *user, const char *text)
{
    struct gui_state *own = static_cast<struct gui_state *>(user);
    char *copy = strdup(text);
    if (!copy)
        return; // the old text stays
    free(own->clipboard);
    own->clipboard = copy;
}

static void set_keys(ImGuiIO *io)
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
        io->KeyMap[key.key] = key.code;
}

bool gui_create(float scale, struct gui *out, struct err *err)
{
    memset(out, 0, sizeof *out);
    struct gui_state *own = static_cast<struct gui_state *>(calloc(1, sizeof *own));
    if (!own)
        return err_memory(err, "panel", sizeof *own);
    out->own = own;
    own->scale = scale;
    own->mouse[0] = own->mouse[1] = -1.0;
    ImGuiContext *context = ImGui::CreateContext();
    own->context = context;
    ImGui::SetCurrentContext(context);
    ImGuiIO &io = ImGui::GetIO();
    io.IniFilename = NULL;
    io.LogFilename = NULL;
    io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
    io.ConfigInputTextCursorBlink = false; // pictures of it are the same at any time
    io.ClipboardUserData = own;
    io.GetClipboardTextFn = get_clipboard;
    io.SetClipboardTextFn = set_clipboard;
    set_keys(&io);
    set_style(scale);
    if (!make_atlas(own, err)) {
        gui_finish(out);
        return false;
    }
    return true;
}

void gui_finish(struct gui *gui)
{
    struct gui_state *own = gui ? gui->own : NULL;
    if (!own)
        return;
    ImGui::DestroyContext(static_cast<ImGuiContext *>(own->context));
    free(own->clipboard);
    free(own->vertices);
    free(own->indices);
    free(own->draws);
    free(own);
    memset(gui, 0, sizeof *gui);
}

void gui_atlas(struct gui *gui, struct gpu_atlas *out)
{
    out->coverage = gui->own->coverage;
    out->width = gui->own->atlas_width;
    out->height = gui->own->atlas_height;
}

// --- events --------------------------------------------------------------------------------------
// Dear ImGui takes what is held at the time of a frame. What follows each other within one frame
// (pressed and let go) therefore waits for the next one.

static bool is_over_panel(const struct gui *gui)
{
    return gui->own->mouse[0] >= 0.0 && gui->own->mouse[0] < (double)gui->width;
}

// Who gets the next event of the mouse: what was pressed elsewhere is moved and let go there.
static void update_wants(struct gui *gui)
{
    const struct gui_state *own = gui->own;
    gui->wants_mouse =
        !own->buttons_elsewhere && (is_over_panel(gui) || own->has_popup || gui->is_busy);
}

void gui_event(struct gui *gui, const struct event *event)
{
    struct gui_state *own = gui->own;
    if (event->kind == EVENT_MOVE) {
        own->mouse[0] = event->x;
        own->mouse[1] = event->y;
    } else if (event->kind == EVENT_BUTTON && event->code >= 0 && event->code < 32) {
        uint32_t bit = 1u << event->code;
        if (!event->down)
            own->buttons_elsewhere &= ~bit;
        else if (!gui->wants_mouse)
            own->buttons_elsewhere |= bit;
    } else if (event->kind == EVENT_FOCUS) {
        own->buttons_elsewhere = 0;
    }
    // The event that lets go of a button goes where the button was pressed.
    bool let_go_elsewhere = event->kind == EVENT_BUTTON && !event->down && !gui->wants_mouse;
    update_wants(gui);
    if (let_go_elsewhere)
        gui->wants_mouse = false;
    if (own->event_count < GUI_EVENTS_MAX) {
        uint32_t place = (own->event_first + own->event_count++) % GUI_EVENTS_MAX;
        own->events[place] = *event;
        own->events[place].path = NULL;
    }
}

// What of a frame's events came already.
struct fed {
    uint32_t buttons;
    int keys[32];
    uint32_t key_count;
    bool special_key, text, moved;
};

static bool must_wait(const struct fed *fed, const struct event *event)
{
    switch (event->kind) {
    case EVENT_MOVE:
        return fed->buttons != 0; // a click is where the mouse was then
    case EVENT_BUTTON: // a drag ends where the mouse was let go, and is seen to get there
        return (fed->buttons >> event->code & 1u) || (fed->moved && !event->down);
    case EVENT_KEY:
        for (uint32_t i = 0; i < fed->key_count; i++)
            if (fed->keys[i] == event->code)
                return true;
        return fed->key_count == 32 || (fed->text && event->code >= GLFW_KEY_ESCAPE);
    case EVENT_TEXT:
        return fed->special_key;
    default:
        return false;
    }
}

static void feed_key(ImGuiIO *io, struct fed *fed, const struct event *event)
{
    if (event->code < 0 || event->code >= IM_ARRAYSIZE(io->KeysDown))
        return;
    io->KeysDown[event->code] = event->down;
    fed->keys[fed->key_count++] = event->code;
    fed->special_key |= event->code >= GLFW_KEY_ESCAPE && event->code < GLFW_KEY_LEFT_SHIFT;
}

static void feed_one(ImGuiIO *io, struct fed *fed, const struct event *event)
{
    switch (event->kind) {
    case EVENT_MOVE:
        io->MousePos = ImVec2((float)event->x, (float)event->y);
        fed->moved = true;
        break;
    case EVENT_BUTTON:
        io->MouseDown[event->code] = event->down;
        fed->buttons |= 1u << event->code;
        break;
    case EVENT_SCROLL:
        io->MouseWheel += (float)event->y; // moves what the mouse is over, if anything
        io->MouseWheelH += (float)event->x;
        break;
    case EVENT_KEY:
        feed_key(io, fed, event);
        break;
    case EVENT_TEXT:
        io->AddInputCharacter((unsigned)event->code);
        fed->text = true;
        break;
    case EVENT_FOCUS:
        if (!event->down)
            memset(io->KeysDown, 0, sizeof io->KeysDown);
        break;
    default:
        break;
    }
    bool has_modifiers = event->kind == EVENT_KEY || event->kind == EVENT_BUTTON;
    io->KeyCtrl = io->KeysDown[GLFW_KEY_LEFT_CONTROL] || io->KeysDown[GLFW_KEY_RIGHT_CONTROL] ||
                  (has_modifiers && event->down && (event->modifiers & EVENT_CONTROL));
    io->KeyShift = io->KeysDown[GLFW_KEY_LEFT_SHIFT] || io->KeysDown[GLFW_KEY_RIGHT_SHIFT] ||
                   (has_modifiers && event->down && (event->modifiers & EVENT_SHIFT));
    io->KeyAlt = io->KeysDown[GLFW_KEY_LEFT_ALT] || io->KeysDown[GLFW_KEY_RIGHT_ALT];
}

static void feed_events(struct gui *gui)
{
    struct gui_state *own = gui->own;
    ImGuiIO &io = ImGui::GetIO();
    struct fed fed = {};
    while (own->event_count) {
        const struct event *event = &own->events[own->event_first];
        if (event->kind == EVENT_BUTTON && (event->code < 0 || event->code >= 5)) {
            // Dear ImGui knows five buttons.
        } else if (must_wait(&fed, event)) {
            return;
        } else {
            feed_one(&io, &fed, event);
        }
        own->event_first = (own->event_first + 1) % GUI_EVENTS_MAX;
        own->event_count--;
    }
}

// --- frames --------------------------------------------------------------------------------------

void gui_begin(struct gui *gui, uint32_t width, uint32_t height, double seconds)
{
    struct gui_state *own = gui->own;
    ImGui::SetCurrentContext(static_cast<ImGuiContext *>(own->context));
    ImGuiIO &io = ImGui::GetIO();
    io.DisplaySize = ImVec2((float)width, (float)height);
    // It asks for a time above 0; a frame that waited for seconds is no reason to jump.
    io.DeltaTime = (float)fmin(fmax(seconds, 1e-4), 1.0);
    own->clock += (double)io.DeltaTime;
    feed_events(gui);
    ImGui::NewFrame();
    items_begin(own);
    gui->hovered_help = NULL;
    own->hovered_id[0] = '\0';
    gui->width = 0.0f;
    own->has_popup = false;
}

// Room for at least `count`; false: out of memory, and what there was is kept.
template <typename T> static bool reserve(T **array, uint32_t *capacity, uint32_t count)
{
    if (count <= *capacity)
        return true;
    uint32_t more = count + count / 2;
    T *to = static_cast<T *>(realloc(*array, more * sizeof(T)));
    if (!to)
        return false;
    *array = to;
    *capacity = more;
    return true;
}

static void copy_list(struct gui_state *own, const ImDrawList *list, struct gpu_drawing *out,
                      uint32_t vertex, uint32_t index)
{
    memcpy(own->vertices + vertex, list->VtxBuffer.Data, (size_t)list->VtxBuffer.size_in_bytes());
    memcpy(own->indices + index, list->IdxBuffer.Data, (size_t)list->IdxBuffer.size_in_bytes());
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    for (const ImDrawCmd &command : list->CmdBuffer) {
        ImVec4 clip = command.ClipRect;
        clip.x = fmaxf(clip.x, 0.0f);
        clip.y = fmaxf(clip.y, 0.0f);
        clip.z = fminf(clip.z, size.x);
        clip.w = fminf(clip.w, size.y);
        if (!command.ElemCount || !(clip.x < clip.z && clip.y < clip.w))
            continue;
        struct gpu_draw *draw = &own->draws[out->draw_count++];
        draw->index_count = command.ElemCount;
        draw->first_index = index + command.IdxOffset;
        draw->first_vertex = vertex + command.VtxOffset;
        draw->clip[0] = clip.x;
        draw->clip[1] = clip.y;
        draw->clip[2] = clip.z;
        draw->clip[3] = clip.w;
    }
}

static void copy_drawing(struct gui_state *own, const ImDrawData *data, struct gpu_drawing *out)
{
    memset(out, 0, sizeof *out);
    uint32_t draws = 0;
    for (int i = 0; i < data->CmdListsCount; i++)
        draws += (uint32_t)data->CmdLists[i]->CmdBuffer.Size;
    // Without memory a frame has no panel; the next one may.
    if (!reserve(&own->vertices, &own->vertex_capacity, (uint32_t)data->TotalVtxCount) ||
        !reserve(&own->indices, &own->index_capacity, (uint32_t)data->TotalIdxCount) ||
        !reserve(&own->draws, &own->draw_capacity, draws))
        return;
    for (int i = 0; i < data->CmdListsCount; i++) {
        const ImDrawList *list = data->CmdLists[i];
        copy_list(own, list, out, out->vertex_count, out->index_count);
        out->vertex_count += (uint32_t)list->VtxBuffer.Size;
        out->index_count += (uint32_t)list->IdxBuffer.Size;
    }
    out->vertices = own->vertices;
    out->indices = own->indices;
    out->draws = own->draws;
}

void gui_end(struct gui *gui, struct gpu_drawing *out)
{
    struct gui_state *own = gui->own;
    items_end(gui);
    ImGui::Render();
    // A text whose control went away is not being typed any more.
    if (own->edit_id[0] && ++own->edit_idle > 1)
        own->edit_id[0] = '\0';
    copy_drawing(own, ImGui::GetDrawData(), out);
    gui->is_busy = ImGui::IsAnyItemActive();
    gui->wants_keys = ImGui::GetIO().WantTextInput || own->edit_id[0];
    update_wants(gui);
}

// --- layout --------------------------------------------------------------------------------------

static float help_height(void)
{
    return HELP_LINES * ImGui::GetTextLineHeight() + 2.0f * ImGui::GetStyle().ItemSpacing.y;
}

bool gui_panel_begin(struct gui *gui, const char *title)
{
    struct gui_state *own = gui->own;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    own->is_drawn = !gui->is_hidden && size.x > 0.0f && size.y > 0.0f;
    if (!own->is_drawn)
        return false;
    gui->width = floorf(fminf(PANEL_POINTS * own->scale, PANEL_PART * size.x));
    ImGui::SetNextWindowPos(ImVec2(0.0f, 0.0f));
    ImGui::SetNextWindowSize(ImVec2(gui->width, size.y));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0f);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1.0f, 1.0f));
    ImGui::Begin("panel", NULL,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
                     ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoScrollWithMouse);
    ImGui::PopStyleVar(2);
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_CheckMark));
    ImGui::TextUnformatted(title);
    ImGui::PopStyleColor();
    ImGui::BeginChild("controls", ImVec2(0.0f, -help_height()), false, ImGuiWindowFlags_NoNav);
    own->label_width = floorf(ImGui::GetContentRegionAvail().x * 0.40f);
    return true;
}

static void draw_help(struct gui *gui)
{
    struct gui_state *own = gui->own;
    ImGui::Separator();
    ImGui::PushTextWrapPos(0.0f);
    if (own->clock < own->refusal_until) {
        ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(0.95f, 0.60f, 0.35f, 1.0f));
        ImGui::TextUnformatted(own->refusal);
        ImGui::PopStyleColor();
    } else if (gui->hovered_help) {
        ImGui::TextDisabled("%s", own->hovered_id);
        ImGui::TextUnformatted(gui->hovered_help);
    } else {
        ImGui::TextDisabled("Help on what the mouse is over. Numbers: drag, or Ctrl+click to "
                            "type.");
    }
    ImGui::PopTextWrapPos();
}

void gui_panel_end(struct gui *gui)
{
    struct gui_state *own = gui->own;
    if (!own->is_drawn)
        return;
    ImGui::EndChild();
    draw_help(gui);
    ImGui::End();
    own->is_drawn = false;
}

void gui_space(struct gui *gui)
{
    if (gui->own->is_drawn)
        ImGui::Dummy(ImVec2(0.0f, ImGui::GetStyle().ItemSpacing.y));
}

void gui_line(struct gui *gui, const char *format, ...)
{
    if (!gui->own->is_drawn)
        return;
    va_list arguments;
    va_start(arguments, format);
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextV(format, arguments);
    ImGui::PopTextWrapPos();
    va_end(arguments);
}

void gui_warning(struct gui *gui, const char *format, ...)
{
    if (!gui->own->is_drawn)
        return;
    va_list arguments;
    va_start(arguments, format);
    ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(0.95f, 0.60f, 0.35f, 1.0f));
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextV(format, arguments);
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
    va_end(arguments);
}

void gui_pair(struct gui *gui, const char *label, const char *format, ...)
{
    const struct gui_state *own = gui->own;
    if (!own->is_drawn)
        return;
    va_list arguments;
    va_start(arguments, format);
    ImGui::PushTextWrapPos(own->label_width - ImGui::GetStyle().ItemInnerSpacing.x);
    ImGui::TextDisabled("%s", label);
    ImGui::PopTextWrapPos();
    ImGui::SameLine(own->label_width);
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextV(format, arguments);
    ImGui::PopTextWrapPos();
    va_end(arguments);
}

void gui_fact(struct gui *gui, const char *label, const char *format, ...)
{
    if (!gui->own->is_drawn)
        return;
    va_list arguments;
    va_start(arguments, format);
    ImGui::TextDisabled("%s", label);
    ImGui::SameLine(gui->own->label_width);
    ImGui::TextV(format, arguments);
    va_end(arguments);
}
