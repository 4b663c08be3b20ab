// State that the files of the panel's controls share: the registry (gui_items.c, gui_values.c), and
// the drawing with Dear ImGui through imgui_bridge.h (gui.c, gui_events.c, gui_controls.c,
// gui_charts.c, gui_overlay.c).
#ifndef LAMPYRIS_VIEWER_GUI_GUI_STATE_H
#define LAMPYRIS_VIEWER_GUI_GUI_STATE_H

#include "viewer/gui/gui.h"

#define GUI_GROUPS_MAX 64
#define GUI_DEPTH_MAX 8
#define GUI_WISHES_MAX 16
#define GUI_EVENTS_MAX 1024
#define GUI_TEXT_MAX 1024
#define GUI_WHY_MAX 512
#define GUI_SLOTS 4096 // a power of two, twice GUI_ITEMS_MAX

// A value that a script sets.
struct gui_wish {
    char id[GUI_ID_MAX];
    char value[GUI_TEXT_MAX];
    bool is_due;  // a frame has begun since
    bool is_seen; // its control was called
};

struct gui_group {
    char id[GUI_ID_MAX];
    uint32_t parent; // index plus 1; 0: none
    bool is_open;
};

struct gui_state {
    // Controls of the current frame.
    struct gui_item items[GUI_ITEMS_MAX];
    struct gui_item spare; // for those beyond the capacity
    uint32_t item_count;
    uint16_t slots[GUI_SLOTS]; // index plus 1 by a hash of the id; 0: none
    char duplicate[GUI_ID_MAX], last_duplicate[GUI_ID_MAX];

    struct gui_group groups[GUI_GROUPS_MAX]; // all groups so far
    uint32_t group_count;
    uint32_t stack[GUI_DEPTH_MAX]; // open groups around the current control, index plus 1
    bool stack_drawn[GUI_DEPTH_MAX];
    uint32_t depth;
    bool is_drawn;   // the panel is shown, and so are all groups around
    bool is_enabled; // see gui_enabled

    struct gui_wish wishes[GUI_WISHES_MAX];
    uint32_t wish_count;
    char result[512]; // result of the last frame; "" if all succeeded

    char reveal[GUI_ID_MAX]; // id to scroll to
    uint32_t reveal_frames;  // frames left for that
    bool reveal_hit;         // its control was called since the current list last asked
    double list_reveal;      // row of the list to scroll to; negative: none

    // The number or text that is being typed, and the number that is being dragged.
    char edit_id[GUI_ID_MAX]; // "" for none
    char edit_text[GUI_TEXT_MAX];
    bool edit_begins;
    uint32_t edit_idle; // frames in which its control was not called
    double drag_start, drag_widths;
    bool drag_types;   // becomes typing if the mouse does not move
    char refusal[512]; // why the last typed value was rejected
    double refusal_until, clock;
    const struct gui_item *hovered; // under the mouse, valid while gui.hovered_help is not NULL

    // Events that wait for a frame of their own.
    struct event events[GUI_EVENTS_MAX];
    uint32_t event_first, event_count;
    double mouse[2];
    uint32_t buttons_elsewhere; // buttons held that were pressed outside of the panel, as bits
    bool has_popup;

    float scale;
    bool same_line; // the next control continues the line
    float label_width;
    struct im *im;          // see imgui_bridge.h
    struct gpu_atlas atlas; // atlas of the font
};

// --- gui_items.c: never NULL ---------------------------------------------------------------------
void items_begin(struct gui_state *own);
struct gui_item *items_add(struct gui_state *own, const char *id, enum gui_kind kind,
                           const char *label, const char *help);
// Returns the value that a script sets, or NULL. Rejects it if the control is disabled.
const char *items_wish(struct gui_state *own, const struct gui_item *item);
void items_refuse(struct gui_state *own, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void items_end(struct gui *gui);
// Returns the group's index plus 1, and creates it if it is new. 0: there are too many.
uint32_t items_group(struct gui_state *own, const char *id, bool open_at_first);

// --- gui_values.c --------------------------------------------------------------------------------
// Writes doubles or floats as text that reads back to the same bits: "A", or "A,B,C". out:
// GUI_VALUE_MAX bytes.
void value_write(const double *value, uint32_t count, bool is_float, const struct gui_range *range,
                 char *out);
// Writes a number as displayed: with at most `digits` digits, and the unit.
void value_show(double value, const struct gui_range *range, int digits, char *out);
// Reads `count` numbers, at most 3, separated by commas. Returns false with the reason in `why`
// (GUI_WHY_MAX bytes); out is then unchanged.
bool value_read(const char *text, uint32_t count, bool is_float, const struct gui_range *range,
                double *out, char *why);
bool value_read_switch(const char *text, bool *out, char *why);
bool value_read_choice(const char *text, const char *const *names, uint32_t *out, char *why);
// Returns the value, in the range, of a drag from `start` by `widths` widths of the control.
double value_dragged(double start, double widths, const struct gui_range *range, bool is_float);

// --- gui_events.c --------------------------------------------------------------------------------
void events_feed(struct gui *gui); // to the current frame
void events_want(struct gui *gui); // decides whether the panel receives the next mouse events

#endif
