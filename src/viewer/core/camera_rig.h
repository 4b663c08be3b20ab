// Moving a camera: flying and turning about a point. Plain mathematics on struct camera; +Y, or the
// axis that `up` of the camera is nearest to, is up.
#ifndef LAMPYRIS_VIEWER_CORE_CAMERA_RIG_H
#define LAMPYRIS_VIEWER_CORE_CAMERA_RIG_H

#include "scene/core/scene.h"

enum camera_rig_mode { CAMERA_RIG_FLY, CAMERA_RIG_ORBIT, CAMERA_RIG_MODE_COUNT };
extern const char *const camera_rig_mode_names[CAMERA_RIG_MODE_COUNT + 1];

struct camera_rig {
    uint32_t mode;
    double up[3];         // unit; around which the view turns
    double target[3];     // of orbits; what the camera looks at
    double speed;         // of flying, metres a second; > 0
    double revolve_speed; // degrees a second; of the automatic revolution
    bool revolves;
    double look_degrees; // a pixel of mouse movement
};

struct camera_rig_input {
    double forward, right, up; // -1 to 1: keys that are held; `right`: the speed of a revolution
    bool slow;                 // Shift
    double look[2];            // pixels of the mouse: to the right, downwards
    double pan[2];             // pixels of the mouse, with the middle button
    double dolly;              // notches towards the target; negative: away
    uint32_t picture_height;   // pixels: what a pixel of panning is
    double seconds;            // since the last step
};

// Speed, target and up for a scene of that bounding box (world) and a camera in it.
void camera_rig_init(struct camera_rig *rig, const struct camera *camera, const double min[3],
                     const double max[3]);
// The automatic revolution's greatest speed in degrees a second, and its change by a key that is
// held for a second.
#define REVOLVE_SPEED_MAX 360.0
#define REVOLVE_ACCELERATION 45.0

// False: nothing moved, and the camera has its bits.
bool camera_rig_step(struct camera_rig *rig, const struct camera_rig_input *input,
                     struct camera *camera);
// Makes a point the centre of orbits, and what the lens is focussed at where there is one.
void camera_rig_focus(struct camera_rig *rig, const double point[3], struct camera *camera);
// The whole box in the picture, seen in the direction in which the camera looks now.
void camera_rig_frame(struct camera_rig *rig, const double min[3], const double max[3],
                      double aspect, struct camera *camera);

#endif
