// Finds what is seen at a pixel.
#ifndef LAMPYRIS_VIEWER_CORE_PICK_H
#define LAMPYRIS_VIEWER_CORE_PICK_H

#include "base/err.h"
#include <stdint.h>

struct picked;
struct renderer;
struct viewer;

// Finds what is seen at a pixel of the window. False: the device failed.
bool viewer_pick(struct viewer *viewer, double x, double y, struct picked *out, struct err *err);
// The scene's number of a surface in a renderer's flat scene, as AOV ids have it less 1.
uint32_t viewer_object(const struct renderer *renderer, bool is_shape, uint32_t primitive,
                       uint32_t flat_instance);

#endif
