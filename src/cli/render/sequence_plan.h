// What the pictures of a sequence show: times of an animation, or views of a turntable.
#ifndef LAMPYRIS_CLI_RENDER_SEQUENCE_PLAN_H
#define LAMPYRIS_CLI_RENDER_SEQUENCE_PLAN_H

#include "cli/options.h"
#include "scene/core/scene.h"

// Returns the number of pictures, at least 1. An animation's is (end - start) frames_per_s,
// rounded.
uint32_t sequence_count(const struct sequence_options *options);
// Returns the time of an animation's picture, from 0, in seconds.
double sequence_seconds(const struct sequence_options *options, uint32_t index);
// Returns the angle of a turntable's view, from 0, in radians.
double sequence_angle(const struct sequence_options *options, uint32_t index);

// The axis about which a turntable turns the camera.
struct turntable {
    struct camera camera; // of the first view
    double point[3], axis[3];
};
// Finds the axis: vertical, through the point of the line of sight that is nearest to the middle of
// the scene's bounding box, or through the camera where it looks away from that. Vertical is the
// `up` of a scene file's camera; of models, and where has_up, the scene's up axis. The camera's
// horizon becomes level, unless it looks along the axis.
void turntable_init(const struct scene *scene, const struct camera *camera, bool has_up,
                    struct turntable *out);
// Turns the camera, counter-clockwise seen from where the axis points.
void turntable_camera(const struct turntable *turntable, double angle, struct camera *out);

#endif
