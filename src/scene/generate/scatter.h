// Spheres that are scattered over a disc.
#ifndef LAMPYRIS_SCENE_GENERATE_SCATTER_H
#define LAMPYRIS_SCENE_GENERATE_SCATTER_H

#include "scene/core/scene.h"

#define SCATTER_COUNT_MAX 1000000
#define STREW_COUNT_MAX (1u << 24) // maximum number of instances and shapes of scattered copies
#define SCATTER_SUBDIVISION_MAX 6
#define SCATTER_SUBDIVISION 3 // default subdivision of spheres

struct scatter {
    uint32_t count, seed;
    double disc_radius;              // radius of the disc about the origin, in y = 0
    double min_radius, max_radius;   // 0 < min <= max <= disc_radius; small radii are more frequent
    const struct progress *progress; // NULL: no listener
};

struct scattered_sphere {
    double center[3], radius;
    uint32_t choice; // 32 random bits, from which the caller chooses a material
};

// Places spheres that do not overlap. Each takes the first free one of 1024 random positions, or is
// omitted. `out` must have room for `count` spheres; *placed is the number of spheres placed. Fails
// with ERR_STOPPED when `progress` requests a stop. The result is the same on every machine: random
// numbers come from hashed integers, and only correctly rounded operations follow. `scratch` is
// only used during the call.
bool scatter_spheres(const struct scatter *scatter, struct arena *scratch,
                     struct scattered_sphere *out, uint32_t *placed, struct err *err);

// Returns the memory, in bytes, for scatter_spheres() and `out`.
uint64_t scatter_spheres_bytes(uint32_t count);

// Returns 32 random bits: the number with index `n` in the sequence of `item`.
uint32_t scatter_bits(uint32_t seed, uint32_t item, uint32_t n);

// Appends a sphere of radius 1 about the origin with normals: the 20 triangles of an icosahedron,
// each split into four `subdivision` times (at most SCATTER_SUBDIVISION_MAX).
bool generate_icosphere(struct scene *scene, uint32_t subdivision, uint32_t *index,
                        struct err *err);
uint64_t generate_icosphere_bytes(uint32_t subdivision); // memory of the mesh in bytes

#endif
