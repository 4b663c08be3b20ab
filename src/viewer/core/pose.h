// Animations. The scene is loaded at another time on the worker's thread, as with --at, and all
// edits are applied to it.
#ifndef LAMPYRIS_VIEWER_CORE_POSE_H
#define LAMPYRIS_VIEWER_CORE_POSE_H

#include "base/err.h"
#include "scene/json/scene_write.h"

struct viewer;

struct pose {
    struct scene_pose shown, wanted;
    bool plays;
    double speed;          // seconds of the animation per second of time
    struct pose_job *job;  // NULL if nothing is being loaded
    uint32_t deformations; // number of poses so far in which meshes were deformed
    // Scenes that own the vertices of the displayed pose and of the previous one.
    struct scene loaded, older;
};

// Sets the pose to that in which the scene was opened.
void pose_init(struct viewer *viewer);
// Returns whether the scene's file, or its base file, has an animation.
bool pose_has_animation(const struct viewer *viewer);
bool pose_is_pending(const struct viewer *viewer); // the requested pose is not displayed yet
bool pose_is_played(const struct viewer *viewer);
void pose_play(struct viewer *viewer, double seconds); // advances a playing animation by this time
// Adopts the loaded pose, and starts to load the next one. The image is not restarted if nothing
// moved.
void pose_update(struct viewer *viewer);
void pose_finish(struct viewer *viewer); // cancels loading and waits for its end

#endif
