// The BSDF of a surface: of whichever model its material has. Pure but for the tables of
// lib/albedo.glsl. See lib/bsdf_types.glsl for the frame and the conventions.
#ifndef BSDF_GLSL
#define BSDF_GLSL

#include "lib/bsdf_types.glsl"
#include "lib/sampling.glsl"

vec3 eval_lambert(material m, vec3 wi, out float pdf)
{
    pdf = pdf_cosine_hemisphere(max(wi.z, 0.0));
    return m.group[GROUP_BASE].rgb * pdf;
}

bsdf_sample sample_lambert(material m, vec4 u)
{
    vec3 wi = sample_cosine_hemisphere(u.xy);
    return bsdf_sample(wi, m.group[GROUP_BASE].rgb, pdf_cosine_hemisphere(wi.z), false, false,
                       wi.z > 0.0);
}

bsdf_sample sample_mirror(material m, vec3 wo)
{
    return bsdf_sample(vec3(-wo.xy, wo.z), m.group[GROUP_BASE].rgb, 0.0, true, false, true);
}

// BSDF * |wi.z| of all that is not a delta, and the density with which sample_bsdf() draws wi.
vec3 eval_bsdf(material m, vec3 wo, vec3 wi, float eta, out float pdf)
{
    uint model = material_model(m);
    vec3 f = vec3(0.0);
    pdf = 0.0;
    if (HAS_LOBE(LOBE_LAMBERT) && model == MATERIAL_LAMBERT)
        f = eval_lambert(m, wi, pdf);
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
    return s;
}

#endif
