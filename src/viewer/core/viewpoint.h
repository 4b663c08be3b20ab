// From where the scene is seen, and what moves that.
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
    struct camera camera;  // of all sides
    uint32_t camera_index; // of the scene's, that it began with
    struct camera_rig rig;
    bool wants_target; // the rig's is to be found in the first picture
    struct keys keys;
    struct saved_view saved[VIEWER_SAVED_VIEWS];
    bool is_moving; // the camera moved, or the scene changed, a moment ago
    struct frame_budget pace;
};

#endif
