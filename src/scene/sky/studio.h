// Light and ground for a model without light, similar to a photographer's studio. Everything is
// computed and is the same for every model but for its size.
//
// The light is an environment: three soft boxes (key, fill, rim) at infinity before a plain
// background. It needs no geometry, has no size and is sampled like any environment. It is scaled
// so that a horizontal surface receives the irradiance pi, as from a constant environment of
// radiance 1: a white one then has radiance 1.
//
// The ground is an infinite plane. Far from the model it reflects the same radiance in all
// directions, and the background has that radiance at the horizon and below, so that there is no
// seam.
#ifndef LAMPYRIS_SCENE_SKY_STUDIO_H
#define LAMPYRIS_SCENE_SKY_STUDIO_H

#include "scene/core/scene.h"

// Returns whether the file's own light is sufficient. An environment is, and so are lights and
// emission in a scene file of our own format, where they are intended. A model's lights and
// emissive materials are if *emission is at least STUDIO_EMISSION_LEAST, where *emission is the
// mean radiance that a white surface around the model (its bounding sphere, of area A) would
// reflect if all of the flux F arrived there, F / (pi A). F is the flux of its emissive materials,
// and of its lights towards that sphere. For the studio's light on a horizontal surface this
// radiance is 1.
//
// The limit is four stops below 1: zone I of Adams's scale (The Negative, 1981), where middle grey
// is zone V, is the first tone that differs from black, without any texture. Weaker emission is
// meant to be seen, not to light the model. Emissive triangles whose area vanishes by rounding of
// their positions count, as they are meant to light: flattening warns of them.
#define STUDIO_EMISSION_LEAST (1.0 / 16)
bool scene_is_lit(const struct scene *scene, double *emission);

// Adds the light that params->studio chooses unless the scene is lit, and a ground below a model in
// the studio. ERR_SYSTEM. Call it before a camera is framed.
bool scene_provide_light(struct scene *scene, const struct scene_load_params *params,
                         struct err *err);

// Notes which light, ground and camera were added to the scene, with the options that change it.
bool scene_note_additions(struct scene *scene, struct err *err);

#endif
