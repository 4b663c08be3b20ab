// Scenes of placed meshes for tests of two-level traversal.
#ifndef LAMPYRIS_TESTS_INSTANCED_H
#define LAMPYRIS_TESTS_INSTANCED_H

#include "scene/core/affine.h"
#include "traversal_scenes.h"

// Meshes without a place: a bumpy closed ball, one of 20 * 4^subdivision triangles with its corners
// on the unit sphere, a cube of corners at -1 and 1 with `cells` squared cells on each face,
// `count` times the same triangle.
uint32_t blob_mesh(struct scene *scene, uint32_t triangles, uint32_t material);
uint32_t ball_mesh(struct scene *scene, uint32_t subdivision, uint32_t material);
uint32_t cube_mesh(struct scene *scene, uint32_t cells, uint32_t material);
uint32_t pile_mesh(struct scene *scene, uint32_t count, uint32_t material);

// `material` may be SCENE_NONE.
void place_mesh(struct scene *scene, uint32_t mesh, const double m[3][4], uint32_t material);
// A triangle that is hardly seen, so that the scene is not moved to where its mesh is.
void add_anchor(struct scene *scene, const double at[3]);

// The transforms that a mesh is placed with.
enum placing { TURNED, MIRRORED, SQUASHED, SHEARED, TINY, HUGE_SCALE, PLACINGS };
const char *placing_name(enum placing placing);
void make_placing(enum placing placing, struct random *random, double m[3][4]);
// The least and the largest factor by which lengths change, or bounds of them.
void placing_scales(enum placing placing, double scales[2]);

// A point in single precision where an instance's own space has it.
void to_world(const struct flat_instance *instance, const double point[3], float out[3]);

#endif
