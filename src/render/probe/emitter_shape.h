// Describes emitters as the camera sees them: numbered parts, each with its size and with points
// spread evenly over its visible area. Only in_view.c uses this file.
#ifndef LAMPYRIS_RENDER_PROBE_EMITTER_SHAPE_H
#define LAMPYRIS_RENDER_PROBE_EMITTER_SHAPE_H

#include "render/render.h"

enum emitter_kind { EMITTER_TRIANGLE, EMITTER_SHAPE, EMITTER_SUN, EMITTER_TEXEL };

// A triangle or a shape of the flat scene, a directional light, or a texel of the environment.
struct emitter_part {
    uint32_t kind, index; // EMITTER_*
};

bool emitter_is_far(struct emitter_part part); // infinitely: a direction stands for its position

// Returns the part's centre: a point in the flat scene's space, or a unit direction.
void emitter_center(const struct renderer *r, struct emitter_part part, double out[3]);
// Returns a bound on the distance of its points from the centre, or on the tangent of their angle.
double emitter_radius(const struct renderer *r, struct emitter_part part);
// Returns the projected area, or the solid angle, along a direction; for a distance field that of
// its box.
double emitter_area(const struct renderer *r, struct emitter_part part, const double direction[3]);
// Returns one of `count` points, or directions, of the visible area along a direction.
void emitter_place(const struct renderer *r, struct emitter_part part, const double direction[3],
                   uint32_t number, uint32_t count, double out[3]);
// Returns the fraction of samples that hit the part if it is blended with its background.
double emitter_opacity(const struct renderer *r, struct emitter_part part);
// Returns the part's radiance, at most the scene's clamp_limit. For a texture the greatest texel
// counts.
void emitter_radiance(const struct renderer *r, struct emitter_part part, double out[3]);

#endif
