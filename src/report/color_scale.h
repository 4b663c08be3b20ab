// The scale under a picture in false colours: colours, ticks and numbers.
#ifndef LAMPYRIS_REPORT_COLOR_SCALE_H
#define LAMPYRIS_REPORT_COLOR_SCALE_H

#include "base/arena.h"
#include "image/image.h"
#include "metrics/error_map.h"

// A picture of display values, with the map's scale below it; narrow ones are widened to make room.
// The result lives in `arena`. False when out of memory.
bool color_scale_append(enum error_map map, const struct image *picture, struct arena *arena,
                        struct image *out);

#endif
