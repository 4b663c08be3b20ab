// Continues a path from a vertex. Writes the path's record.
#ifndef SCATTER_GLSL
#define SCATTER_GLSL

#include "lib/adjoint.glsl"
#include "lib/bidir.glsl"
#include "lib/directions.glsl"
#include "lib/ray_offset.glsl"
#include "lib/roulette.glsl"
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
    // Delta samples have no density, so this limit does not end them.
    if (HAS(FEATURE_MIN_DENSITY) && r.valid && r.pdf > 0.0 && r.pdf < frame.min_density) {
        atomicAdd(counters.sparse, 1u);
        r.valid = false;
    }
    return r;
}

// Returns Q of lib/bidir.glsl for the next vertex. `pdf` is 0 for delta samples, and if the path
// passes through the surface.
float ratio_onwards(vertex v, vec3 direction, float pdf, bool passes)
{
    if (push.bounce == 0u)
        return pdf > 0.0 ? v.ratio / pdf : 0.0;
    if (!(v.ratio > 0.0))
        return 0.0;
    if (!(pdf > 0.0))
        return passes || is_reversible(v, direction) ? v.ratio : 0.0;
    float reversed;
    eval_reversed(v, direction, reversed);
    return reversed > 0.0 ? v.ratio * (reversed / pdf) : 0.0;
}

// Continues the path in slot v.slot. Returns false if it ends. stack: media before the surface;
// u_roulette: decides whether the path survives.
bool go_on(vertex v, vec3 direction, bool passes, uint stack, vec4 u, float u_part,
           float u_roulette)
{
    ray_onwards next = scatter(v, direction, passes, stack, u, u_part);
    if (!is_finite(v.throughput)) {
        report_nonfinite(v.slot, SITE_THROUGHPUT);
        next.valid = false;
    }
    float scale = 1.0;
    if (HAS(FEATURE_MEDIA) && HAS(FEATURE_ROULETTE))
        scale = roulette_scale(load_medium(media_current(next.media)).ior);
    bool goes_on = next.valid && any(greaterThan(v.throughput, vec3(0.0))) &&
                   survives_roulette(v.slot, v.throughput, scale, u_roulette);
    if (goes_on) {
        vec3 from =
            offset_origin(v.s.position, v.s.error, v.s.normal_geometric, next.direction);
        store_path(v.slot, PATH_ORIGIN, uvec4(floatBitsToUint(from), v.primitive));
        store_path(v.slot, PATH_DIRECTION, floatBitsToUint(vec4(next.direction, next.pdf)));
        store_path(v.slot, PATH_THROUGHPUT, uvec4(floatBitsToUint(v.throughput), next.media));
        store_path_start_instance(v.slot, v.instance);
        if (IS_BIDIR)
            store_ratio(v.slot, ratio_onwards(v, next.direction, next.pdf, passes));
    }
    return goes_on;
}

#endif
