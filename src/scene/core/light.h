// Lights: defaults, cones and orientation.
#ifndef LAMPYRIS_SCENE_CORE_LIGHT_H
#define LAMPYRIS_SCENE_CORE_LIGHT_H

#include "scene/core/scene_material.h"

// Sets a point light at the origin with intensity 0 and without a name. Parameters of other kinds
// of lights have the defaults of KHR_lights_punctual.
void light_init(struct light *light);

// Returns whether rays can hit the light: a directional light with a disc that is not hidden.
bool light_is_sun(const struct light *light);

double versine(double angle); // 1 - cos(angle), without cancellation
// Returns `width`, the difference of the cosines between which a spot light falls off as ((cos -
// cos_outer) / width)^2. It is at least 0.001 (KHR_lights_punctual, "Inner and Outer Cone Angles").
double spot_width(const struct light *light);
// Returns the integral of a spot light's falloff over solid angle, which is its power at intensity
// 1.
double spot_solid_angle(const struct light *light);

// Points a light in another direction, which may have any length; a direction of length zero has no
// effect. A profile rotates with the light. Its plane at 0 degrees stays as near to its previous
// position as orthogonality permits.
void light_aim(struct light *light, const double direction[3]);

#endif
