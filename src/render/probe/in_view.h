// The emitters that the camera sees directly: what is known of light that no sample has met.
#ifndef LAMPYRIS_RENDER_PROBE_IN_VIEW_H
#define LAMPYRIS_RENDER_PROBE_IN_VIEW_H

#include "metrics/metrics.h"
#include "render/render.h"

// What metrics_half_error() is to know of light that samples meet by chance: emitters that cover
// less than some pixels and that nothing hides, the pixels in which any emitter may be seen, and
// the brightest that scattered paths may find (render/chance.h). Found once for each camera, in .3
// to .5 s for 10^6 triangles or 2 10^5 lamps; whether they are hidden rays tell that the device
// traces. Arrays are in `arena`. Call it while nothing is rendered.
//
// Of a mesh each triangle is an emitter, of an image around the scene each texel that is at least
// 16 times as bright as the median. Of textures on emitters the greatest texel counts. The
// brightest 16,384 pixels with such light are kept.
bool renderer_find_unseen(struct renderer *renderer, struct arena *arena, struct unseen_light *out,
                          struct err *err);

#endif
