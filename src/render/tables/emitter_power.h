// Computes the power of emitters: the luminance of the emitted flux, divided by 2 pi. A surface of
// radiance L and area A emits pi L A to each of its two sides, so its power is L A.
#ifndef LAMPYRIS_RENDER_TABLES_EMITTER_POWER_H
#define LAMPYRIS_RENDER_TABLES_EMITTER_POWER_H

#include "flatten/flatten.h"
#include "scene/core/emission.h"
#include "scene/core/scene.h"

double triangle_area(const struct flat_scene *flat, uint32_t id);
double shape_area(const struct flat_shape *shape); // 0 unless shape_is_emitter() returns true for
                                                   // its kind
// Returns whether the scene has an infinite plane.
bool has_planes(const struct flat_scene *flat);
// Returns half the diagonal of the scene's bounds; 0 for an empty scene, 1 for a scene of planes
// only.
double bounding_radius(const struct flat_scene *flat);

// Returns a light in the flat scene's space and unit. Its intensity I is scaled such that the
// irradiance at a distance d is I / d^2 in that unit, too.
struct light flat_light(const struct flat_scene *flat, const struct light *light);

// Returns the power of a light, which must be a result of flat_light(). The flux of an infinitely
// far light is that through the disc of the scene's bounding sphere, of radius R: E pi R^2 for a
// directional light of irradiance E.
double light_power(const struct light *light, const struct flat_scene *flat);
// Returns the power of an environment's image: the mean of the radiance above `floor` over the
// sphere, times 4 pi and the area pi R^2 of the bounding sphere's disc, over 2 pi.
double environment_power(const struct environment *environment, double floor,
                         const struct flat_scene *flat);

#endif
