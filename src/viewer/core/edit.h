// Every change that a user makes to the scene goes through this file, so that it can be undone and
// so that no more than necessary is rebuilt.
//
// Dragging a control makes many changes. Consecutive changes by the same control are one step of
// the history as long as the mouse button is held or the same key repeats.
#ifndef LAMPYRIS_VIEWER_CORE_EDIT_H
#define LAMPYRIS_VIEWER_CORE_EDIT_H

#include "scene/core/placement.h"
#include "scene/sky/surroundings.h"
#include "viewer/core/view.h"

// The work that a change requires, in ascending order of cost. The most costly change of a frame
// decides what is rebuilt.
enum change {
    CHANGE_NONE,
    CHANGE_SHOWN,    // exposure, tone curve or AOV changed: the film is kept
    CHANGE_LIMIT,    // the limit of samples changed: the film is kept
    CHANGE_CAMERA,   // the film is emptied, with renderer_set_camera()
    CHANGE_METHOD,   // a new renderer is created, for one side
    CHANGE_TABLES,   // materials, lights or environment changed: geometry_refresh() for all sides
    CHANGE_GEOMETRY, // the BVH is rebuilt as well
};

enum target {
    TARGET_CAMERA,
    TARGET_METHOD, // index: the side
    TARGET_SURROUNDINGS,
    TARGET_MATERIAL,
    TARGET_LIGHT,
    TARGET_OBJECT,  // visibility; index: instances first, then shapes, as in AOV ids
    TARGET_DISPLAY, // the display settings: struct shown
    TARGET_PLACE,   // placement of an object; index: the object
    TARGET_LISTS,   // the numbers of elements that can be added: struct list_counts
    TARGET_POSE,    // the requested time of an animation
    TARGET_SHAPE,   // all data of an added shape; index: the shape
    TARGET_COUNT
};

struct history;

bool history_create(struct history **out, struct err *err);
void history_destroy(struct history *history); // accepts NULL
void history_clear(struct history *history);   // called when another scene is opened

// These functions set a new value and report the change with viewer_changed(); they do nothing if
// the value is the same. `control` is the id of the control or gesture ("keys.fly") that made the
// change. They return false if the change is rejected, for example because a file cannot be read;
// the viewer then shows a message.
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
// The numbers of elements that editors can add. `lights` excludes the sun of a sky; new lights are
// inserted before it.
struct list_counts {
    uint32_t materials, lights, shapes;
};
struct list_counts edit_counts(const struct viewer *viewer);
// Adds a grey material, a light of intensity 0 or a square with sides of 1 m, or removes the last
// ones.
bool edit_lists(struct viewer *viewer, const struct list_counts *to, const char *control);
bool edit_shape(struct viewer *viewer, uint32_t index, const struct shape *to, const char *control);
// All edits between these two calls are one step of the history.
void edit_begin_group(struct viewer *viewer);
void edit_end_group(struct viewer *viewer);
// Closes the open step, because the mouse button or key was released.
void edit_close(struct viewer *viewer);

bool edit_undo(struct viewer *viewer); // false: there is nothing to undo
bool edit_redo(struct viewer *viewer);
// Undoes the last step permanently because its requirements (such as memory) could not be met.
// Returns false if nothing has changed since edit_settle(), so that the step cannot be the cause.
bool edit_revert(struct viewer *viewer);
void edit_settle(struct viewer *viewer); // called when all requested changes have been applied
uint32_t edit_undo_count(const struct viewer *viewer);
uint32_t edit_redo_count(const struct viewer *viewer);
// Returns the id of the control whose change would be undone next, or NULL.
const char *edit_undo_name(const struct viewer *viewer);

#endif
