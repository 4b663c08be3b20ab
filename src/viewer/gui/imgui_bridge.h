// Dear ImGui for C: each function is a call or two of its own, without state of ours. Where a name
// or a word is its own, its header has the contract.
//
// Positions and sizes are pixels; colours of drawings have red in the lowest byte. One thread.
#ifndef LAMPYRIS_VIEWER_GUI_IMGUI_BRIDGE_H
#define LAMPYRIS_VIEWER_GUI_IMGUI_BRIDGE_H

#include "gpu/screen.h"
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct ImDrawList;
struct ImGuiContext;

struct im_vec {
    float x, y;
};

struct im_rect {
    struct im_vec min, max;
};

#define IM_RGBA(r, g, b, a)                                                                        \
    ((uint32_t)(r) | (uint32_t)(g) << 8 | (uint32_t)(b) << 16 | (uint32_t)(a) << 24)

// Those of the style that the panel sets or reads: our name, and ImGui's.
// clang-format off
#define IM_COLORS(X)                                                                               \
    X(TEXT, Text) X(TEXT_DISABLED, TextDisabled) X(WINDOW, WindowBg) X(CHILD, ChildBg)             \
    X(POPUP, PopupBg) X(BORDER, Border) X(FRAME, FrameBg) X(FRAME_HOVERED, FrameBgHovered)         \
    X(FRAME_ACTIVE, FrameBgActive) X(HEADER, Header) X(HEADER_HOVERED, HeaderHovered)              \
    X(HEADER_ACTIVE, HeaderActive) X(BUTTON, Button) X(BUTTON_HOVERED, ButtonHovered)              \
    X(BUTTON_ACTIVE, ButtonActive) X(CHECK_MARK, CheckMark) X(GRAB, SliderGrab)                    \
    X(GRAB_ACTIVE, SliderGrabActive) X(SEPARATOR, Separator) X(SCROLLBAR, ScrollbarBg)             \
    X(SCROLLBAR_GRAB, ScrollbarGrab) X(SCROLLBAR_GRAB_HOVERED, ScrollbarGrabHovered)               \
    X(SCROLLBAR_GRAB_ACTIVE, ScrollbarGrabActive) X(SELECTED_TEXT, TextSelectedBg)                 \
    X(PLOT_LINES, PlotLines) X(PLOT_BARS, PlotHistogram)
// clang-format on
enum im_color {
#define IM_COLOR(name, theirs) IM_COLOR_##name,
    IM_COLORS(IM_COLOR)
#undef IM_COLOR
};

struct im_style {
    struct im_vec window_padding, frame_padding, item_spacing, item_inner_spacing;
    float indent, scrollbar, window_border;
    float frame_rounding, grab_rounding, popup_rounding, scrollbar_rounding;
    float disabled_alpha;
};

// --- life ----------------------------------------------------------------------------------------
// The clipboard's functions get `user`. The context is current afterwards.
struct ImGuiContext *im_create(const char *(*get_clipboard)(void *user),
                               void (*set_clipboard)(void *user, const char *text), void *user);
void im_use(struct ImGuiContext *context);
void im_destroy(struct ImGuiContext *context);
void im_style_set(const struct im_style *style, float scale); // over ImGui's dark one
void im_style_color(enum im_color color, float r, float g, float b, float a);
struct im_style im_style_now(void);                                        // scaled
bool im_font_file(const char *path, float pixels, const uint16_t *ranges); // ranges: outlives it
void im_font_default(float pixels);
const uint8_t *im_font_coverage(uint32_t *width, uint32_t *height); // the atlas's; NULL: no memory

// --- events --------------------------------------------------------------------------------------
#define IM_KEYS 512         // codes are below
#define IM_MOUSE_BUTTONS 5u // and these
void im_put_mouse(float x, float y);
void im_put_button(uint32_t button, bool down);
void im_put_wheel(float x, float y);  // adds up
void im_put_key(int code, bool down); // GLFW's
void im_put_no_keys(void);            // all are let go
void im_put_character(uint32_t code);
void im_put_modifiers(bool control, bool shift, bool alt);
bool im_key_is_down(int code);

// --- frames --------------------------------------------------------------------------------------
void im_frame_setup(float width, float height, float seconds);
void im_frame_begin(void);
void im_frame_end(void);
struct im_vec im_display(void); // its size
bool im_is_any_active(void);
bool im_wants_text(void);
// What the frame that ended draws: lists, and commands of each, of which `out` is relative to the
// list's own vertices and indices.
struct im_list {
    const struct gpu_vertex *vertices;
    const uint16_t *indices;
    uint32_t vertex_count, index_count, command_count;
};
uint32_t im_list_count(void);
struct im_list im_list_at(uint32_t list);
struct gpu_draw im_list_command(uint32_t list, uint32_t command);

