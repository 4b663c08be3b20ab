// Light and ground for a model without light, as in a photographer's studio. They are computed, and
// are the same for every model except for their size.
//
// The light is an environment: three soft boxes (key, fill, rim) at infinity in front of a plain
// background. It needs no geometry and is sampled like any environment. It is scaled so that a
// horizontal surface receives the irradiance pi, as from a constant environment of radiance 1. A
// white horizontal surface then has radiance 1.
//
// The ground is an infinite plane. Far from the model it reflects the same radiance in all
// directions, and the background has that radiance at the horizon and below, so that no seam is
// visible.
#ifndef LAMPYRIS_SCENE_SKY_STUDIO_H
#define LAMPYRIS_SCENE_SKY_STUDIO_H

#include "scene/core/scene.h"

// Returns whether the file's own light is sufficient. An environment is sufficient, and so are
// lights and emission in a .json scene, where they are intended. A model's lights and emissive
// materials are sufficient if *emission is at least STUDIO_EMISSION_LEAST. *emission is the mean
// radiance that a white surface around the model (its bounding sphere, of area A) would reflect if
// all of the flux F arrived there: F / (pi A). F is the flux of the model's emissive materials, and
// that of its lights towards the sphere. For comparison, this radiance is 1 for the studio's light
// on a horizontal surface.
//
// The limit is four stops below 1. In Adams's zone system (The Negative, 1981), zone I is four
// stops below middle grey, which is zone V. It is the first tone that differs from black, and shows
// no texture. Weaker emission is meant to be seen, not to light the model. Emissive triangles whose
// area vanishes when their positions are rounded count, because they are meant to light. Flattening
// warns of them.
#define STUDIO_EMISSION_LEAST (1.0 / 16)
bool scene_is_lit(const struct scene *scene, double *emission);

// Adds a studio or a constant environment if the scene is not lit, according to params->studio,
// which may also replace the scene's environment. Adds a ground according to params->ground. Fails
// with ERR_SYSTEM. Must be called before a camera is framed.
bool scene_provide_light(struct scene *scene, const struct scene_load_params *params,
                         struct err *err);

// Adds a note on the light, ground and camera that were added to the scene, with the options that
// change them.
bool scene_note_additions(struct scene *scene, struct err *err);

#endif
