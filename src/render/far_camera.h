// Cameras that are far from everything they see. A direction in single precision has an error of
// 2^-24 of the distance, 6 m at 1e8 m. The rays of such a camera therefore begin near the scene, on
// a plane across the line of sight, on which double precision has placed the picture's axes.
#ifndef LAMPYRIS_RENDER_FAR_CAMERA_H
#define LAMPYRIS_RENDER_FAR_CAMERA_H

#include "flatten/flatten.h"

// Returns whether the camera is so far that FEATURE_FAR_CAMERA is needed; false for panoramas,
// whose pixels are larger than the error of directions.
bool camera_is_far(const struct flat_scene *flat, const struct camera *camera);

// Returns the distance from the camera along its line of sight at which rays begin, in the flat
// scene's unit: everything with bounds is beyond it, and no infinite plane is before it. 0: rays
// begin at the camera. `right` and `up` are the picture's axes as in struct gpu_frame.
double far_camera_start(const struct flat_scene *flat, const struct camera *camera,
                        const double right[3], const double up[3]);

// The problem with a camera's position.
enum far_fault_kind {
    FAR_FAULT_NONE,
    FAR_FAULT_SCENE, // the scene is too small in the picture to be found by samples
    FAR_FAULT_PIXEL, // single precision cannot resolve the picture's pixels
};
struct far_fault {
    enum far_fault_kind kind;
    double extent, distance; // the scene's size and distance, in metres
    double pixels;           // the number that the scene is across
    double pixel, direction; // angular size of a pixel, and of the step between directions, radians
};
struct far_fault far_camera_judge(const struct flat_scene *flat, const struct camera *camera,
                                  uint32_t height);
// Warns of such a problem.
void far_camera_warn(const struct flat_scene *flat, const struct camera *camera, uint32_t height);

#endif
