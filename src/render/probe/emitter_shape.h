// Describes emitters for projection into the image: as numbered parts, each with its size and with
// points spread evenly over its visible area. Only in_view.c uses this file.
#ifndef LAMPYRIS_RENDER_PROBE_EMITTER_SHAPE_H
#define LAMPYRIS_RENDER_PROBE_EMITTER_SHAPE_H

#include "render/render.h"

enum emitter_kind { EMITTER_TRIANGLE, EMITTER_SHAPE, EMITTER_SUN, EMITTER_TEXEL };

// A part of an emitter: a triangle or a shape of the flat scene, a directional light, or a texel of
// the environment.
struct emitter_part {
    uint32_t kind, index; // EMITTER_*
};

bool emitter_is_far(struct emitter_part part); // whether the part is infinitely far; its position
                                               // is then a direction

// Returns the part's centre: a point in the flat scene's space, or a unit direction.
void emitter_center(const struct renderer *r, struct emitter_part part, double out[3]);
// Returns a bound on the distance of the part's points from its centre; for infinitely far parts, a
// bound on the tangent of their angle from the centre.
double emitter_radius(const struct renderer *r, struct emitter_part part);
// Returns the area projected along a direction, or the solid angle of an infinitely far part; for a
// distance field, the area of its box.
double emitter_area(const struct renderer *r, struct emitter_part part, const double direction[3]);
// Returns point `number` of `count` points on the area that is visible along a direction;
// directions for infinitely far parts.
void emitter_place(const struct renderer *r, struct emitter_part part, const double direction[3],
                   uint32_t number, uint32_t count, double out[3]);
// Returns the fraction of rays that the part stops: its opacity if its material has blended alpha,
// else 1.
double emitter_opacity(const struct renderer *r, struct emitter_part part);
// Returns the part's radiance, limited to the scene's clamp_limit. If the part has a texture, its
// brightest texel counts.
void emitter_radiance(const struct renderer *r, struct emitter_part part, double out[3]);

#endif
