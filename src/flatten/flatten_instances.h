// The part of scene_flatten() for instances of shared meshes. Private to this folder.
#ifndef LAMPYRIS_FLATTEN_FLATTEN_INSTANCES_H
#define LAMPYRIS_FLATTEN_FLATTEN_INSTANCES_H

#include "flatten/flatten_precision.h"

// Fills out->instances, which has room, and adds the instances to the bounds; out->meshes must be
// complete. Instances that are too small for their distance from the origin are added to `coarse`.
bool flatten_instances(const struct flatten_params *params, const struct census *census,
                       struct flat_scene *out, struct coarse_objects *coarse, struct err *err);

#endif
