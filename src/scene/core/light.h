// Cones of lights: what their angles come to.
#ifndef LAMPYRIS_SCENE_CORE_LIGHT_H
#define LAMPYRIS_SCENE_CORE_LIGHT_H

#include "scene/core/scene_material.h"

// A point light at the origin that sends nothing, without a name; parameters of other kinds as in
// KHR_lights_punctual where nothing is said.
void light_init(struct light *light);

// Returns whether rays may meet it: a directional light that comes from a disc, and is not hidden.
bool light_is_sun(const struct light *light);

double versine(double angle); // 1 - cos, without cancellation
// The cosines between which a spot's light falls off, ((cos - cos_outer) / width)^2 from the outer
// one on; at least 0.001 (KHR_lights_punctual, "Inner and Outer Cone Angles").
double spot_width(const struct light *light);
// The solid angle that a spot fills, weighted by its falloff: the power of an intensity of 1.
double spot_solid_angle(const struct light *light);

// Points a light into another direction (of any length but zero; else nothing happens). A profile
// goes along: its plane at 0 degrees stays as near to where it was as a right angle allows.
void light_aim(struct light *light, const double direction[3]);

#endif
