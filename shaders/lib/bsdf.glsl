// Evaluates and samples the BSDF of a surface, for all material models. All functions are pure,
// except that they read the tables of lib/albedo.glsl. See lib/bsdf_types.glsl for the frame and
// the conventions.
#ifndef BSDF_GLSL
#define BSDF_GLSL

#include "lib/bsdf_classical.glsl"
#include "lib/bsdf_dielectric.glsl"
#include "lib/bsdf_principled.glsl"
#include "lib/bsdf_types.glsl"
#include "lib/sampling.glsl"

vec3 eval_lambert(material m, vec3 wi, out float pdf)
{
    pdf = pdf_cosine_hemisphere(max(wi.z, 0.0));
    return material_base_color(m) * pdf;
}

bsdf_sample sample_lambert(material m, vec4 u)
{
    vec3 wi = sample_cosine_hemisphere(u.xy);
    return bsdf_sample(wi, material_base_color(m), pdf_cosine_hemisphere(wi.z), false, false,
                       wi.z > 0.0);
}

bsdf_sample sample_mirror(material m, vec3 wo)
{
    return bsdf_sample(vec3(-wo.xy, wo.z), material_base_color(m), 0.0, true, false, true);
}

// Returns BSDF * |wi.z| of all lobes that are not delta lobes, and the density with which
// sample_bsdf() samples wi.
vec3 eval_bsdf(material m, vec3 wo, vec3 wi, float eta, out float pdf)
{
    uint model = material_model(m);
    vec3 f = vec3(0.0);
    pdf = 0.0;
    if (HAS_LOBE(LOBE_LAMBERT) && model == MATERIAL_LAMBERT)
        f = eval_lambert(m, wi, pdf);
    if (HAS_LOBE(LOBE_PRINCIPLED) && model == MATERIAL_PRINCIPLED)
        f = eval_principled(m, wo, wi, eta, pdf);
    if (HAS_LOBE(LOBE_DIELECTRIC) && model == MATERIAL_DIELECTRIC)
        f = eval_dielectric(m, wo, wi, eta, pdf);
    if (HAS_LOBE(LOBE_CONDUCTOR) && model == MATERIAL_CONDUCTOR)
        f = eval_conductor(m, wo, wi, eta, pdf);
    if (HAS_LOBE(LOBE_PHONG) && model == MATERIAL_PHONG)
        f = eval_phong(m, wo, wi, pdf);
    if (HAS_LOBE(LOBE_BLINN_PHONG) && model == MATERIAL_BLINN_PHONG)
        f = eval_blinn_phong(m, wo, wi, pdf);
    if (HAS_LOBE(LOBE_MICROFACET) && model == MATERIAL_MICROFACET)
        f = eval_microfacet(m, wo, wi, eta, pdf);
    return f;
}

bsdf_sample sample_bsdf(material m, vec3 wo, float eta, vec4 u)
{
    uint model = material_model(m);
    bsdf_sample s = bsdf_absorbed();
    if (HAS_LOBE(LOBE_LAMBERT) && model == MATERIAL_LAMBERT)
        s = sample_lambert(m, u);
    if (HAS_LOBE(LOBE_MIRROR) && model == MATERIAL_MIRROR)
        s = sample_mirror(m, wo);
    if (HAS_LOBE(LOBE_PRINCIPLED) && model == MATERIAL_PRINCIPLED)
        s = sample_principled(m, wo, eta, u);
    if (HAS_LOBE(LOBE_DIELECTRIC) && model == MATERIAL_DIELECTRIC)
        s = sample_dielectric(m, wo, eta, u);
    if (HAS_LOBE(LOBE_CONDUCTOR) && model == MATERIAL_CONDUCTOR)
        s = sample_conductor(m, wo, eta, u);
    if (HAS_LOBE(LOBE_PHONG) && model == MATERIAL_PHONG)
        s = sample_phong(m, wo, u);
    if (HAS_LOBE(LOBE_BLINN_PHONG) && model == MATERIAL_BLINN_PHONG)
        s = sample_blinn_phong(m, wo, u);
    if (HAS_LOBE(LOBE_MICROFACET) && model == MATERIAL_MICROFACET)
        s = sample_microfacet(m, wo, eta, u);
    return s;
}

#endif
