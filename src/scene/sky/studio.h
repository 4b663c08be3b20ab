// Light and ground for a model that comes without light: what a photographer puts around a thing to
// show it. Everything is computed, and the same for every model but for its size.
//
// The light is an environment: three soft boxes (key, fill, rim) far away before a plain
// background, so that it needs no geometry, has no size, and is sampled like any environment. It is
// scaled so that a level surface receives the irradiance pi, as from an even environment of
// radiance 1: a white one has radiance 1.
//
// The ground is a plane without end. Far from the model it reflects the same radiance in all
// directions, and the background has that radiance at the horizon and below: there is no seam.
#ifndef LAMPYRIS_SCENE_SKY_STUDIO_H
#define LAMPYRIS_SCENE_SKY_STUDIO_H

#include "scene/core/scene.h"

// Whether what the file brings counts as light, which is judged by what it would send. An
// environment counts, and so do lights and emission of a scene file of our own format, which are
// there on purpose. A model's lights and the emission of its materials count from
// STUDIO_EMISSION_LEAST on: *emission is the mean radiance that a white surface around the model
// (its bounding sphere, of area A) would reflect if all of the flux F arrived there, F / (pi A). F
// is all that its materials emit, and what its lights send to that sphere.
// The studio's light gives a level one 1.
//
// Four stops below is zone I of Adams's scale (The Negative, 1981), where middle grey is zone V:
// the first tone that differs from black, without any texture. Emission that lights less than that
// is a lamp that is seen, not one that is seen by. Emissive triangles that are too small for their
// own positions to have an area count, as they are meant to light: flattening warns of them.
#define STUDIO_EMISSION_LEAST (1.0 / 16)
bool scene_is_lit(const struct scene *scene, double *emission);

// Lights the scene unless it is lit, as params->studio says, and puts a ground below a model in it.
// ERR_SYSTEM. Before there is a framed camera.
bool scene_provide_light(struct scene *scene, const struct scene_load_params *params,
                         struct err *err);

// Notes what was added to the scene, light, ground and camera, with the options that change it.
bool scene_note_additions(struct scene *scene, struct err *err);

#endif
