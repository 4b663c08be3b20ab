// Cameras that are far from all that they see. A direction in single precision is off by 2^-24 of
// the distance, 6 m at 1e8 m; so the rays of such a camera begin near the scene, on a plane across
// the line of sight, where the picture's axes lie as double precision has found them.
#ifndef LAMPYRIS_RENDER_FAR_CAMERA_H
#define LAMPYRIS_RENDER_FAR_CAMERA_H

#include "flatten/flatten.h"

// Returns whether it is so far that FEATURE_FAR_CAMERA is needed; false for panoramas, whose pixels
// are larger than what directions are off by.
bool camera_is_far(const struct flat_scene *flat, const struct camera *camera);

// How far from the camera along its line of sight rays begin, in the flat scene's unit: all that
// has bounds is beyond, and no plane without end is on the way there. 0: at the camera. `right` and
// `up` are the picture's axes as in struct gpu_frame.
double far_camera_start(const struct flat_scene *flat, const struct camera *camera,
                        const double right[3], const double up[3]);

// What is wrong with where a camera is.
enum far_fault_kind {
    FAR_FAULT_NONE,
    FAR_FAULT_SCENE, // the scene is too small in the picture to be found
    FAR_FAULT_PIXEL, // single precision cannot tell the picture's pixels apart
};
struct far_fault {
    enum far_fault_kind kind;
    double extent, distance; // of the scene, metres
    double pixels;           // that it is across
    double pixel, direction; // sizes of a pixel, and of the steps between directions, radians
};
struct far_fault far_camera_judge(const struct flat_scene *flat, const struct camera *camera,
                                  uint32_t height);
// Warns of it.
void far_camera_warn(const struct flat_scene *flat, const struct camera *camera, uint32_t height);

#endif
