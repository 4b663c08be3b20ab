// Handles cameras that are far from everything they see. At a distance of 1e8 m, a direction in
// single precision has an error of 2^-24 of that distance, 6 m. Rays of such a camera therefore
// begin near the scene, on a plane across the line of sight; the image's axes on this plane are
// computed in double precision.
#ifndef LAMPYRIS_RENDER_FAR_CAMERA_H
#define LAMPYRIS_RENDER_FAR_CAMERA_H

#include "flatten/flatten.h"

// Returns whether the camera is so far away that FEATURE_FAR_CAMERA is needed. It is always false
// for panoramas, whose pixels are larger than the error of directions.
bool camera_is_far(const struct flat_scene *flat, const struct camera *camera);

// Returns the distance from the camera, along its line of sight and in the flat scene's unit, at
// which rays begin. Everything with finite bounds is beyond it, and no infinite plane is in front
// of it. 0: rays begin at the camera. `right` and `up` are the image's axes as in struct gpu_frame.
double far_camera_start(const struct flat_scene *flat, const struct camera *camera,
                        const double right[3], const double up[3]);

// The problem with a camera's position.
enum far_fault_kind {
    FAR_FAULT_NONE,
    FAR_FAULT_SCENE, // the scene covers so little of a pixel that samples miss it
    FAR_FAULT_PIXEL, // single precision cannot resolve directions of pixels
};
struct far_fault {
    enum far_fault_kind kind;
    double extent, distance; // the scene's size and distance, in metres
    double pixels;           // width of the scene in the image, in pixels
    double pixel, direction; // radians: angular size of a pixel, and of the step between directions
};
struct far_fault far_camera_judge(const struct flat_scene *flat, const struct camera *camera,
                                  uint32_t height);
// Warns of the problem that far_camera_judge() finds, if any.
void far_camera_warn(const struct flat_scene *flat, const struct camera *camera, uint32_t height);

#endif
