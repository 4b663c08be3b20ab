// Spheres strewn over a disc.
#ifndef LAMPYRIS_SCENE_GENERATE_SCATTER_H
#define LAMPYRIS_SCENE_GENERATE_SCATTER_H

#include "scene/core/scene.h"

#define SCATTER_COUNT_MAX 1000000
#define STREW_COUNT_MAX (1u << 24) // of instances and shapes
#define SCATTER_SUBDIVISION_MAX 6
#define SCATTER_SUBDIVISION 3 // where nothing is said

struct scatter {
    uint32_t count, seed;
    double disc_radius;            // about the origin, in the plane y = 0, on which the spheres lie
    double min_radius, max_radius; // 0 < min <= max <= disc_radius; small ones are more frequent
    const struct progress *progress; // NULL: nobody listens
};

struct scattered_sphere {
    double center[3], radius;
    uint32_t choice; // a random number of 32 bits of its own
};

// Places spheres that do not overlap, each where the first of 1024 random places is free, or not at
// all. `out` has room for `count`; *placed are there. ERR_STOPPED when `progress` asks to stop. The
// same on every machine: integers are hashed, and only exactly rounded operations follow. scratch:
// for the time of the call.
bool scatter_spheres(const struct scatter *scatter, struct arena *scratch,
                     struct scattered_sphere *out, uint32_t *placed, struct err *err);

// What the call and `out` take.
uint64_t scatter_spheres_bytes(uint32_t count);

// Random: number `n` of item `item`.
uint32_t scatter_bits(uint32_t seed, uint32_t item, uint32_t n);

// Appends a sphere of radius 1 about the origin: the icosahedron's 20 triangles, each split into
// four `subdivision` times (at most SCATTER_SUBDIVISION_MAX), with the sphere's normals.
bool generate_icosphere(struct scene *scene, uint32_t subdivision, uint32_t *index,
                        struct err *err);
uint64_t generate_icosphere_bytes(uint32_t subdivision); // that it takes

#endif
