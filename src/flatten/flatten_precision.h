// Tests how well single precision represents each object at its coordinates. Part of flatten.c.
#ifndef LAMPYRIS_FLATTEN_FLATTEN_PRECISION_H
#define LAMPYRIS_FLATTEN_FLATTEN_PRECISION_H

#include "flatten/flatten_census.h"

// Moves out->origin to the object that the camera sees best if coordinates about the given origin
// are too coarse for that; otherwise leaves it unchanged.
void flatten_follow_camera(const struct flatten_params *params, const struct census *census,
                           struct flat_scene *out);

// Objects that single precision represents coarsely; reported together.
struct coarse_objects {
    uint32_t count;
    char first[128];                   // names the first one
    double extent, farthest, place[3]; // measures of the first one, in metres
};

// Adds an object to them if single precision does not resolve it about the flat scene's origin.
void coarse_add_instance(const struct flat_scene *flat, const struct scene *scene, uint32_t index,
                         const struct bounds *mesh, struct coarse_objects *coarse);
void coarse_add_shape(const struct flat_scene *flat, const struct scene *scene, uint32_t index,
                      struct coarse_objects *coarse);
void coarse_warn(const struct coarse_objects *coarse);

#endif
