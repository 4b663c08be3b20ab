// How well single precision holds each object of a scene where it is. Part of flatten.c.
#ifndef LAMPYRIS_FLATTEN_FLATTEN_PRECISION_H
#define LAMPYRIS_FLATTEN_FLATTEN_PRECISION_H

#include "flatten/flatten_census.h"

// Moves out->origin to what the camera sees best, where coordinates about the given one are too
// coarse for that; else leaves it as it is.
void flatten_follow_camera(const struct flatten_params *params, const struct census *census,
                           struct flat_scene *out);

// Objects that are coarse where they are; told together.
struct coarse_objects {
    uint32_t count;
    char first[128];                   // names the first one
    double extent, farthest, place[3]; // its, in metres
};

// Adds an object to them if single precision does not resolve it about the flat scene's origin.
void coarse_add_instance(const struct flat_scene *flat, const struct scene *scene, uint32_t index,
                         const struct bounds *mesh, struct coarse_objects *coarse);
void coarse_add_shape(const struct flat_scene *flat, const struct scene *scene, uint32_t index,
                      struct coarse_objects *coarse);
void coarse_warn(const struct coarse_objects *coarse);

#endif
