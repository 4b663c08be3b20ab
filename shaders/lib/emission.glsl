// Adds the emission of a surface that a path has hit.
#ifndef EMISSION_GLSL
#define EMISSION_GLSL

#include "lib/emit.glsl"
#include "lib/light.glsl"
#include "lib/nee.glsl"
#include "lib/radiance.glsl"
#include "lib/vertex.glsl"

// Adds the emission, with the MIS weight against next-event estimation.
void add_emission(vertex v, vec3 origin, vec3 direction, float distance, float bsdf_pdf)
{
    float weight = 1.0, shadow_ratio = 0.0;
    if (sent_shadow_rays(bsdf_pdf) && material_pick_density(v.m) > 0.0 &&
        !is_found_by_chance(origin, v.primitive, v.s)) {
        uint from = load_path(v.slot, PATH_ORIGIN).w;
        float pick_density = pick_density_at(v.m, v.primitive, origin, direction, from,
                                             path_start_instance(v.slot));
        weight = 0.0;
        if (HAS(FEATURE_NEE) && HAS(FEATURE_BSDF_HITS_EMITTERS)) {
            float pdf = pdf_light(origin, direction, distance, v.s, v.primitive, pick_density);
            weight = mis_weight(bsdf_pdf, pdf);
            shadow_ratio = pdf / bsdf_pdf;
        }
    }
    if (IS_BIDIR) {
        // Light paths do not find emission that the camera sees directly.
        float light_ratio = 0.0;
        if (push.bounce > 0u && v.ratio > 0.0)
            light_ratio = v.ratio * emission_density(v.primitive, v.s.material, v.m);
        weight = weight_of_camera_path(shadow_ratio, light_ratio);
    }
    vec3 emission = material_emission(v.m);
    if (weight > 0.0 && any(greaterThan(emission, vec3(0.0))))
        add_radiance(v.slot, v.throughput * emission * weight, SITE_EMISSION,
                     emitter_of_primitive(v.primitive));
}

#endif
