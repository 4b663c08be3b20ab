// Scales a scene to another unit of length.
#ifndef LAMPYRIS_CHECK_SCALED_SCENE_H
#define LAMPYRIS_CHECK_SCALED_SCENE_H

#include "scene/core/scene.h"

// Multiplies every length of a scene by `factor`, and dependent quantities so that the radiance is
// unchanged: intensities by its square, extinctions by its inverse. All cameras are scaled.
void scale_scene(struct scene *scene, double factor);

#endif
