// The camera for a model without one, and the axes that follow from the up axis.
#ifndef LAMPYRIS_SCENE_CORE_FRAMING_H
#define LAMPYRIS_SCENE_CORE_FRAMING_H

#include "scene/core/scene.h"

// Unit vectors, right-handed: right x up = front. The front of a model faces the viewer: it is +Z
// where +Y is up (glTF 2.0, section 3.4), and -Y where +Z is up.
struct scene_axes {
    double right[3], up[3], front[3];
};
struct scene_axes scene_axes(enum scene_up up);

// Computes the unit direction from the model to the framed camera.
void framing_towards_camera(enum scene_up up, double out[3]);

// Adds a framed camera to the scene unless it has a camera.
bool scene_provide_camera(struct scene *scene, struct err *err);

#endif
