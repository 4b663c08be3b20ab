// How much emitters send into the scene, in one unit for all: flux / (2 pi), of luminances. A
// surface of radiance L and area A sends pi L A to each of its two sides, which counts as L A.
#ifndef LAMPYRIS_RENDER_TABLES_EMITTER_POWER_H
#define LAMPYRIS_RENDER_TABLES_EMITTER_POWER_H

#include "flatten/flatten.h"
#include "scene/core/emission.h"
#include "scene/core/scene.h"

double triangle_area(const struct flat_scene *flat, uint32_t id);
double shape_area(const struct flat_shape *shape); // 0 where shape_is_emitter() says no
// Returns whether something in the scene has no end.
bool has_planes(const struct flat_scene *flat);
// Half the diagonal of the scene's bounds; 0 when empty, 1 with nothing but planes.
double bounding_radius(const struct flat_scene *flat);

// A light of the scene in the flat scene's space and unit: what falls on a surface from an
// intensity I at a distance d, I / d^2, is the same in all units.
struct light flat_light(const struct flat_scene *flat, const struct light *light);

// `light` is one of flat_light(). What comes from infinitely far is counted through the disc that
// the scene's bounding sphere, of radius R, is to it: directional lights send E pi R^2.
double light_power(const struct light *light, const struct flat_scene *flat);
// Of an image: 4 pi times the mean over the sphere of what its radiance exceeds `floor` by, through
// pi R^2.
double environment_power(const struct environment *environment, double floor,
                         const struct flat_scene *flat);

#endif
