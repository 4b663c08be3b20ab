// Triangles for the tests of bvh/: procedural ones, and files where they are at hand.
#ifndef LAMPYRIS_TESTS_BVH_MESHES_H
#define LAMPYRIS_TESTS_BVH_MESHES_H

#include "base/arena.h"
#include "bvh/bvh.h"

#include <stdbool.h>
#include <stdint.h>

struct mesh {
    float (*vertices)[3][3]; // in the arena
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

// Helpers exit when memory is exhausted.
struct mesh mesh_new(struct arena *arena, uint32_t count);
// Triangles in the unit cube whose corners are at most `size` apart on each axis.
struct mesh mesh_soup(struct arena *arena, uint32_t count, double size, uint64_t seed);
// A closed sphere of radius 1 around the origin: 2 * rings * segments - 2 * segments triangles,
// whose neighbours share vertices bit for bit.
struct mesh mesh_sphere(struct arena *arena, uint32_t rings, uint32_t segments);
// A height field over [0, 1]^2 of 2 * n * n triangles.
struct mesh mesh_grid(struct arena *arena, uint32_t n);
// All the same triangle.
struct mesh mesh_identical(struct arena *arena, uint32_t count);
// A sphere (rings of twice as many segments) among thin beams turned any way, of two triangles
// each, whose boxes are many times larger than they are.
struct mesh mesh_among_beams(struct arena *arena, uint32_t rings, uint32_t beams);
// Strands of so many flat pieces of 0.15 x 0.001 that wander away from a sphere of radius 1.
struct mesh mesh_strands(struct arena *arena, uint32_t strands, uint32_t pieces);
// Vertices and faces of $LAMPYRIS_DATA/mesh/NAME (OBJ); false where there is no such file.
bool mesh_load(struct arena *arena, const char *name, struct mesh *mesh);

struct bvh_params mesh_params(const struct mesh *mesh);

#endif
