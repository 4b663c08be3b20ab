// Evaluates signed distance fields in double precision, like the kernels' interpreter
// (lib/sdf.glsl).
#ifndef LAMPYRIS_SCENE_SDF_SDF_EVALUATE_H
#define LAMPYRIS_SCENE_SDF_SDF_EVALUATE_H

#include "scene/core/scene.h"

// Returns the value of the program, in metres, at a point of the field's own space; negative
// inside.
double sdf_evaluate(const struct sdf *sdf, const double point[3]);

#endif