// --- layout --------------------------------------------------------------------------------------
void im_panel_begin(float width, float height); // at the upper left, without any decoration
// A window in the window, with a bar to move it by and edges to size it by: at first of that place.
// Returns where it is now.
struct im_rect im_panel_begin_floating(const char *title, struct im_rect at_first);
void im_panel_end(void);
void im_child_begin(const char *id, float height, bool is_padded); // as wide as there is room
void im_child_end(void);
void im_group_begin(void);
void im_group_end(void);
void im_push_id(const char *id);
void im_push_id_number(int id);
void im_pop_id(void);
void im_push_disabled(bool is_disabled);
void im_pop_disabled(void);
void im_push_color(enum im_color color, uint32_t rgba);
void im_push_color_of(enum im_color color, enum im_color as);
void im_pop_color(void);
void im_push_padding(struct im_vec window, struct im_vec frame);
void im_pop_padding(void);
void im_push_wrap(float x); // 0: at the right end
void im_pop_wrap(void);
void im_same_line(void);
void im_same_line_at(float x);
void im_same_line_after(float space);
void im_separator(void);
void im_indent(void);
void im_unindent(void);
void im_dummy(float width, float height);
void im_next_width(float width);
struct im_vec im_cursor(void); // on the screen
void im_cursor_set_y(float y); // in the window
struct im_vec im_window_pos(void);
float im_window_height(void);
float im_room(void); // to the right end
float im_line_height(void);
float im_line_height_spaced(void);
float im_frame_height(void);
float im_scroll(void);
void im_scroll_set(float y);
void im_scroll_here(void); // what was drawn last comes to the middle
uint32_t im_rgba(enum im_color color);
struct im_vec im_text_size(const char *text, float wrap); // wrap: a width; -1: none

// --- the last item -------------------------------------------------------------------------------
struct im_rect im_item_rect(void);
bool im_is_hovered(void);
bool im_is_hovered_even_disabled(void);
bool im_is_active(void);
bool im_is_activated(void);
bool im_is_deactivated(void);
bool im_is_deactivated_after_edit(void);
bool im_is_double_clicked(void);
bool im_is_dragged(float threshold);
struct im_vec im_mouse_delta(void);
bool im_is_control_held(void);
bool im_is_shift_held(void);
void im_show_resize_cursor(void);

// --- widgets -------------------------------------------------------------------------------------
void im_text(const char *text);
void im_text_dim(const char *text);
void im_text_v(const char *format, va_list arguments) __attribute__((format(printf, 1, 0)));
bool im_tree(const char *label, bool is_open, bool is_framed); // true: is open now
bool im_button(const char *label);
bool im_hit(const char *id, struct im_vec size); // a button that is not seen
bool im_checkbox(const char *label, bool *value);
bool im_selectable(const char *label, bool is_on);
bool im_combo_begin(const char *id, const char *shown);
void im_combo_end(void); // where it was open
void im_focus_next(void);
void im_input(const char *id, char *text, uint32_t size);
bool im_color_button(const char *id, const float rgb[3], float size);
void im_popup_open(const char *id);
bool im_popup_begin(const char *id);
void im_popup_end(void); // where it was open
bool im_color_wheel(const char *id, float rgb[3]);

// --- drawing -------------------------------------------------------------------------------------
struct ImDrawList *im_draw_window(void);
struct ImDrawList *im_draw_background(void);
struct ImDrawList *im_draw_foreground(void);
struct im_rect im_clip(struct ImDrawList *list);
void im_push_clip(struct ImDrawList *list, struct im_vec min, struct im_vec max, bool intersect);
void im_pop_clip(struct ImDrawList *list);
void im_draw_rect(struct ImDrawList *list, struct im_vec min, struct im_vec max, uint32_t rgba,
                  float rounding);
void im_draw_gradient(struct ImDrawList *list, struct im_vec min, struct im_vec max, uint32_t left,
                      uint32_t right);
void im_draw_line(struct ImDrawList *list, struct im_vec from, struct im_vec to, uint32_t rgba,
                  float thickness);
void im_draw_quad(struct ImDrawList *list, const struct im_vec corners[4], uint32_t rgba);
void im_draw_circle(struct ImDrawList *list, struct im_vec center, float radius, uint32_t rgba);
void im_draw_text(struct ImDrawList *list, struct im_vec at, uint32_t rgba, const char *text);
void im_draw_text_wrapped(struct ImDrawList *list, struct im_vec at, uint32_t rgba,
                          const char *text, float wrap);

#ifdef __cplusplus
}
#endif

#endif
