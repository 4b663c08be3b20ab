// Converts a scene to another unit of length.
#ifndef LAMPYRIS_CHECK_SCALED_SCENE_H
#define LAMPYRIS_CHECK_SCALED_SCENE_H

#include "scene/core/scene.h"

// Multiplies all lengths of a scene, including its cameras, by `factor`. Intensities are multiplied
// by its square and extinctions divided by it, so that the radiance is unchanged.
void scale_scene(struct scene *scene, double factor);

#endif
