// Every change that a user makes to the scene goes through here, so that it can be undone and so
// that no more is done anew than it needs.
//
// A control that is dragged makes many changes: those in a row of the same control, while the mouse
// button is held or the same key repeats, are one step of the history.
#ifndef LAMPYRIS_VIEWER_CORE_EDIT_H
#define LAMPYRIS_VIEWER_CORE_EDIT_H

#include "scene/core/placement.h"
#include "scene/sky/surroundings.h"
#include "viewer/core/view.h"

// From little to much: the greatest of a frame decides what is done in it.
enum change {
    CHANGE_NONE,
    CHANGE_SHOWN,    // exposure, tone, AOV: what is accumulated stays
    CHANGE_LIMIT,    // how long it accumulates: likewise
    CHANGE_CAMERA,   // the film is emptied: renderer_set_camera
    CHANGE_METHOD,   // a renderer is created anew, of one side
    CHANGE_TABLES,   // of all sides, materials, lights, surroundings: geometry_refresh
    CHANGE_GEOMETRY, // the hierarchy, too
};

enum target {
    TARGET_CAMERA,
    TARGET_METHOD, // index: side
    TARGET_SURROUNDINGS,
    TARGET_MATERIAL,
    TARGET_LIGHT,
    TARGET_OBJECT,  // visibility; index: instances, then shapes, as AOV ids number them
    TARGET_DISPLAY, // what is shown: struct shown
    TARGET_PLACE,   // where it is; index: an object
    TARGET_LISTS,   // how many there are of what can be added: struct list_counts
    TARGET_POSE,    // the time of an animation that is wanted
    TARGET_SHAPE,   // all of one that was added; index: of the shapes
    TARGET_COUNT
};

struct history;

bool history_create(struct history **out, struct err *err);
void history_destroy(struct history *history); // accepts NULL
void history_clear(struct history *history);   // of another scene

// Each compares, and does nothing where nothing is different. `control`: the id of what was used,
// or of the gesture ("keys.fly"). What they return is told to the viewer by themselves
// (viewer_changed). False: refused, with a message in the viewer (a file that cannot be read).
bool edit_camera(struct viewer *viewer, const struct camera *to, const char *control);
bool edit_method(struct viewer *viewer, uint32_t side, const struct method *to,
                 const char *control);
bool edit_surroundings(struct viewer *viewer, const struct surroundings *to, const char *control);
bool edit_material(struct viewer *viewer, uint32_t index, const struct material *to,
                   const char *control);
bool edit_light(struct viewer *viewer, uint32_t index, const struct light *to, const char *control);
bool edit_visible(struct viewer *viewer, uint32_t object, bool visible, const char *control);
bool edit_place(struct viewer *viewer, uint32_t object, const struct placement *to,
                const char *control);
struct shown;
bool edit_shown(struct viewer *viewer, const struct shown *to, const char *control);
struct scene_pose;
bool edit_pose(struct viewer *viewer, const struct scene_pose *to, const char *control);
// How many there are of what editors add. Lights: without a sky's sun, before which they come.
struct list_counts {
    uint32_t materials, lights, shapes;
};
struct list_counts edit_counts(const struct viewer *viewer);
// Adds a grey material, a light that sends nothing, a square of 1 m; or takes the last ones away.
bool edit_lists(struct viewer *viewer, const struct list_counts *to, const char *control);
bool edit_shape(struct viewer *viewer, uint32_t index, const struct shape *to, const char *control);
// All edits between the two are one step of the history.
void edit_begin_group(struct viewer *viewer);
void edit_end_group(struct viewer *viewer);
// Ends the step that is open: the mouse button or key was let go.
void edit_close(struct viewer *viewer);

bool edit_undo(struct viewer *viewer); // false: there is nothing
bool edit_redo(struct viewer *viewer);
// Takes the last step back, for good, where what it asked for could not be had (memory). False:
// nothing was changed since edit_settle, so that this was not the reason.
bool edit_revert(struct viewer *viewer);
void edit_settle(struct viewer *viewer); // all that was asked for is done
uint32_t edit_undo_count(const struct viewer *viewer);
uint32_t edit_redo_count(const struct viewer *viewer);
const char *edit_undo_name(const struct viewer *viewer); // the control, or NULL

#endif
