// Finds the emitters that the camera sees directly, to bound the light that no sample has found.
#ifndef LAMPYRIS_RENDER_PROBE_IN_VIEW_H
#define LAMPYRIS_RENDER_PROBE_IN_VIEW_H

#include "metrics/metrics.h"
#include "render/render.h"

// Finds what metrics_half_error() must know of light that samples find by chance: visible emitters
// smaller than some pixels, the pixels in which any emitter may be seen, and the greatest radiance
// that scattered paths may find (render/chance.h). It is done once for each camera, in 0.3 to 0.5 s
// for 10^6 triangles or 2 10^5 lamps. Rays traced by the device determine which emitters are
// hidden. Arrays are in `arena`. Call it while nothing is rendered.
//
// Each triangle of a mesh is an emitter, and so is each texel of an environment's image that is at
// least 16 times as bright as the median. Of textures on emitters the greatest texel counts. The
// brightest 16,384 pixels with such light are kept.
bool renderer_find_unseen(struct renderer *renderer, struct arena *arena, struct unseen_light *out,
                          struct err *err);

#endif
