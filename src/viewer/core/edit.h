// Every change that a user makes to the scene goes through this file, so that it can be undone and
// so that no more than necessary is rebuilt.
//
// Dragging a control makes many changes: consecutive changes by the same control, while the mouse
// button is held or the same key repeats, are one step of the history.
#ifndef LAMPYRIS_VIEWER_CORE_EDIT_H
#define LAMPYRIS_VIEWER_CORE_EDIT_H

#include "scene/core/placement.h"
#include "scene/sky/surroundings.h"
#include "viewer/core/view.h"

// In ascending order of cost: the greatest change of a frame decides what is rebuilt.
enum change {
    CHANGE_NONE,
    CHANGE_SHOWN,    // exposure, tone, AOV: the film is kept
    CHANGE_LIMIT,    // the limit of samples: the film is kept
    CHANGE_CAMERA,   // the film is emptied: renderer_set_camera
    CHANGE_METHOD,   // a new renderer is created, for one side
    CHANGE_TABLES,   // for all sides: materials, lights, environment: geometry_refresh
    CHANGE_GEOMETRY, // the BVH is rebuilt, too
};

enum target {
    TARGET_CAMERA,
    TARGET_METHOD, // index: side
    TARGET_SURROUNDINGS,
    TARGET_MATERIAL,
    TARGET_LIGHT,
    TARGET_OBJECT,  // visibility; index: instances, then shapes, as in AOV ids
    TARGET_DISPLAY, // the display settings: struct shown
    TARGET_PLACE,   // placement; index: an object
    TARGET_LISTS,   // the numbers of elements that can be added: struct list_counts
    TARGET_POSE,    // the requested time of an animation
    TARGET_SHAPE,   // all of a shape that was added; index: of the shapes
    TARGET_COUNT
};

struct history;

bool history_create(struct history **out, struct err *err);
void history_destroy(struct history *history); // accepts NULL
void history_clear(struct history *history);   // for another scene

// These compare, and do nothing if nothing differs. `control`: the id of the control that was used,
// or of the gesture ("keys.fly"). They report their change with viewer_changed. They return false
// if the change is rejected, with a message in the viewer (a file that cannot be read).
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
// The numbers of elements that editors add. `lights` excludes a sky's sun, before which they are
// inserted.
struct list_counts {
    uint32_t materials, lights, shapes;
};
struct list_counts edit_counts(const struct viewer *viewer);
// Adds a grey material, a light of intensity 0, or a square of 1 m; or removes the last ones.
bool edit_lists(struct viewer *viewer, const struct list_counts *to, const char *control);
bool edit_shape(struct viewer *viewer, uint32_t index, const struct shape *to, const char *control);
// All edits between these two calls are one step of the history.
void edit_begin_group(struct viewer *viewer);
void edit_end_group(struct viewer *viewer);
// Ends the open step: the mouse button or key was released.
void edit_close(struct viewer *viewer);

bool edit_undo(struct viewer *viewer); // false: there is nothing to undo
bool edit_redo(struct viewer *viewer);
// Undoes the last step permanently if what it required cannot be had (memory). Returns false if
// nothing has changed since edit_settle, so that the step is not the cause.
bool edit_revert(struct viewer *viewer);
void edit_settle(struct viewer *viewer); // all requested changes have been applied
uint32_t edit_undo_count(const struct viewer *viewer);
uint32_t edit_redo_count(const struct viewer *viewer);
const char *edit_undo_name(const struct viewer *viewer); // id of the control, or NULL

#endif
