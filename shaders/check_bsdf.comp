// Runs the renderer's BSDFs on input that the host has written to the paths' buffer. Each thread
// has four words (uvec4) there, which it overwrites with its output:
//   in:         wo, material index; wi, eta; u; unused
//   sample out: wi, pdf; weight, BSDF_* flags; result of eval_bsdf() for that wi: f cos, pdf
//   eval out:   f cos, pdf
// Two routines test parts of BSDFs:
//   microfacet in:  w, material index; h, unused; alpha x, y
//   microfacet out: D(h), density of h seen from w, G1(w), GTR1 of alpha x
//   fresnel in:     cosine, eta; fresnel out: reflectance, cosine of refraction
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/bsdf.glsl"
#include "shared/check_bsdf.h"

layout(constant_id = CONSTANT_CHECK_ROUTINE) const uint ROUTINE = 0u;

void store_output(uint item, uint word, uvec4 value)
{
    paths_words[item * PATH_WORDS + word] = value;
}

void sample_item(uint item, material m, vec3 wo, float eta, vec4 u)
{
    bsdf_sample s = sample_bsdf(m, wo, eta, u);
    uint flags = (s.valid ? BSDF_VALID : 0u) | (s.specular ? BSDF_SPECULAR : 0u) |
                 (s.transmitted ? BSDF_TRANSMITTED : 0u);
    float pdf = 0.0;
    vec3 f = vec3(0.0);
    if (s.valid && !s.specular)
        f = eval_bsdf(m, wo, s.wi, eta, pdf);
#ifdef PLANTED_LOBE
    s.weight *= 1.05;
#endif
    store_output(item, 0u, floatBitsToUint(vec4(s.wi, s.pdf)));
    store_output(item, 1u, uvec4(floatBitsToUint(s.weight), flags));
    store_output(item, 2u, floatBitsToUint(vec4(f, pdf)));
}

void main()
{
    uint item = push.first_item + gl_GlobalInvocationID.x;
    if (item >= push.part_items)
        return;
    uvec4 w0 = paths_words[item * PATH_WORDS];
    vec4 w1 = uintBitsToFloat(paths_words[item * PATH_WORDS + 1u]);
    vec4 u = uintBitsToFloat(paths_words[item * PATH_WORDS + 2u]);
    material m = load_material(w0.w);
    vec3 wo = uintBitsToFloat(w0.xyz);
    if (ROUTINE == BSDF_ROUTINE_SAMPLE)
        sample_item(item, m, wo, w1.w, u);
    if (ROUTINE == BSDF_ROUTINE_EVAL) {
        float pdf;
        vec3 f = eval_bsdf(m, wo, w1.xyz, w1.w, pdf);
#ifdef PLANTED_LOBE // planted fault, which tests must detect: the lobe is not reciprocal
        f *= 1.0 + 0.05 * wo.z;
        pdf *= 1.05;
#endif
        store_output(item, 0u, floatBitsToUint(vec4(f, pdf)));
    }
    if (ROUTINE == BSDF_ROUTINE_MICROFACET)
        store_output(item, 0u, floatBitsToUint(vec4(ggx_d(w1.xyz, u.xy),
                                                    pdf_ggx_vndf(wo, w1.xyz, u.xy),
                                                    ggx_g1(wo, u.xy), gtr1_d(w1.xyz, u.x))));
    if (ROUTINE == BSDF_ROUTINE_FRESNEL) {
        float cos_t;
        float reflectance = fresnel_dielectric(wo.x, wo.y, cos_t);
        store_output(item, 0u, floatBitsToUint(vec4(reflectance, cos_t, 0.0, 0.0)));
    }
}
