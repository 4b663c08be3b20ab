// The part of Dear ImGui that the panel uses, as C functions. It has no state or decisions of its
// own. ImGui's header documents the functions and terms that have the same names.
//
// Positions and sizes are in pixels; colours have red in the lowest byte. Only one thread may call
// these functions.
#ifndef LAMPYRIS_VIEWER_GUI_IMGUI_BRIDGE_H
#define LAMPYRIS_VIEWER_GUI_IMGUI_BRIDGE_H

#include "gpu/screen.h"
#include "viewer/window/window.h"
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct im; // a context of ImGui, and the drawing of its last frame
struct ImDrawList;

struct im_vec {
    float x, y;
};

struct im_rect {
    float left, top, right, bottom;
};

#define IM_RGBA(r, g, b, a)                                                                        \
    ((uint32_t)(r) | (uint32_t)(g) << 8 | (uint32_t)(b) << 16 | (uint32_t)(a) << 24)
// Defines a grey with a bluish tint.
#define IM_GRAY(value, alpha)                                                                      \
    IM_RGBA((value)*247.35f + 0.5f, (value)*255.0f + 0.5f, (value)*265.2f + 0.5f,                  \
            (alpha)*255.0f + 0.5f)
#define IM_TEXT IM_GRAY(0.86f, 1.0f)
#define IM_DIM IM_GRAY(0.53f, 1.0f)
#define IM_FRAME IM_GRAY(0.17f, 1.0f)
#define IM_POPUP IM_GRAY(0.12f, 0.99f)
#define IM_LINE IM_GRAY(0.22f, 1.0f)
#define IM_GLOW IM_RGBA(168, 201, 84, 255) // the colour of a glow-worm
#define IM_DIM_GLOW IM_RGBA(115, 140, 56, 140)
#define IM_WARNING IM_RGBA(242, 153, 89, 255)

struct im *im_create(float scale); // scale: pixels per point
void im_destroy(struct im *im);    // accepts NULL
// Adds a font. If `path` is NULL, it is the font that is embedded in ImGui. `ranges` must stay
// valid as long as the context.
bool im_font(const char *path, float pixels, const uint16_t *ranges);
bool im_atlas(struct gpu_atlas *out); // to be called after im_font(); false when out of memory

#define IM_KEYS 512                                    // key codes are less than this
#define IM_MOUSE_BUTTONS 5u                            // button codes are less than this
void im_put(struct im *im, const struct event *event); // the event's codes must be in range
void im_begin(struct im *im, float width, float height, float seconds);
// Ends a frame. is_busy: an item is active; is_typing: text input is active. *out is valid until
// the next frame ends.
void im_end(struct im *im, struct gpu_drawing *out, bool *is_busy, bool *is_typing);

// --- layout --------------------------------------------------------------------------------------
// The current position in the layout of a frame.
struct im_place {
    struct im_vec display;        // size of the display
    struct im_vec window, cursor; // upper left corners of the window and of the next item
    float window_height, scroll;
    float room; // distance to the right end of the line
    // Heights of a line of text, of a line with spacing, and of a control.
    float line, line_spaced, frame;
    // Distances of the style, scaled to pixels:
    struct im_vec window_padding, frame_padding, spacing;
    float inner_spacing, rounding;
};
struct im_place im_now(void);
void im_panel_begin(float width, float height); // a window without decoration at the upper left
// Begins a window with a title bar, by which it can be moved, and edges, by which it can be
// resized. It is initially at `at_first`. Returns its current rectangle.
struct im_rect im_panel_begin_floating(const char *title, struct im_rect at_first);
void im_panel_end(void);
// Begins a list, which has all of the available width and a background of its own. Switches in it
// are as high as text.
void im_child_begin(const char *id, float height, bool is_list);
void im_child_end(bool is_list);
// Begins an item; ids inside are relative to its id.
void im_item_begin(const char *id, bool is_disabled);
void im_item_end(void);
void im_group_begin(void);
void im_group_end(void);
// Continues the line. at = 0: after the last item; space < 0: with the default spacing.
void im_same_line(float at, float space);
void im_separator(void);
void im_indent(int levels);
void im_dummy(float width, float height);
void im_cursor_set_y(float y); // y is relative to the window
void im_scroll_set(float y);
void im_scroll_here(void); // scrolls so that the last item is in the centre

// --- items ---------------------------------------------------------------------------------------
// The last item, and how mouse and keys interact with it.
struct im_item {
    struct im_rect box, clip;
    bool is_hovered; // also true if the item is disabled
    // was_edited: it was deactivated after it had been edited.
    bool is_active, was_activated, was_deactivated, was_edited;
    bool is_double_clicked, has_control;
    bool is_dragged;
    float drag; // mouse movement since the last frame, divided by ten if Shift is held
};
struct im_item im_last(void);
// wrap: x position in the window at which lines end; 0: the right end, -1: lines are not wrapped.
void im_text(uint32_t rgba, float wrap, const char *format, va_list arguments)
    __attribute__((format(printf, 3, 0)));
// wrap: width at which lines end; -1: lines are not wrapped.
struct im_vec im_text_size(const char *text, float wrap);
static inline float im_text_width(const char *text)
{
    return im_text_size(text, -1.0f).x;
}
// Returns whether the tree is now open.
bool im_tree(const char *label, bool is_open, bool is_framed);
bool im_button(const char *label, struct im_vec size, bool is_field);
bool im_tab(const char *label, struct im_vec size, bool is_on);
bool im_checkbox(const char *label, bool *value);
bool im_row(const char *label, bool is_on);
bool im_combo_begin(const char *id, const char *shown);
void im_combo_end(void); // only if im_combo_begin() returned true
void im_input(const char *id, char *text, uint32_t size, float width, bool takes_focus);
// Draws a swatch that opens a colour wheel of this width. *is_open receives whether the wheel is
// open.
bool im_color(const char *id, float rgb[3], float size, float width, bool *is_open);

// --- drawing -------------------------------------------------------------------------------------
enum im_layer { IM_WINDOW, IM_BACKGROUND, IM_FOREGROUND };
struct ImDrawList *im_layer(enum im_layer layer);
void im_clip_begin(struct ImDrawList *list, struct im_rect clip);
void im_clip_end(struct ImDrawList *list);
void im_draw_rect(struct ImDrawList *list, struct im_rect box, uint32_t rgba, float rounding);
void im_draw_gradient(struct ImDrawList *list, struct im_rect box, uint32_t left, uint32_t right);
void im_draw_line(struct ImDrawList *list, struct im_vec from, struct im_vec to, uint32_t rgba,
                  float thickness);
void im_draw_quad(struct ImDrawList *list, const struct im_vec corners[4], uint32_t rgba);
void im_draw_circle(struct ImDrawList *list, struct im_vec center, float radius, uint32_t rgba);
// Draws text. clip: NULL for none; wrap: width at which lines end, 0: they are not wrapped.
void im_draw_text(struct ImDrawList *list, float x, float y, uint32_t rgba, const char *text,
                  const struct im_rect *clip, float wrap);

#ifdef __cplusplus
}
#endif

#endif
