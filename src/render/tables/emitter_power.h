// The power of emitters, in one unit for all: the luminance of the flux over 2 pi. A surface of
// radiance L and area A emits pi L A to each of its two sides, which makes L A.
#ifndef LAMPYRIS_RENDER_TABLES_EMITTER_POWER_H
#define LAMPYRIS_RENDER_TABLES_EMITTER_POWER_H

#include "flatten/flatten.h"
#include "scene/core/emission.h"
#include "scene/core/scene.h"

double triangle_area(const struct flat_scene *flat, uint32_t id);
double shape_area(const struct flat_shape *shape); // 0 unless shape_is_emitter()
// Returns whether the scene has an infinite plane.
bool has_planes(const struct flat_scene *flat);
// Returns half the diagonal of the scene's bounds; 0 for an empty scene, 1 for one with planes
// only.
double bounding_radius(const struct flat_scene *flat);

// Returns a light of the scene in the flat scene's space and unit: the irradiance from an intensity
// I at a distance d, I / d^2, is the same in all units.
struct light flat_light(const struct flat_scene *flat, const struct light *light);

// `light` is a result of flat_light(). An infinitely far light counts with the flux through the
// disc of the scene's bounding sphere, of radius R: directional lights send E pi R^2.
double light_power(const struct light *light, const struct flat_scene *flat);
// Returns the power of an environment's image: 4 pi times the mean over the sphere of the radiance
// above `floor`, through pi R^2.
double environment_power(const struct environment *environment, double floor,
                         const struct flat_scene *flat);

#endif
