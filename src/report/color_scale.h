// The scale below an image in false colours: colours, ticks and numbers.
#ifndef LAMPYRIS_REPORT_COLOR_SCALE_H
#define LAMPYRIS_REPORT_COLOR_SCALE_H

#include "base/arena.h"
#include "image/image.h"
#include "metrics/error_map.h"

// Makes an image of display values with the map's scale below it; narrow images are widened to make
// room. The result lives in `arena`. Returns false when out of memory.
bool color_scale_append(enum error_map map, const struct image *picture, struct arena *arena,
                        struct image *out);

#endif
