// The radiance and the flux that materials and lights emit.
#ifndef LAMPYRIS_SCENE_CORE_EMISSION_H
#define LAMPYRIS_SCENE_CORE_EMISSION_H

#include "base/maths.h"
#include "scene/core/scene.h"

// Computes the mean radiance of a material's surfaces, including the textures that scale its
// emission. Returns 0 for unlit materials, to which no shadow rays are sent.
void mean_emission(const struct scene *scene, const struct material *material, float out[3]);
// Returns the luminance of mean_emission().
double mean_radiance(const struct scene *scene, const struct material *material);
// Returns the mean opacity of a material, including its textures. With an alpha mask, the result is
// 1 if the mean reaches the cutoff, else 0.
double mean_opacity(const struct scene *scene, const struct material *material);
// Computes the maximum radiance that a material may emit, by channel; 0 if it does not emit. Each
// texture counts with the greatest component of its texels.
void greatest_radiance(const struct scene *scene, const struct material *material, float out[3]);
// Returns the flux of all emissive triangles, divided by pi, in W/sr: the sum of mean radiance
// times area. Only one side counts, because the other side of a closed surface emits into its
// inside.
double scene_emitted_flux(const struct scene *scene);
// Returns whether there is an emissive triangle, even one without area.
bool scene_has_emissive_triangles(const struct scene *scene);
// Returns the flux that the lights send to a sphere, divided by pi, in W/sr. A spot light sends at
// most the flux of its cone, and nothing if the sphere is outside the cone. Lights send nothing
// beyond their range.
double scene_light_flux(const struct scene *scene, const double center[3], double radius);
// Returns the area in world space of a triangle of an instance, in m^2; 0 if it is degenerate.
double triangle_world_area(const struct mesh *mesh, const double transform[3][4],
                           uint32_t triangle);

#endif
