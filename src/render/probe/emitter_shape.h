// What emitters look like from the camera: their parts by number, each with its size and with
// points spread evenly over what is seen of it. Internal to in_view.c.
#ifndef LAMPYRIS_RENDER_PROBE_EMITTER_SHAPE_H
#define LAMPYRIS_RENDER_PROBE_EMITTER_SHAPE_H

#include "render/render.h"

enum emitter_kind { EMITTER_TRIANGLE, EMITTER_SHAPE, EMITTER_SUN, EMITTER_TEXEL };

// A triangle or a shape of the flat scene, a directional light, or a texel of the environment.
struct emitter_part {
    uint32_t kind, index; // EMITTER_*
};

bool emitter_is_far(struct emitter_part part); // infinitely: a direction stands for its place

// Its middle: a point in the flat scene's space, or a unit direction.
void emitter_center(const struct renderer *r, struct emitter_part part, double out[3]);
// All of it is within this length of its middle, or this tangent of an angle.
double emitter_radius(const struct renderer *r, struct emitter_part part);
// The area, or the solid angle, that hides what is behind it, seen in a direction; of a distance
// field that of its box.
double emitter_area(const struct renderer *r, struct emitter_part part, const double direction[3]);
// One of `count` points, or directions, of what is seen of it in a direction.
void emitter_place(const struct renderer *r, struct emitter_part part, const double direction[3],
                   uint32_t number, uint32_t count, double out[3]);
// The part of samples that meet it where it is blended with what is behind.
double emitter_opacity(const struct renderer *r, struct emitter_part part);
// Of textures the greatest texel counts. No more than the scene's clamp_limit lets through.
void emitter_radiance(const struct renderer *r, struct emitter_part part, double out[3]);

#endif
