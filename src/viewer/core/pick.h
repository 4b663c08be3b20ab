// Finds the surface that is visible in a pixel.
#ifndef LAMPYRIS_VIEWER_CORE_PICK_H
#define LAMPYRIS_VIEWER_CORE_PICK_H

#include "base/err.h"
#include <stdint.h>

struct picked;
struct renderer;
struct viewer;

// Finds the surface in a pixel of the window. Returns false if the device failed.
bool viewer_pick(struct viewer *viewer, double x, double y, struct picked *out, struct err *err);
// Returns the index in the scene of an object of a renderer's flat scene. It is the object's AOV id
// minus 1.
uint32_t viewer_object(const struct renderer *renderer, bool is_shape, uint32_t primitive,
                       uint32_t flat_instance);

#endif
