// How a path goes on from a vertex.
#ifndef SCATTER_GLSL
#define SCATTER_GLSL

#include "lib/directions.glsl"
#include "lib/vertex.glsl"

struct ray_onwards {
    vec3 direction;
    float pdf;
    uint media;
    bool valid;
};

ray_onwards scatter(inout vertex v, vec3 direction, bool passes, uint stack, vec4 u, float u_part)
{
    if (HAS(FEATURE_MEDIA) && passes)
        return ray_onwards(direction, 0.0, v.media.stack_beyond, true);
    bsdf_sample b;
    if (DIRECTIONS == DIRECTIONS_BSDF)
        b = sample_bsdf(v.m, v.wo, v.eta, u);
    else
        b = sample_onwards(v.m, v.wo, v.eta, u, u_part);
    vec3 next = normalize(v.frame * b.wi);
    ray_onwards r = ray_onwards(next, b.pdf, stack, b.valid && sides_agree(v, next, b.wi));
    if (HAS(FEATURE_MEDIA) && b.transmitted)
        r.media = v.media.stack_beyond;
    v.throughput *= b.weight;
    // Diracs have no density, and go on.
    if (HAS(FEATURE_MIN_DENSITY) && r.valid && r.pdf > 0.0 && r.pdf < frame.min_density) {
        atomicAdd(counters.sparse, 1u);
        r.valid = false;
    }
    return r;
}

#endif
