// The radiance and the flux that materials and lights emit.
#ifndef LAMPYRIS_SCENE_CORE_EMISSION_H
#define LAMPYRIS_SCENE_CORE_EMISSION_H

#include "base/maths.h"
#include "scene/core/scene.h"

// Computes the mean radiance of a material's surfaces over its textures, which scale the emission
// parameters. It is 0 for unlit materials: they are shown but do not light the scene.
void mean_emission(const struct scene *scene, const struct material *material, float out[3]);
// Returns the luminance of mean_emission().
double mean_radiance(const struct scene *scene, const struct material *material);
// Returns the mean opacity of a material over its textures. A mask counts as fully present or
// absent by its mean.
double mean_opacity(const struct scene *scene, const struct material *material);
// Computes the greatest radiance of each channel that a material may emit: textures count with the
// greatest component of their texels. It is 0 for materials that do not emit.
void greatest_radiance(const struct scene *scene, const struct material *material, float out[3]);
// Returns the flux of all emissive triangles, divided by pi, in W/sr: the sum of mean radiance
// times area. Only one side counts, because the other side of a closed surface emits into its
// inside.
double scene_emitted_flux(const struct scene *scene);
// Returns whether there is an emissive triangle, though it may have no area.
bool scene_has_emissive_triangles(const struct scene *scene);
// Returns the flux that the lights send to a sphere, divided by pi, in W/sr. A spot contributes at
// most the flux of its cone and nothing if the sphere is outside of the cone; a light contributes
// nothing beyond its range.
double scene_light_flux(const struct scene *scene, const double center[3], double radius);
// Returns the area of a triangle of an instance in the world; 0 if the triangle is omitted from the
// render.
double triangle_world_area(const struct mesh *mesh, const double transform[3][4],
                           uint32_t triangle);

#endif
