// The panel's widgets: a thin layer over Dear ImGui, in C. Each has an id ("camera.fov"), by which
// scripts and tests find it, and a line of help.
//
// Immediate: a widget is drawn by calling its function in every frame between gui_begin and
// gui_end; it returns true in the frame in which the user, or a script, changed its value.
//
// One thread.
#ifndef LAMPYRIS_VIEWER_GUI_GUI_H
#define LAMPYRIS_VIEWER_GUI_GUI_H

#include "base/err.h"
#include "gpu/screen.h"
#include "viewer/window/window.h"
#include <stdbool.h>
#include <stdint.h>

#define GUI_ID_MAX 96
#define GUI_VALUE_MAX 256
#define GUI_LABEL_MAX 64
#define GUI_HELP_MAX 1024
#define GUI_ITEMS_MAX 2048

enum gui_kind {
    GUI_GROUP,  // opens and closes; value "open" or "closed"
    GUI_BUTTON, // value ""
    GUI_SWITCH, // "on" or "off"
    GUI_NUMBER, // decimal
    GUI_CHOICE, // one of the words
    GUI_COLOR,  // "R,G,B"
    GUI_VECTOR, // "X,Y,Z"
    GUI_TEXT,
    GUI_ROW, // row of a list: "on" if it is the chosen one
};

// A control of the frame, as it was drawn.
struct gui_item {
    char id[GUI_ID_MAX];
    char value[GUI_VALUE_MAX]; // at the end of the frame
    enum gui_kind kind;
    float rect[4]; // left, top, right, bottom, pixels; the clickable region
    bool is_shown; // visible: not scrolled away or in a closed group
    bool is_enabled;
    char label[GUI_LABEL_MAX];
    const char *help; // the caller's
    double range[2];  // the least and the greatest value of a number; both 0: no range
    uint32_t group;   // see gui_state.h
};

struct gui {
    struct gui_item items[GUI_ITEMS_MAX]; // the controls of the last finished frame
    uint32_t item_count;
    bool wants_mouse, wants_keys; // the panel receives these events, and the camera must not
    bool is_busy;                 // a widget is being dragged or typed into
    bool is_hidden;               // set by the caller: the panel is not drawn, but scripts can use
                                  // its controls
    const char *used; // id of the control that changed a value last; the caller sets it to NULL
                      // before a row of controls that edit a copy
    const char *hovered_help; // help of the control under the mouse, or NULL
    bool is_floating;         // set by the caller: a window inside the window, not beside the image
    float width;              // part of the window's width that the panel takes; 0 hidden or
                              // floating
    float place[4];           // the panel's left, top, right, bottom, pixels; 0 while hidden
    struct gui_state *own;    // see gui_state.h
};

bool gui_create(float scale, struct gui *out, struct err *err); // scale: pixels per point
// Writes a control's help and, for a number, its range.
void gui_item_help(const struct gui_item *item, char out[GUI_HELP_MAX]);
void gui_finish(struct gui *gui);                       // accepts NULL and {0}
void gui_atlas(struct gui *gui, struct gpu_atlas *out); // the font's; lives as long as the gui
void gui_event(struct gui *gui, const struct event *event);
// Returns the panel's width, pixels, in a window of that width when it is not hidden.
float gui_panel_width(const struct gui *gui, uint32_t window_width);
// seconds: since the last frame.
void gui_begin(struct gui *gui, uint32_t width, uint32_t height, double seconds);
// Returns the drawing, valid until the next gui_begin. `items` are then those of this frame.
void gui_end(struct gui *gui, struct gpu_drawing *out);
// Returns an id that two controls of the last frame shared, which is a bug of the panel; or NULL.
const char *gui_duplicate(const struct gui *gui);

// --- for scripts ---------------------------------------------------------------------------------
// Gives the control this value in the next frame, as if the user had (buttons: pressed), also in
// closed groups. gui_set_result returns NULL if that succeeded, else the reason ("no control
// camera.fow; did you mean camera.fov?", "1.7 is outside [0, 1]"). Several calls before one frame
// are all applied; the result is the first failure.
void gui_set(struct gui *gui, const char *id, const char *value);
const char *gui_set_result(const struct gui *gui);
// Opens its groups and scrolls to it, so that its rect can be clicked two frames later.
void gui_reveal(struct gui *gui, const char *id);
const struct gui_item *gui_find(const struct gui *gui, const char *id);

// --- layout --------------------------------------------------------------------------------------
// The panel's window at the left. Returns false if it is hidden: nothing is drawn, but controls may
// be called all the same, for scripts.
// facts: below the title
bool gui_panel_begin(struct gui *gui, const char *title, const char *facts);
void gui_panel_end(struct gui *gui);
// Returns whether it is open. Controls are called in any case: those in a closed group are not
// drawn, but have an item (is_shown false) and can be set by scripts.
bool gui_group_begin(struct gui *gui, const char *id, const char *label, const char *help,
                     bool open_at_first);
void gui_group_end(struct gui *gui);
void gui_enabled(struct gui *gui,
                 bool enabled); // for the controls that follow, until a group begins or ends
