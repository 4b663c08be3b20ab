// Animations: loads the scene at another time on the worker's thread, as `--at` does, and applies
// all edits to it.
#ifndef LAMPYRIS_VIEWER_CORE_POSE_H
#define LAMPYRIS_VIEWER_CORE_POSE_H

#include "base/err.h"
#include "scene/json/scene_write.h"

struct viewer;

struct pose {
    struct scene_pose shown, wanted;
    bool plays;
    double speed;               // seconds of the animation per second
    struct pose_job *job;       // NULL: nothing is being loaded
    uint32_t deformations;      // counts poses with meshes deformed relative to the previous pose
    struct scene loaded, older; // own the vertices of the displayed pose, and of the previous one
};

// Sets the pose in which the scene was opened.
void pose_init(struct viewer *viewer);
// Returns whether the scene's file, or its base, has an animation.
bool pose_has_animation(const struct viewer *viewer);
bool pose_is_pending(const struct viewer *viewer); // the requested pose is not the displayed one
bool pose_is_played(const struct viewer *viewer);
void pose_play(struct viewer *viewer, double seconds); // this much time has passed
// Takes over the loaded pose, and starts loading the next one. Restarts nothing if nothing moved.
void pose_update(struct viewer *viewer);
void pose_finish(struct viewer *viewer); // cancels loading and waits for its end

#endif
