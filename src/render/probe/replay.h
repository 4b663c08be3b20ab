// Follows one sample of one pixel through the kernels on the device, one dispatch at a time, in
// order to find the source of a non-finite contribution or to explain a pixel.
#ifndef LAMPYRIS_RENDER_PROBE_REPLAY_H
#define LAMPYRIS_RENDER_PROBE_REPLAY_H

#include "render/render.h"

// The target of a shadow ray.
struct replay_light {
    uint32_t ray;   // index among the vertex's shadow rays
    float point[3]; // relative to the shadow ray's origin
    float pdf;
    bool is_shape;
    bool is_environment; // an environment image; `primitive` is then 0
    bool is_point;       // a delta light: `primitive` is its index in the scene
    uint32_t primitive;
    float radiance[3]; // radiance that arrives unless the ray is occluded
    bool occluded;
};

// A ray of the path, its hit, and the resulting contributions. Positions are in world space,
// lengths in metres.
struct replay_vertex {
    uint32_t bounce;
    float origin[3], direction[3];
    float bsdf_pdf; // density per solid angle; 0 for the camera and for delta lobes
    float throughput[3];
    const char *queue; // "surface", "miss"; "none": a miss in a scene without an environment

    // The following members are valid if `queue` is "surface".
    float t;
    double position[3];
    bool is_shape;
    uint32_t primitive; // index into the flat scene's triangles or shapes
    uint32_t instance;  // index into the flat scene's instances if they share the mesh; else
                        // NO_INSTANCE
    const struct material *material;

    float gained[3]; // emission of the surface or radiance of the environment, with MIS weight

    struct replay_light *lights; // the targets of the vertex's shadow rays
    uint32_t light_count;
};

struct replay {
    struct replay_vertex *vertices;
    uint32_t vertex_count;
    float radiance[3]; // radiance of the sample
    bool dropped;      // some contribution was not finite and was left out
};

// Follows a sample; the film is unchanged. Memory comes from `arena`. The pixel (x, y) must be
// inside the image.
bool renderer_replay(struct renderer *renderer, uint32_t x, uint32_t y, uint64_t sample,
                     struct arena *arena, struct replay *out, struct err *err);

#endif
