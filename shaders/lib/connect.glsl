// Stores shadow rays from a vertex to points on emitters (next-event estimation).
#ifndef CONNECT_GLSL
#define CONNECT_GLSL

#include "lib/adjoint.glsl"
#include "lib/directions.glsl"
#include "lib/emit.glsl"
#include "lib/light.glsl"
#include "lib/ray_offset.glsl"
#include "lib/sampler.glsl"
#include "lib/split.glsl"
#include "lib/vertex.glsl"

// Returns the density with which light paths sample the path that a shadow ray in the unit
// direction `wi` completes, divided by the density of the shadow ray (lib/bidir.glsl).
float light_path_ratio(vertex v, vec3 wi, light_sample l)
{
    float ratio = v.ratio;
    if (ratio > 0.0 && push.bounce > 0u) {
        float pdf;
        eval_reversed(v, wi, pdf);
        ratio = pdf > 0.0 ? ratio * pdf : 0.0;
    }
    return ratio > 0.0 ? ratio * emission_over_pdf(v, wi, l) : 0.0;
}

// Returns the BSDF of material m times the cosine. weight: the MIS weight of the shadow ray against
// scattered rays of m.
vec3 eval_connection(vertex v, material m, vec3 local, light_sample l, out float weight)
{
    float pdf;
    vec3 f = eval_bsdf(m, v.wo, local, v.eta, pdf);
    pdf = pdf_onwards(m, v.wo, local, v.eta, pdf);
    if (HAS(FEATURE_MIN_DENSITY) && pdf < frame.min_density)
        pdf = 0.0; // paths do not continue in this direction
    weight = 1.0;
    if (HAS(FEATURE_BSDF_HITS_EMITTERS) && !l.delta)
        weight = mis_weight(l.pdf, pdf);
    if (IS_BIDIR)
        weight = weight_of_camera_path(l.delta ? 0.0 : pdf / l.pdf,
                                 light_path_ratio(v, normalize(l.to_light), l));
    return f;
}

// Returns, at a vertex where the path splits, the sum over both parts. Each part is weighted
// against the branch that samples it.
vec3 eval_split_connection(vertex v, vec3 local, light_sample l)
{
    float weight_d, weight_s;
    vec3 d = eval_connection(v, part_of(v.m, MATERIAL_DIFFUSE_PART), local, l, weight_d);
    vec3 s = eval_connection(v, part_of(v.m, MATERIAL_SPECULAR_PART), local, l, weight_s);
    return d * weight_d + s * weight_s;
}

// Stores shadow ray `ray` to a sampled point of an emitter. Returns false if it would contribute
// nothing.
bool connect_sample(vertex v, vec3 origin, uint ray, light_sample l)
{
    surface s = v.s;
    vec3 wi = normalize(l.to_light);
    vec3 local = wi * v.frame;
    if (!(l.pdf > 0.0) || !sides_agree(v, wi, local))
        return false;

    float weight = 1.0;
    vec3 f;
    bool splits = false;
    if (CAN_SPLIT) {
        splits = splits_lobes(v.m);
        if (splits)
            f = eval_split_connection(v, local, l);
    }
    if (!splits)
        f = eval_connection(v, v.m, local, l, weight);
    vec3 radiance = v.throughput * f * l.radiance * (weight / l.pdf);
    if (HAS(FEATURE_MEDIA))
        radiance *= transmittance(load_medium(medium_towards(v, wi)), light_distance(l));
    if (all(equal(radiance, vec3(0.0))))
        return false;
    if (HAS_LOBE(LOBES_THROUGH) && local.z < 0.0) {
        vec3 other = offset_origin(s.position, s.error, s.normal_geometric, wi);
        l.to_light += origin - other;
        origin = other;
    }
    store_shadow_ray(v.slot, ray, 0u, uvec4(floatBitsToUint(origin), v.primitive));
    store_shadow_ray(v.slot, ray, 1u, uvec4(floatBitsToUint(l.to_light), l.primitive));
    store_shadow_ray(v.slot, ray, 2u, floatBitsToUint(vec4(radiance, l.pdf)));
    store_shadow_instance(v.slot, ray, v.instance);
    return true;
}

// Sends a shadow ray to each lamp. Rays that would contribute nothing are stored with contribution
// 0.
bool connect_all_lamps(vertex v, receiver r)
{
    bool any_ray = false;
    for (uint i = 0u; i < LIGHT_RAYS; i++) {
        vec4 u = uniforms(v.slot, light_dimension(push.bounce, i));
        bool connected = connect_sample(v, r.position, i, sample_lamp(r, i, u));
        any_ray = any_ray || connected;
        if (!connected && LIGHT_RAYS > 1u)
            store_shadow_ray(v.slot, i, 2u, uvec4(0u));
    }
    return any_ray;
}

// Stores the vertex's shadow rays. Returns false if there are none. u: selects one emitter, see
// sample_light().
bool connect_light(vertex v, vec4 u)
{
    surface s = v.s;
    vec3 origin = offset_origin(s.position, s.error, s.normal_geometric, s.normal_geometric);
    receiver r = receiver(origin, s.normal_geometric, is_lit_from_both_sides(s.material));
    bool by_lamp = false, any_ray = false;
    if (LIGHT_CHOICE == LIGHT_CHOICE_ALL) {
        by_lamp = connects_to_each(push.bounce);
        if (by_lamp)
            any_ray = connect_all_lamps(v, r);
    }
    if (!CONNECTS_ALWAYS_TO_EACH) {
        if (!by_lamp)
            any_ray = connect_sample(v, origin, 0u, sample_light(r, u));
    }
    return any_ray;
}

#endif
