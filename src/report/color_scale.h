// Draws the scale below an image in false colours: colours, ticks and numbers.
#ifndef LAMPYRIS_REPORT_COLOR_SCALE_H
#define LAMPYRIS_REPORT_COLOR_SCALE_H

#include "base/arena.h"
#include "image/image.h"
#include "metrics/error_map.h"

// Copies an image of display values and draws the map's colour scale below it. Narrow images are
// made wider to have room for the scale. `arena` owns the result. Returns false when out of memory.
bool color_scale_append(enum error_map map, const struct image *picture, struct arena *arena,
                        struct image *out);

#endif
