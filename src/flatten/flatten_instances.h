// The part of scene_flatten() for instances of shared meshes. Private to this folder.
#ifndef LAMPYRIS_FLATTEN_FLATTEN_INSTANCES_H
#define LAMPYRIS_FLATTEN_FLATTEN_INSTANCES_H

#include "flatten/flatten_precision.h"

// Fills out->instances, which has room, and adds them to the bounds; out->meshes is complete. Those
// that are too small for where they are join `coarse`.
bool flatten_instances(const struct flatten_params *params, const struct census *census,
                       struct flat_scene *out, struct coarse_objects *coarse, struct err *err);

#endif
