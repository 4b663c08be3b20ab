// Moving a camera: flying and turning about a point. Plain mathematics on struct camera; +Y, or the
// axis that `up` of the camera is nearest to, is up.
#ifndef LAMPYRIS_VIEWER_CORE_RIG_H
#define LAMPYRIS_VIEWER_CORE_RIG_H

#include "scene/core/scene.h"

enum rig_mode { RIG_FLY, RIG_ORBIT, RIG_MODE_COUNT };
extern const char *const rig_mode_names[RIG_MODE_COUNT + 1];

struct rig {
    uint32_t mode;
    double up[3];         // unit; around which the view turns
    double target[3];     // of orbits; what the camera looks at
    double speed;         // of flying, metres a second; > 0
    double revolve_speed; // degrees a second; of the automatic revolution
    bool revolves;
    double look_degrees; // a pixel of mouse movement
};

struct rig_input {
    double forward, right, up; // -1 to 1: keys that are held
    bool slow;                 // Shift
    double look[2];            // pixels of the mouse: to the right, downwards
    double pan[2];             // pixels of the mouse, with the middle button
    double dolly;              // notches towards the target; negative: away
    uint32_t picture_height;   // pixels: what a pixel of panning is
    double seconds;            // since the last step
};

// Speed, target and up for a scene of that bounding box (world) and a camera in it.
void rig_init(struct rig *rig, const struct camera *camera, const double min[3],
              const double max[3]);
// False: nothing moved, and the camera has its bits.
bool rig_step(struct rig *rig, const struct rig_input *input, struct camera *camera);
// Makes a point the centre of orbits, and what the lens is focussed at where there is one.
void rig_focus(struct rig *rig, const double point[3], struct camera *camera);
// The whole box in the picture, seen in the direction in which the camera looks now.
void rig_frame(struct rig *rig, const double min[3], const double max[3], double aspect,
               struct camera *camera);

#endif
