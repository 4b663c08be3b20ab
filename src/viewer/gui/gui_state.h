// The state that the files of the panel's controls share. gui_items.c and gui_values.c implement
// the registry; gui.c, gui_events.c, gui_controls.c, gui_tabs.c, gui_charts.c and gui_overlay.c
// draw with Dear ImGui through imgui_bridge.h.
#ifndef LAMPYRIS_VIEWER_GUI_GUI_STATE_H
#define LAMPYRIS_VIEWER_GUI_GUI_STATE_H

#include "viewer/gui/gui.h"

#define GUI_GROUPS_MAX 64
#define GUI_DEPTH_MAX 8
#define GUI_WISHES_MAX 16
#define GUI_EVENTS_MAX 1024
#define GUI_TEXT_MAX 1024
#define GUI_WHY_MAX 512
#define GUI_SEARCH_MAX 64
#define GUI_SLOTS 4096 // a power of two, and twice GUI_ITEMS_MAX

// A value to which a script sets a control.
struct gui_wish {
    char id[GUI_ID_MAX];
    char value[GUI_TEXT_MAX];
    bool is_due;  // a frame has begun since the script set it
    bool is_seen; // the control has been called
};

// A group or a tab.
struct gui_group {
    char id[GUI_ID_MAX];
    char label[GUI_LABEL_MAX];
    uint32_t parent; // index of the parent group or tab plus 1; 0: none
    bool is_open;    // it is a tab, or a group that is open
    bool is_tab;
};

struct gui_state {
    // The controls of the current frame.
    struct gui_item items[GUI_ITEMS_MAX];
    struct gui_item spare; // used for controls beyond the capacity
    uint32_t item_count;
    uint16_t slots[GUI_SLOTS]; // hash table by id: index of the item plus 1; 0: free
    char duplicate[GUI_ID_MAX], last_duplicate[GUI_ID_MAX];

    struct gui_group groups[GUI_GROUPS_MAX]; // all groups that have been called so far
    uint32_t group_count;
    uint32_t stack[GUI_DEPTH_MAX]; // the open groups around the current control: index plus 1
    bool stack_drawn[GUI_DEPTH_MAX];
    uint32_t depth;
    uint32_t outer;   // depth of the groups that are drawn with a frame: 1 in a tab, otherwise 0
    bool is_drawn;    // the panel is shown, and tab and groups around the control are open
    bool was_drawn;   // is_drawn before the current control began
    bool is_left_out; // the last control was not drawn, because of gui_applies() or a search
    bool is_enabled;  // see gui_enabled
    bool is_useless;  // see gui_applies

    uint32_t tab;                // the open tab: index of its group plus 1; 0: none yet
    char search[GUI_SEARCH_MAX]; // the text in the search box
    char sought[GUI_TEXT_MAX];   // the words of this frame, which include those being typed
    bool is_searching;           // there are such words
    uint32_t found_count;        // number of controls of this frame that have them
    uint32_t found_in;           // the group of the last of them: index plus 1

    struct gui_wish wishes[GUI_WISHES_MAX];
    uint32_t wish_count;
    char result[512]; // result of gui_set() in the last frame; "" if all calls succeeded

    char reveal[GUI_ID_MAX]; // id of the control to scroll to
    uint32_t reveal_frames;  // number of frames left for scrolling to it
    bool reveal_hit;    // the control to scroll to was called since the current list last checked
    double list_reveal; // row of the current list to scroll to; negative: none

    // The number or text that is being typed, or the number that is being dragged.
    char edit_id[GUI_ID_MAX]; // id of its control; "" if there is none
    char edit_text[GUI_TEXT_MAX];
    bool edit_begins;
    uint32_t edit_idle; // number of frames since that control was last called
    double drag_start, drag_widths;
    bool drag_types;   // typing starts if the button is released without a movement of the mouse
    char refusal[512]; // why the last typed value was rejected
    double refusal_until, clock;
    // Control under the mouse; valid while gui.hovered_help is not NULL.
    const struct gui_item *hovered;

    // Events that wait for a later frame.
    struct event events[GUI_EVENTS_MAX];
    uint32_t event_first, event_count;
    double mouse[2];
    // A bit for each button that is held and was pressed outside of the panel.
    uint32_t buttons_elsewhere;
    bool has_popup;

    float scale;
    bool same_line; // the next control continues the current line
    float label_width;
    struct im *im;          // see imgui_bridge.h
    struct gpu_atlas atlas; // texture atlas of the font
};

// --- gui_items.c ---------------------------------------------------------------------------------
void items_begin(struct gui_state *own);
// Enters a control into the registry of this frame. Never returns NULL.
struct gui_item *items_add(struct gui_state *own, const char *id, enum gui_kind kind,
                           const char *label, const char *help);
// Returns the value that a script has set, or NULL. If the control is disabled, the value is
// rejected.
const char *items_wish(struct gui_state *own, const struct gui_item *item);
void items_refuse(struct gui_state *own, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void items_end(struct gui *gui);
// Returns the index of a group plus 1, and creates the group if it is new. Returns 0 if there are
// too many.
uint32_t items_group(struct gui_state *own, const char *id, const char *label, bool open_at_first);

// --- gui_values.c --------------------------------------------------------------------------------
// Writes numbers as text from which exactly the same bits can be read: "A" or "A,B,C". `out` has
// GUI_VALUE_MAX bytes.
void value_write(const double *value, uint32_t count, bool is_float, const struct gui_range *range,
                 char *out);
// Writes a number as it is displayed: with its unit and at most `digits` digits.
void value_show(double value, const struct gui_range *range, int digits, char *out);
// Reads `count` (at most 3) numbers that are separated by commas. On failure returns false, writes
// the reason to `why` (GUI_WHY_MAX bytes) and leaves `out` unchanged.
bool value_read(const char *text, uint32_t count, bool is_float, const struct gui_range *range,
                double *out, char *why);
bool value_read_switch(const char *text, bool *out, char *why);
bool value_read_choice(const char *text, const char *const *names, uint32_t *out, char *why);
// Returns the value, inside the range, that results from dragging `start` by `widths` times the
// width of the control.
double value_dragged(double start, double widths, const struct gui_range *range, bool is_float);

// --- gui_controls.c ------------------------------------------------------------------------------
// Records the rectangle of ImGui's last item, and whether the mouse is over it.
void controls_note_drawn(struct gui *gui, struct gui_item *item);

// --- gui_tabs.c ----------------------------------------------------------------------------------
// Draws the search box and the tabs.
void tabs_begin(struct gui *gui, const struct gui_tab *tabs);
// Returns whether a control has all words that are sought.
bool search_finds(const struct gui_state *own, const struct gui_item *item);
// Draws the names of the tab and the groups around a control that was found, unless the last one
// was in the same group.
void search_heading(struct gui_state *own);

// --- gui_events.c --------------------------------------------------------------------------------
void events_feed(struct gui *gui); // passes events to the current frame
void events_want(struct gui *gui); // decides whether the panel gets the next mouse events

#endif
