// Triangles for the tests of bvh/: procedural meshes, and files if they are available.
#ifndef LAMPYRIS_TESTS_BVH_MESHES_H
#define LAMPYRIS_TESTS_BVH_MESHES_H

#include "base/arena.h"
#include "bvh/bvh.h"

#include <stdbool.h>
#include <stdint.h>

struct mesh {
    float (*vertices)[3][3]; // owned by the arena
    uint32_t count;
};

// PCG-XSH-RR 64/32 (O'Neill 2014).
struct random {
    uint64_t state;
};
uint32_t random_u32(struct random *random);
double random_unit(struct random *random); // [0, 1)
double random_between(struct random *random, double min, double max);
void random_direction(struct random *random, double direction[3]); // uniform on the sphere

// The following functions exit when out of memory.
struct mesh mesh_new(struct arena *arena, uint32_t count);
// Makes triangles in the unit cube whose extent is at most `size` on each axis.
struct mesh mesh_soup(struct arena *arena, uint32_t count, double size, uint64_t seed);
// Makes a closed sphere of radius 1 about the origin with 2 * rings * segments - 2 * segments
// triangles. Neighbours share vertices bit for bit.
struct mesh mesh_sphere(struct arena *arena, uint32_t rings, uint32_t segments);
// Makes a height field over [0, 1]^2 with 2 * n * n triangles.
struct mesh mesh_grid(struct arena *arena, uint32_t n);
// Makes copies of a single triangle.
struct mesh mesh_identical(struct arena *arena, uint32_t count);
// Makes a sphere (with twice as many segments as rings) among thin beams in any direction, each of
// two triangles, whose boxes are much larger than they are.
struct mesh mesh_among_beams(struct arena *arena, uint32_t rings, uint32_t beams);
// Makes strands of flat pieces of 0.15 x 0.001, which meander away from a sphere of radius 1.
struct mesh mesh_strands(struct arena *arena, uint32_t strands, uint32_t pieces);
// Reads vertices and faces of $LAMPYRIS_DATA/mesh/NAME (OBJ). Returns false if there is no such
// file.
bool mesh_load(struct arena *arena, const char *name, struct mesh *mesh);

struct bvh_params mesh_params(const struct mesh *mesh);

#endif
