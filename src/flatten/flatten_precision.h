// Determines how well single precision represents each object at its coordinates. Part of
// flatten.c.
#ifndef LAMPYRIS_FLATTEN_FLATTEN_PRECISION_H
#define LAMPYRIS_FLATTEN_FLATTEN_PRECISION_H

#include "flatten/flatten_census.h"

// Moves out->origin to the object that the camera resolves best if coordinates relative to the
// given origin are too coarse for that object; otherwise leaves it unchanged.
void flatten_follow_camera(const struct flatten_params *params, const struct census *census,
                           struct flat_scene *out);

// Objects that single precision represents too coarsely. One warning reports all of them.
struct coarse_objects {
    uint32_t count;
    char first[128];                   // name of the first object
    double extent, farthest, place[3]; // of the first object, in metres
};

// Adds an object if single precision does not resolve it relative to the flat scene's origin.
void coarse_add_instance(const struct flat_scene *flat, const struct scene *scene, uint32_t index,
                         const struct bounds *mesh, struct coarse_objects *coarse);
void coarse_add_shape(const struct flat_scene *flat, const struct scene *scene, uint32_t index,
                      struct coarse_objects *coarse);
void coarse_warn(const struct coarse_objects *coarse);

#endif