// Returns whether the current controls are drawn: otherwise texts need not be formatted.
bool gui_is_drawn(const struct gui *gui);
void gui_same_line(struct gui *gui);
void gui_space(struct gui *gui);
void gui_line(struct gui *gui, const char *format, ...) __attribute__((format(printf, 2, 3)));
void gui_warning(struct gui *gui, const char *format, ...) __attribute__((format(printf, 2, 3)));
// A label at the left, as for controls, and a text in place of the value.
void gui_pair(struct gui *gui, const char *label, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
// A pair on one line, however long the text, so that the layout does not change.
void gui_fact(struct gui *gui, const char *label, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
// Text over the image with a dark background, with this upper left corner. Returns its height.
float gui_note(struct gui *gui, float x, float y, bool is_warning, const char *format, ...)
    __attribute__((format(printf, 5, 6)));
// A table of two columns over the centre of the image: keys and their functions. Ended by {NULL}.
struct gui_pair {
    const char *left, *right;
};
void gui_table(struct gui *gui, const struct gui_pair *rows, uint32_t count);
// A colour scale in the lower right corner of the image, from left to right: display values, red in
// the lowest byte. texts: for its left end, centre and right end.
void gui_legend(struct gui *gui, const uint32_t *colors, uint32_t count,
                const char *const texts[3]);
// A progress bar over the centre of the image.
void gui_progress(struct gui *gui, const char *what, double fraction);

// --- controls ------------------------------------------------------------------------------------
bool gui_button(struct gui *gui, const char *id, const char *label, const char *help);
bool gui_switch(struct gui *gui, const char *id, const char *label, const char *help, bool *value);
// A switch for a number that is 0 or 1.
bool gui_flag(struct gui *gui, const char *id, const char *label, const char *help,
              uint32_t *value);
struct gui_range {
    double min, max;
    bool logarithmic; // 0 is allowed as min
    bool integer;
    const char *unit;      // shown after the number; NULL: none
    const char *infinite;  // the word for max itself ("off", "unlimited"); NULL: none
    double greatest;       // the greatest number, where max is a word
    const char *least;     // the word for min itself ("off", "pinhole"); NULL: none
    const char *file_word; // the name of that word in scene files, which is also accepted; NULL:
                           // the same
    double drag; // change by dragging over the whole width of the control; 0: derived from the
                 // range
};
// All number controls append their range to `help`.
bool gui_number(struct gui *gui, const char *id, const char *label, const char *help,
                const struct gui_range *range, double *value);
bool gui_float(struct gui *gui, const char *id, const char *label, const char *help,
               const struct gui_range *range, float *value);
bool gui_count(struct gui *gui, const char *id, const char *label, const char *help,
               const struct gui_range *range, uint32_t *value);
// Edits an angle in radians, shown in degrees. `range` is in degrees.
bool gui_angle(struct gui *gui, const char *id, const char *label, const char *help,
               const struct gui_range *range, double *radians);
// names: ended by NULL.
bool gui_choice(struct gui *gui, const char *id, const char *label, const char *help,
                const char *const *names, uint32_t *value);
// Linear Rec. 709; components may be above 1.
bool gui_color(struct gui *gui, const char *id, const char *label, const char *help,
               const struct gui_range *range, float value[3]);
bool gui_vector(struct gui *gui, const char *id, const char *label, const char *help,
                const struct gui_range *range, double value[3]);
bool gui_text(struct gui *gui, const char *id, const char *label, const char *help, char *value,
              uint32_t size); // changed when the user ends it with Enter or leaves it
// Returns true when it is selected.
bool gui_row(struct gui *gui, const char *id, const char *label, const char *help, bool is_chosen);

// A list of any length with its own scrolling. Of 10^6 rows only the visible ones are called for,
// and those that scripts may find: the first GUI_LIST_IDS and the selected one.
//   struct gui_list list = {.count = n, .chosen = i, .height = 8};
//   gui_list_begin(gui, "materials", &list);
//   for (uint32_t row; gui_list_next(gui, &list, &row);)
//       gui_row(gui, …);
//   gui_list_end(gui, &list);
#define GUI_LIST_IDS 64u
struct gui_list {
    uint32_t count;  // number of rows
    uint32_t chosen; // or UINT32_MAX
    uint32_t height; // rows visible at once; fewer if there are fewer
    // Used by gui_list_next:
    uint32_t first, last; // the visible rows
    uint32_t next;
    bool was_drawn;
};
void gui_list_begin(struct gui *gui, const char *id, struct gui_list *list);
bool gui_list_next(struct gui *gui, struct gui_list *list, uint32_t *row);
void gui_list_end(struct gui *gui, struct gui_list *list);

// --- charts --------------------------------------------------------------------------------------
struct gui_bar {
    const char *label;
    double value;
};
// label NULL: an empty line.
void gui_bars(struct gui *gui, const struct gui_bar *bars, uint32_t count, const char *unit);
struct gui_curve {
    const char *label;
    const double *x, *y;      // both axes are logarithmic; values that are not positive and finite
                              // are omitted
    const double *low, *high; // the interval of each y, shown as a band; NULL: none
    const double *most;       // upper bounds, shown as arrows downwards if there is no y; NULL:
                              // none
    uint32_t count;
};
void gui_curves(struct gui *gui, const struct gui_curve *curves, uint32_t count,
                const char *x_label, const char *y_label);

#endif
