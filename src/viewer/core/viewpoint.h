// The camera, and the state that moves it.
#ifndef LAMPYRIS_VIEWER_CORE_VIEWPOINT_H
#define LAMPYRIS_VIEWER_CORE_VIEWPOINT_H

#include "viewer/core/camera_rig.h"
#include "viewer/core/frame_budget.h"
#include "viewer/core/keys.h"

#define VIEWER_SAVED_VIEWS 16u

struct saved_view {
    bool is_used;
    struct camera camera;
};

struct viewpoint {
    struct camera camera;  // the camera that all sides share
    uint32_t camera_index; // the camera of the scene with which it began
    struct camera_rig rig;
    bool wants_target; // the rig's target is to be found in the first image
    struct keys keys;
    struct saved_view saved[VIEWER_SAVED_VIEWS];
    bool is_moving; // the camera moved, or the scene changed, a moment ago
    struct frame_budget pace;
};

#endif
