// The panel's widgets: a thin layer over Dear ImGui, in C. Each widget has an id ("camera.fov"), by
// which scripts and tests find it, and a line of help.
//
// The interface is immediate-mode: calling a widget's function in every frame, between gui_begin
// and gui_end, draws it. The function returns true in the frame in which the user or a script has
// changed the value. Only one thread may use it.
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
    GUI_GROUP,  // can be opened and closed; its value is "open" or "closed"
    GUI_BUTTON, // its value is ""
    GUI_SWITCH, // its value is "on" or "off"
    GUI_NUMBER, // its value is a decimal number
    GUI_CHOICE, // its value is one of several words
    GUI_COLOR,  // its value is "R,G,B"
    GUI_VECTOR, // its value is "X,Y,Z"
    GUI_TEXT,
    GUI_ROW, // a row of a list; its value is "on" if it is selected
    GUI_TAB, // a tab of the panel; its value is "on" if it is open
};

// A control as it was drawn in this frame.
struct gui_item {
    char id[GUI_ID_MAX];
    char value[GUI_VALUE_MAX]; // the value at the end of the frame
    enum gui_kind kind;
    float rect[4]; // the clickable rectangle: left, top, right, bottom, in pixels
    bool is_shown; // it is visible: neither scrolled away nor in a closed group or tab
    bool is_enabled;
    char label[GUI_LABEL_MAX];
    const char *help; // owned by the caller
    double range[2];  // least and greatest value of a number; both are 0 if there is no range
    uint32_t group;   // index of its group plus 1; 0: none
};

struct gui {
    struct gui_item items[GUI_ITEMS_MAX]; // controls of the last frame that was finished
    uint32_t item_count;
    bool wants_mouse, wants_keys; // the panel receives these events; the camera must ignore them
    bool is_busy;                 // a widget is being dragged or typed into
    bool is_hidden; // set by the caller: the panel is not drawn, but scripts can use its controls
    // Id of the control that last changed a value. The caller sets it to NULL before a row of
    // controls that edit a copy.
    const char *used;
    const char *hovered_help; // help of the control under the mouse, or NULL
    bool is_floating; // set by the caller: the panel is a window over the image, not beside it
    float width;      // width of the panel in the window; 0 if it is hidden or floating
    // Rectangle of the panel: left, top, right, bottom, in pixels; 0 while it is hidden.
    float place[4];
    struct gui_state *own; // see gui_state.h
};

bool gui_create(float scale, struct gui *out, struct err *err); // scale: pixels per point
// Writes the help text of a control and, for a number, its range.
void gui_item_help(const struct gui_item *item, char out[GUI_HELP_MAX]);
void gui_finish(struct gui *gui); // accepts NULL and {0}
// Returns the atlas of the font, valid as long as the gui.
void gui_atlas(struct gui *gui, struct gpu_atlas *out);
void gui_event(struct gui *gui, const struct event *event);
// Returns the width, in pixels, that the panel has in a window of the given width if it is not
// hidden.
float gui_panel_width(const struct gui *gui, uint32_t window_width);
// Begins a frame. `seconds` is the time since the last one.
void gui_begin(struct gui *gui, uint32_t width, uint32_t height, double seconds);
// Ends a frame and returns its drawing, which is valid until the next gui_begin. `items` has the
// controls of this frame.
void gui_end(struct gui *gui, struct gpu_drawing *out);
// Returns an id that two controls of the last frame share, which is an error in the panel; or NULL.
const char *gui_duplicate(const struct gui *gui);

// --- for scripts ---------------------------------------------------------------------------------
// gui_set() sets a control to this value in the next frame, as if the user had done it (a button is
// pressed), even in a closed group. gui_set_result() returns NULL if that succeeded, otherwise the
// reason ("no control camera.fow; did you mean camera.fov?", "1.7 is outside [0, 1]"). Several
// calls before a frame are all applied, and the result is that of the first failure.
void gui_set(struct gui *gui, const char *id, const char *value);
const char *gui_set_result(const struct gui *gui);
// Opens the tab and the groups around a control, ends a search, and scrolls to the control. Two
// frames later its rectangle can be clicked.
void gui_reveal(struct gui *gui, const char *id);
const struct gui_item *gui_find(const struct gui *gui, const char *id);

// --- layout --------------------------------------------------------------------------------------
// A tab of the panel. One of them is open at a time.
struct gui_tab {
    const char *id, *label, *help;
};
// Begins the panel's window at the left. Returns false if it is hidden: then nothing is drawn, but
// controls may still be called, for scripts. `facts` is shown below the title. `tabs` ends with
// {NULL}; NULL: there are none. Above the tabs is a box ("panel.search") for words. While it has
// any, the controls of all tabs and groups are drawn whose labels, ids or helps contain all words.
bool gui_panel_begin(struct gui *gui, const char *title, const char *facts,
                     const struct gui_tab *tabs);
void gui_panel_end(struct gui *gui);
// All controls must be between these calls if the panel has tabs. Those of a tab that is not open
// must be called in any case, as for groups. Tabs are not nested.
void gui_tab_begin(struct gui *gui, const char *id);
void gui_open_tab(struct gui *gui, const char *id);
void gui_tab_end(struct gui *gui);
// Begins a group, and returns whether it is open. Controls must be called in any case: those in a
// closed group are not drawn, but have an item (with is_shown false), and scripts can set them.
bool gui_group_begin(struct gui *gui, const char *id, const char *label, const char *help,
                     bool open_at_first);
void gui_group_end(struct gui *gui);
void gui_enabled(struct gui *gui,
                 bool enabled); // applies to the controls that follow, until a group begins or ends
