// Next-event estimation: shadow rays from a vertex to points on emitters.
#ifndef CONNECT_GLSL
#define CONNECT_GLSL

#include "lib/light.glsl"
#include "lib/ray_offset.glsl"
#include "lib/vertex.glsl"

// Writes the shadow ray to a point on an emitter; false when there is nothing to connect.
bool connect_light(vertex v, vec4 u)
{
    surface s = v.s;
    vec3 origin = offset_origin(s.position, s.error, s.normal_geometric, s.normal_geometric);
    light_sample l = sample_light(origin, u);
    vec3 wi = normalize(l.to_light);
    vec3 local = wi * v.frame;
    if (!(l.pdf > 0.0) || !sides_agree(v, wi, local))
        return false;

    float pdf;
    vec3 f = eval_bsdf(v.m, v.wo, local, v.eta, pdf);
    float weight = 1.0;
    if (HAS(FEATURE_BSDF_HITS_EMITTERS) && !l.delta)
        weight = mis_weight(l.pdf, pdf);
    vec3 radiance = v.throughput * f * l.radiance * (weight / l.pdf);
    if (HAS(FEATURE_MEDIA))
        radiance *= transmittance(load_medium(medium_towards(v, wi)), length(l.to_light));
    if (all(equal(radiance, vec3(0.0))))
        return false;
    if (HAS_LOBE(LOBES_THROUGH) && local.z < 0.0) {
        vec3 other = offset_origin(s.position, s.error, s.normal_geometric, wi);
        l.to_light += origin - other;
        origin = other;
    }
    store_shadow_ray(v.slot, 0u, 0u, uvec4(floatBitsToUint(origin), v.primitive));
    store_shadow_ray(v.slot, 0u, 1u, uvec4(floatBitsToUint(l.to_light), l.primitive));
    store_shadow_ray(v.slot, 0u, 2u, floatBitsToUint(vec4(radiance, l.pdf)));
    return true;
}

#endif
