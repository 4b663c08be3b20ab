// Computes the times of the pictures of an animation, or the views of a turntable.
#ifndef LAMPYRIS_CLI_RENDER_SEQUENCE_PLAN_H
#define LAMPYRIS_CLI_RENDER_SEQUENCE_PLAN_H

#include "cli/options.h"
#include "scene/core/scene.h"

// Returns the number of pictures, at least 1. For an animation, it is (end - start) * frames_per_s,
// rounded to the nearest integer.
uint32_t sequence_count(const struct sequence_options *options);
// Returns the time, in seconds, of picture `index`, from 0, of an animation.
double sequence_seconds(const struct sequence_options *options, uint32_t index);
// Returns the angle, in radians, of view `index`, from 0, of a turntable.
double sequence_angle(const struct sequence_options *options, uint32_t index);

// The axis about which a turntable turns the camera.
struct turntable {
    struct camera camera; // of the first view
    double point[3], axis[3];
};
// Finds the vertical axis through the point of the line of sight that is nearest to the middle of
// the scene's bounding box. If the camera looks away from that middle, the axis goes through the
// camera. The vertical direction is the `up` of the camera in a scene file. For models, for cameras
// that the program chose, and with has_up (--up), it is the up axis of the scene. The camera is
// rolled until its horizon is level, unless it looks along the axis.
void turntable_init(const struct scene *scene, const struct camera *camera, bool has_up,
                    struct turntable *out);
// Returns the camera of a view. It is turned about the axis by `angle`, in radians,
// counter-clockwise as seen from above.
void turntable_camera(const struct turntable *turntable, double angle, struct camera *out);

#endif