// Has the effect of gui_enabled(). In addition, controls that do not apply are drawn only if the
// user searches for them.
void gui_applies(struct gui *gui, bool applies);
// Returns whether texts that follow are drawn; if not, texts need not be formatted.
bool gui_is_drawn(const struct gui *gui);
void gui_same_line(struct gui *gui);
void gui_space(struct gui *gui);
void gui_line(struct gui *gui, const char *format, ...) __attribute__((format(printf, 2, 3)));
void gui_warning(struct gui *gui, const char *format, ...) __attribute__((format(printf, 2, 3)));
// Draws a label at the left, as for controls, and a text instead of a value.
void gui_pair(struct gui *gui, const char *label, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
// Draws a label and a text on a single line, even if the text is long, so that the layout does not
// change.
void gui_fact(struct gui *gui, const char *label, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
// Draws text over the image, on a dark background, with this upper left corner. Returns its height.
float gui_note(struct gui *gui, float x, float y, bool is_warning, const char *format, ...)
    __attribute__((format(printf, 5, 6)));
// Draws a table of two columns, keys and their functions, over the centre of the image. The list
// ends with {NULL}.
struct gui_pair {
    const char *left, *right;
};
void gui_table(struct gui *gui, const struct gui_pair *rows, uint32_t count);
// Draws a colour scale in the lower right corner of the image. Colours go from left to right; they
// are display values with red in the lowest byte. `texts` are drawn at the left end, the centre and
// the right end.
void gui_legend(struct gui *gui, const uint32_t *colors, uint32_t count,
                const char *const texts[3]);
// Draws a line over the image. Its dark border makes it visible on images of any colour.
void gui_stroke(struct gui *gui, const double from[2], const double to[2]);
// Draws a progress bar over the centre of the image.
void gui_progress(struct gui *gui, const char *what, double fraction);

// --- controls ------------------------------------------------------------------------------------
bool gui_button(struct gui *gui, const char *id, const char *label, const char *help);
bool gui_switch(struct gui *gui, const char *id, const char *label, const char *help, bool *value);
// Draws a switch for a number that is 0 or 1.
bool gui_flag(struct gui *gui, const char *id, const char *label, const char *help,
              uint32_t *value);
struct gui_range {
    double min, max;
    bool logarithmic; // min may be 0
    bool integer;
    const char *unit;     // drawn after the number; NULL: none
    const char *infinite; // a word that replaces the value max ("off", "unlimited"); NULL: none
    double greatest;      // the greatest number, if max is a word
    const char *least;    // a word that replaces the value min ("off", "pinhole"); NULL: none
    // The corresponding word in scene files, which is accepted as well; NULL: it is the same.
    const char *file_word;
    // Change of the value if the mouse is dragged over the whole width of the control; 0: derived
    // from the range.
    double drag;
};
// Controls for numbers append their range to `help`.
bool gui_number(struct gui *gui, const char *id, const char *label, const char *help,
                const struct gui_range *range, double *value);
bool gui_float(struct gui *gui, const char *id, const char *label, const char *help,
               const struct gui_range *range, float *value);
bool gui_count(struct gui *gui, const char *id, const char *label, const char *help,
               const struct gui_range *range, uint32_t *value);
// Edits an angle in radians, which is shown in degrees. `range` is in degrees.
bool gui_angle(struct gui *gui, const char *id, const char *label, const char *help,
               const struct gui_range *range, double *radians);
// Draws a choice between words. `names` ends with NULL.
bool gui_choice(struct gui *gui, const char *id, const char *label, const char *help,
                const char *const *names, uint32_t *value);
// Edits a colour in linear Rec. 709; its components may be above 1.
bool gui_color(struct gui *gui, const char *id, const char *label, const char *help,
               const struct gui_range *range, float value[3]);
bool gui_vector(struct gui *gui, const char *id, const char *label, const char *help,
                const struct gui_range *range, double value[3]);
bool gui_text(struct gui *gui, const char *id, const char *label, const char *help, char *value,
              uint32_t size); // changes when the user presses Enter or leaves the control
// Draws a row of a list. Returns true when the user selects it.
bool gui_row(struct gui *gui, const char *id, const char *label, const char *help, bool is_chosen);

// Draws a list of any length with its own scrolling. gui_list_next() returns only the rows that are
// visible, and those that scripts may find: the first GUI_LIST_IDS rows and the selected one. So a
// list may have 10^6 rows.
//
//     struct gui_list list = {.count = n, .chosen = i, .height = 8};
//     gui_list_begin(gui, "materials", &list);
//     for (uint32_t row; gui_list_next(gui, &list, &row);)
//         gui_row(gui, …);
//     gui_list_end(gui, &list);
#define GUI_LIST_IDS 64u
struct gui_list {
    uint32_t count;  // number of rows
    uint32_t chosen; // selected row; UINT32_MAX: none
    uint32_t height; // number of rows that are visible at once; fewer if the list is shorter
    // These members are used by gui_list_next():
    uint32_t first, last; // the first visible row, and the row after the last visible one
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
// Draws horizontal bars. A bar whose label is NULL is an empty line.
void gui_bars(struct gui *gui, const struct gui_bar *bars, uint32_t count, const char *unit);
struct gui_curve {
    const char *label;
    // Both axes are logarithmic; points that are not positive and finite are omitted.
    const double *x, *y;
    const double *low, *high; // interval of each y, drawn as a band; NULL: none
    const double *most; // upper bounds, drawn as downward arrows at points without y; NULL: none
    uint32_t count;
};
void gui_curves(struct gui *gui, const struct gui_curve *curves, uint32_t count,
                const char *x_label, const char *y_label);

#endif
