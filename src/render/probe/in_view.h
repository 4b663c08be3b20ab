// Finds the emitters that the camera sees directly, in order to bound the light that no sample has
// found so far.
#ifndef LAMPYRIS_RENDER_PROBE_IN_VIEW_H
#define LAMPYRIS_RENDER_PROBE_IN_VIEW_H

#include "metrics/metrics.h"
#include "render/render.h"

// Finds the input of metrics_half_error() about light that samples may have missed: visible
// emitters smaller than a few pixels, the pixels in which any emitter may be visible, and the
// greatest radiance that scattered paths may find (render/chance.h). The result is kept until the
// camera changes; it takes 0.3 to 0.5 s for 10^6 triangles or 2 * 10^5 lamps. Rays traced on the
// device determine which emitters are hidden. Arrays are in `arena`. Call it while nothing is being
// rendered.
//
// Each triangle of an emissive mesh is an emitter, and so is each texel of an environment image
// that is at least 16 times as bright as the median texel. A textured emitter counts with its
// brightest texel. Only the 16,384 pixels with the most such light are kept.
bool renderer_find_unseen(struct renderer *renderer, struct arena *arena, struct unseen_light *out,
                          struct err *err);

#endif
