// A camera for a model that comes without one, and the frame of directions that an up axis makes.
#ifndef LAMPYRIS_SCENE_CORE_FRAMING_H
#define LAMPYRIS_SCENE_CORE_FRAMING_H

#include "scene/core/scene.h"

// Unit vectors, right-handed: right x up = front. The front is what a model shows to who looks at
// it: +Z where +Y is up (glTF 2.0, section 3.4), -Y where +Z is up.
struct scene_axes {
    double right[3], up[3], front[3];
};
struct scene_axes scene_axes(enum scene_up up);

// The direction, unit, in which the framed camera lies as seen from the model.
void framing_towards_camera(enum scene_up up, double out[3]);

// Gives the scene a framed camera unless it has one of its own.
bool scene_provide_camera(struct scene *scene, struct err *err);

#endif
