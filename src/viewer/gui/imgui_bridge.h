// Dear ImGui for C: what the panel uses of it, without state or decisions of its own. Where a name
// or a word is ImGui's, its header has the contract.
//
// Positions and sizes are pixels; colours have red in the lowest byte. One thread.
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

struct im; // a context, and what its last frame draws
struct ImDrawList;

struct im_vec {
    float x, y;
};

struct im_rect {
    float left, top, right, bottom;
};

#define IM_RGBA(r, g, b, a)                                                                        \
    ((uint32_t)(r) | (uint32_t)(g) << 8 | (uint32_t)(b) << 16 | (uint32_t)(a) << 24)
// A gray with a bit of blue.
#define IM_GRAY(value, alpha)                                                                      \
    IM_RGBA((value)*247.35f + 0.5f, (value)*255.0f + 0.5f, (value)*265.2f + 0.5f,                  \
            (alpha)*255.0f + 0.5f)
#define IM_TEXT IM_GRAY(0.86f, 1.0f)
#define IM_DIM IM_GRAY(0.53f, 1.0f)
#define IM_FRAME IM_GRAY(0.17f, 1.0f)
#define IM_POPUP IM_GRAY(0.12f, 0.99f)
#define IM_LINE IM_GRAY(0.22f, 1.0f)
#define IM_GLOW IM_RGBA(168, 201, 84, 255) // a glow-worm's
#define IM_DIM_GLOW IM_RGBA(115, 140, 56, 140)
#define IM_WARNING IM_RGBA(242, 153, 89, 255)

struct im *im_create(float scale); // pixels a point
void im_destroy(struct im *im);    // accepts NULL
// path NULL: the font that ImGui has within itself. ranges: live as long.
bool im_font(const char *path, float pixels, const uint16_t *ranges);
bool im_atlas(struct gpu_atlas *out); // once the font is there; false: no memory

#define IM_KEYS 512                                    // codes are below
#define IM_MOUSE_BUTTONS 5u                            // and these
void im_put(struct im *im, const struct event *event); // codes in range
void im_begin(struct im *im, float width, float height, float seconds);
// is_busy: an item is active; is_typing: text is taken. *out lives until the next frame ends.
void im_end(struct im *im, struct gpu_drawing *out, bool *is_busy, bool *is_typing);

// --- layout --------------------------------------------------------------------------------------
// What there is at this point of a frame.
struct im_place {
    struct im_vec display;        // its size
    struct im_vec window, cursor; // upper left corners of the window and of the next item
    float window_height, scroll;
    float room;                     // to the right end
    float line, line_spaced, frame; // heights of letters, of rows of them, and of controls
    // Of the style, scaled:
    struct im_vec window_padding, frame_padding, spacing;
    float inner_spacing, rounding;
};
struct im_place im_now(void);
void im_panel_begin(float width, float height); // at the upper left, without any decoration
// A window in the window, with a bar to move it by and edges to size it by: at first of that place.
// Returns where it is now.
struct im_rect im_panel_begin_floating(const char *title, struct im_rect at_first);
void im_panel_end(void);
// Begins a list as wide as there is room, with a ground of its own, and switches as high as
// letters.
void im_child_begin(const char *id, float height, bool is_list);
void im_child_end(bool is_list);
void im_item_begin(const char *id, bool is_disabled); // ids within are its own
void im_item_end(void);
void im_group_begin(void);
void im_group_end(void);
void im_same_line(float at, float space); // at 0: where the last item ends; space below 0: spacing
void im_separator(void);
void im_indent(int levels);
void im_dummy(float width, float height);
void im_cursor_set_y(float y); // in the window
void im_scroll_set(float y);
void im_scroll_here(void); // what was drawn last comes to the middle

// --- items ---------------------------------------------------------------------------------------
// The last item, and what mouse and keys do to it.
struct im_item {
    struct im_rect box, clip;
    bool is_hovered;                                            // also where it is disabled
    bool is_active, was_activated, was_deactivated, was_edited; // edited: before it ended
    bool is_double_clicked, has_control;
    bool is_dragged;
    float drag; // how far the mouse dragged it since the last frame, with Shift a tenth
};
struct im_item im_last(void);
// wrap: where lines end, in the window; 0: at the right end, -1: nowhere.
void im_text(uint32_t rgba, float wrap, const char *format, va_list arguments)
    __attribute__((format(printf, 3, 0)));
struct im_vec im_text_size(const char *text, float wrap); // wrap: a width; -1: none
static inline float im_text_width(const char *text)
{
    return im_text_size(text, -1.0f).x;
}
bool im_tree(const char *label, bool is_open, bool is_framed); // true: is open now
bool im_button(const char *label, struct im_vec size, bool is_field);
bool im_checkbox(const char *label, bool *value);
bool im_row(const char *label, bool is_on);
bool im_combo_begin(const char *id, const char *shown);
void im_combo_end(void); // where it was open
void im_input(const char *id, char *text, uint32_t size, float width, bool takes_focus);
// A swatch that opens a wheel of this width; *is_open: it is.
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
// clip: NULL for none; wrap: a width, 0 for none.
void im_draw_text(struct ImDrawList *list, float x, float y, uint32_t rgba, const char *text,
                  const struct im_rect *clip, float wrap);

#ifdef __cplusplus
}
#endif

#endif
