// Procedural meshes: for tests and benchmarks that need many triangles, and for images that need a
// shape.
#ifndef LAMPYRIS_SCENE_GENERATE_GENERATE_H
#define LAMPYRIS_SCENE_GENERATE_GENERATE_H

#include "scene/core/scene.h"

// Appends a closed, bumpy sphere ("blob") about the origin with mean radius 1 and normals: a
// latitude-longitude grid of about `triangles` triangles (at least 8). Its radius is modulated by
// sums of sines so that curvature and triangle size vary.
bool generate_blob(struct scene *scene, uint32_t triangles, uint32_t material, uint32_t *mesh,
                   struct err *err);
// Returns the size of the mesh in bytes, as the other functions generate_*_bytes() do.
uint64_t generate_blob_bytes(uint32_t triangles);

#define TEAPOT_RESOLUTION_MAX 1024

// Appends the Utah teapot, with normals and texture coordinates: 32 patches of `resolution` (1 to
// TEAPOT_RESOLUTION_MAX) squared cells. It stands on y = 0; the knob of its lid is at y = 3.15, its
// spout points to +x (to x = 3.434), its handle to -x (to x = -3). It is not closed: the spout is
// open, and there is a gap between body and lid. The texture covers each of body, lid, bottom,
// handle and spout once: s runs around the part, t along it.
bool generate_teapot(struct scene *scene, uint32_t resolution, uint32_t material, uint32_t *mesh,
                     struct err *err);
uint64_t generate_teapot_bytes(uint32_t resolution);

#define TORUS_SEGMENTS_MAX 4096

struct torus {
    double tube;                      // radius of the tube, in (0, 1)
    uint32_t segments, tube_segments; // 3 to TORUS_SEGMENTS_MAX
};

// Appends a closed torus about the y axis, of major radius 1, with normals.
bool generate_torus(struct scene *scene, const struct torus *torus, uint32_t material,
                    uint32_t *index, struct err *err);
uint64_t generate_torus_bytes(const struct torus *torus);

#define STADIUM_STEPS_MAX 1024
#define STADIUM_SEGMENTS_MAX 4096

struct stadium {
    uint32_t steps;    // steps of the stands, 1 to STADIUM_STEPS_MAX
    uint32_t segments; // segments around the axis, 3 to STADIUM_SEGMENTS_MAX
};

// Appends an elliptic stadium about the y axis, without normals. Its field lies on y = 0 with
// semi-axes 0.6 along x and 0.4 along z. Around it, stands 0.4 wide rise in equal steps to y =
// 0.25, with a wall outside. The mesh has segments * (4 steps + 3) triangles and is open at the
// bottom.
bool generate_stadium(struct scene *scene, const struct stadium *stadium, uint32_t material,
                      uint32_t *index, struct err *err);
uint64_t generate_stadium_bytes(const struct stadium *stadium);

#endif
