// State that the files of the panel's controls share: their registry (gui_items.c, gui_values.c),
// and what draws them with Dear ImGui, through imgui_bridge.h (gui.c, gui_events.c, gui_controls.c,
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

// A script's wish for a control.
struct gui_wish {
    char id[GUI_ID_MAX];
    char value[GUI_TEXT_MAX];
    bool is_due;  // a frame began since
    bool is_seen; // its control was there
};

struct gui_group {
    char id[GUI_ID_MAX];
    uint32_t parent; // index plus 1; 0: none
    bool is_open;
};

struct gui_state {
    // Controls of the frame that is being made.
    struct gui_item items[GUI_ITEMS_MAX];
    struct gui_item spare; // for those that there is no room for
    uint32_t item_count;
    uint16_t slots[GUI_SLOTS]; // index plus 1 by a hash of the id; 0: none
    char duplicate[GUI_ID_MAX], last_duplicate[GUI_ID_MAX];

    struct gui_group groups[GUI_GROUPS_MAX]; // all that there ever were
    uint32_t group_count;
    uint32_t stack[GUI_DEPTH_MAX]; // groups that are around now, index plus 1
    bool stack_drawn[GUI_DEPTH_MAX];
    uint32_t depth;
    bool is_drawn;   // the panel is shown, and so are all groups around
    bool is_enabled; // see gui_enabled

    struct gui_wish wishes[GUI_WISHES_MAX];
    uint32_t wish_count;
    char result[512]; // of those of the last frame; "" where all were done

    char reveal[GUI_ID_MAX]; // to be scrolled to
    uint32_t reveal_frames;  // that are left for that
    bool reveal_hit;         // its control was called for since the list that runs asked last
    double list_reveal;      // row of it that is to be scrolled to; negative: none

    // A number or a text that is being typed, and the number that is being dragged.
    char edit_id[GUI_ID_MAX]; // "" for none
    char edit_text[GUI_TEXT_MAX];
    bool edit_begins;
    uint32_t edit_idle; // frames without its control
    double drag_start, drag_widths;
    bool drag_types;   // it becomes typing where it does not move
    char refusal[512]; // why what was typed last was not taken
    double refusal_until, clock;
    const struct gui_item *hovered; // by the mouse, while gui.hovered_help is not NULL

    // Events that wait for a frame of their own.
    struct event events[GUI_EVENTS_MAX];
    uint32_t event_first, event_count;
    double mouse[2];
    uint32_t buttons_elsewhere; // held, and pressed outside of the panel: as bits
    bool has_popup;

    float scale;
    bool same_line; // the next control goes on in the line
    float label_width;
    struct im *im;          // see imgui_bridge.h
    struct gpu_atlas atlas; // its
};

// --- gui_items.c: never NULL ---------------------------------------------------------------------
void items_begin(struct gui_state *own);
struct gui_item *items_add(struct gui_state *own, const char *id, enum gui_kind kind,
                           const char *label, const char *help);
// Returns what a script wants of it, or NULL. Refuses for controls that are disabled.
const char *items_wish(struct gui_state *own, const struct gui_item *item);
void items_refuse(struct gui_state *own, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void items_end(struct gui *gui);
// Returns the group's index plus 1; makes it where there was none so far. 0: there are too many.
uint32_t items_group(struct gui_state *own, const char *id, bool open_at_first);

// --- gui_values.c --------------------------------------------------------------------------------
// As text that reads back to the same bits, of doubles or of floats: "A", or "A,B,C".
// out: GUI_VALUE_MAX.
void value_write(const double *value, uint32_t count, bool is_float, const struct gui_range *range,
                 char *out);
// Writes a number as it is shown: with so many digits at most, and the unit.
void value_show(double value, const struct gui_range *range, int digits, char *out);
// So many numbers, at most 3, with commas between them. False: why says what was expected
// (GUI_WHY_MAX bytes), and out keeps what it was.
bool value_read(const char *text, uint32_t count, bool is_float, const struct gui_range *range,
                double *out, char *why);
bool value_read_switch(const char *text, bool *out, char *why);
bool value_read_choice(const char *text, const char *const *names, uint32_t *out, char *why);
// Where a drag of so many widths of the control leads from `start`, in the range.
double value_dragged(double start, double widths, const struct gui_range *range, bool is_float);

// --- gui_events.c --------------------------------------------------------------------------------
void events_feed(struct gui *gui); // to the frame that begins
void events_want(struct gui *gui); // says who gets the next event of the mouse

#endif
