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
    struct camera camera;  // the camera of all sides
    uint32_t camera_index; // index of the scene's camera from which it started
    struct camera_rig rig;
    bool wants_target; // the rig's target is to be determined from the first image
    struct keys keys;
    struct saved_view saved[VIEWER_SAVED_VIEWS];
    bool is_moving; // the camera or the scene changed a moment ago
    struct frame_budget pace;
};

#endif
