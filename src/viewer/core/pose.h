// Animations: the scene as it is at another time, loaded on the worker's thread as `--at` would
// have it, and taken over with all edits.
#ifndef LAMPYRIS_VIEWER_CORE_POSE_H
#define LAMPYRIS_VIEWER_CORE_POSE_H

#include "base/err.h"
#include "scene/json/scene_write.h"

struct viewer;

struct pose {
    struct scene_pose shown, wanted;
    bool plays;
    double speed;               // seconds of the animation a second
    struct pose_job *job;       // NULL: nothing is being loaded
    uint32_t deformations;      // how often a pose had meshes of another form than the last one
    struct scene loaded, older; // what holds the vertices of the shown pose, and of the last one
};

// Sets the pose in which the scene was opened.
void pose_init(struct viewer *viewer);
// Returns whether the scene's file, or its base, has an animation.
bool pose_has_animation(const struct viewer *viewer);
bool pose_is_pending(const struct viewer *viewer); // another one is wanted than is shown
bool pose_is_played(const struct viewer *viewer);
void pose_play(struct viewer *viewer, double seconds); // so much time has passed
// Takes over what was loaded, and has the next one loaded. Nothing begins anew where nothing moved.
void pose_update(struct viewer *viewer);
void pose_finish(struct viewer *viewer); // ends what is under way, and waits for that

#endif
