// Scenes with instances, for tests of two-level traversal.
#ifndef LAMPYRIS_TESTS_INSTANCED_H
#define LAMPYRIS_TESTS_INSTANCED_H

#include "scene/core/affine.h"
#include "traversal_scenes.h"

// Add meshes without instances: a bumpy closed ball; one of 20 * 4^subdivision triangles with its
// vertices on the unit sphere; a cube with corners at -1 and 1 and `cells` squared cells per face;
// `count` copies of a triangle.
uint32_t blob_mesh(struct scene *scene, uint32_t triangles, uint32_t material);
uint32_t ball_mesh(struct scene *scene, uint32_t subdivision, uint32_t material);
uint32_t cube_mesh(struct scene *scene, uint32_t cells, uint32_t material);
uint32_t pile_mesh(struct scene *scene, uint32_t count, uint32_t material);

// `material` may be SCENE_NONE.
void place_mesh(struct scene *scene, uint32_t mesh, const double m[3][4], uint32_t material);
// Adds a triangle that is hardly visible, so that the origin of the flat scene stays there.
void add_anchor(struct scene *scene, const double at[3]);

// The kinds of transforms with which meshes are placed.
enum placing { TURNED, MIRRORED, SQUASHED, SHEARED, TINY, HUGE_SCALE, PLACINGS };
const char *placing_name(enum placing placing);
void make_placing(enum placing placing, struct random *random, double m[3][4]);
// Computes the least and the greatest factor of lengths, or bounds of these.
void placing_scales(enum placing placing, double scales[2]);

// Transforms a point, in single precision, from an instance's own space to world space.
void to_world(const struct flat_instance *instance, const double point[3], float out[3]);

#endif
