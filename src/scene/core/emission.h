// What materials emit.
#ifndef LAMPYRIS_SCENE_CORE_EMISSION_H
#define LAMPYRIS_SCENE_CORE_EMISSION_H

#include "base/maths.h"
#include "scene/core/scene.h"

// The radiance of a material's surfaces, the mean over its textures, which scale what the
// parameters say. Of unlit materials 0: they are to be seen, not to light a scene.
void mean_emission(const struct scene *scene, const struct material *material, float out[3]);
// The luminance of that.
double mean_radiance(const struct scene *scene, const struct material *material);
// The share of a material's surfaces that is there: the mean opacity over its textures. A mask is
// taken to be as its mean is, there or not.
double mean_opacity(const struct scene *scene, const struct material *material);
// The greatest radiance of each channel that a material may emit: textures count with the greatest
// component of their texels. Of materials that do not emit 0.
void greatest_radiance(const struct scene *scene, const struct material *material, float out[3]);
// The flux of all emissive triangles, divided by pi: the sum of mean radiance times area, of one
// side of each, for the other side of a closed surface sends its light inwards. W/sr.
double scene_emitted_flux(const struct scene *scene);
// Returns whether there is an emissive triangle, though it may have no area.
bool scene_has_emissive_triangles(const struct scene *scene);
// The flux that lights without extent send to a sphere, divided by pi: W/sr. Of a spot's cone no
// more than all of it arrives, none if the sphere is beside it, and none beyond a light's range.
double scene_light_flux(const struct scene *scene, const double center[3], double radius);
// Of a triangle of an instance; 0 for one that is left out of the render.
double triangle_world_area(const struct mesh *mesh, const double transform[3][4],
                           uint32_t triangle);

#endif
