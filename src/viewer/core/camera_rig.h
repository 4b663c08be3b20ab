// Moves a camera: it flies, or it orbits a point. These functions only compute with struct camera.
// The up axis is +Y, or the coordinate axis nearest to the camera's `up`.
#ifndef LAMPYRIS_VIEWER_CORE_CAMERA_RIG_H
#define LAMPYRIS_VIEWER_CORE_CAMERA_RIG_H

#include "scene/core/scene.h"

enum camera_rig_mode { CAMERA_RIG_FLY, CAMERA_RIG_ORBIT, CAMERA_RIG_MODE_COUNT };
extern const char *const camera_rig_mode_names[CAMERA_RIG_MODE_COUNT + 1];

struct camera_rig {
    uint32_t mode;
    double up[3];         // unit vector; the axis about which the view rotates
    double target[3];     // centre of orbits, at which the camera looks
    double speed;         // flying speed, metres per second; > 0
    double revolve_speed; // speed of the automatic revolution, degrees per second
    bool revolves;
    double look_degrees; // degrees per pixel of mouse movement in fly mode
};

struct camera_rig_input {
    // Held keys, each from -1 to 1; `right` also changes the speed of a revolution.
    double forward, right, up;
    bool slow;      // Shift is held
    double look[2]; // movement of the mouse in pixels: to the right, downwards
    double pan[2];  // movement of the mouse in pixels with the middle button held
    double dolly;   // notches of the wheel towards the target; negative: away from it
    // Width of the window in pixels; in orbit mode, a drag across it is half a turn. 0: orbits turn
    // by look_degrees.
    uint32_t window_width;
    uint32_t picture_height; // pixels; determines the distance that one pixel of panning moves
    double seconds;          // time since the last step
};

// Sets speed, target and up axis for a camera and a scene with this bounding box in world space.
void camera_rig_init(struct camera_rig *rig, const struct camera *camera, const double min[3],
                     const double max[3]);
// The greatest speed of the automatic revolution, in degrees per second, and the change of that
// speed by a key that is held for a second.
#define REVOLVE_SPEED_MAX 360.0
#define REVOLVE_ACCELERATION 45.0

// Moves the camera by one step. Returns false if it did not move; it is then bitwise unchanged.
bool camera_rig_step(struct camera_rig *rig, const struct camera_rig_input *input,
                     struct camera *camera);
// Makes a point the centre of orbits and, if the camera has a lens, the point in focus.
void camera_rig_focus(struct camera_rig *rig, const double point[3], struct camera *camera);
// Moves the camera, without turning it, to where the whole box is in view.
void camera_rig_frame(struct camera_rig *rig, const double min[3], const double max[3],
                      double aspect, struct camera *camera);

#endif
