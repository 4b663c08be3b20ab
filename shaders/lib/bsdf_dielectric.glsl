// Evaluates and samples interfaces of dielectrics and conductors, smooth and rough. All functions
// are pure, except that they read the tables of lib/albedo.glsl. See lib/bsdf_types.glsl for the
// frame and the conventions, docs/materials-classical.md for the formulas.
#ifndef BSDF_DIELECTRIC_GLSL
#define BSDF_DIELECTRIC_GLSL

#include "lib/albedo.glsl"
#include "lib/bsdf_types.glsl"
#include "lib/fresnel.glsl"
#include "lib/microfacet.glsl"
#include "lib/random.glsl"

// The minimum width of a refracted lobe that can be evaluated. A lobe is about alpha |eta - 1|
// wide, and directions are rounded to 2^-24. Narrower lobes are sampled, but not evaluated.
const float SMALLEST_REFRACTED_WIDTH = 7.62939453125e-6; // 2^-17

float dielectric_alpha(material m)
{
    float roughness = material_roughness(m);
    return roughness * roughness;
}

bool is_delta(float alpha)
{
    return HAS_LOBE(LOBE_DELTA) && (!HAS_LOBE(LOBE_ROUGH) || alpha < SMALLEST_ALPHA);
}

bool is_separable(material m)
{
    return HAS_LOBE(LOBE_SEPARABLE) && material_has(m, MATERIAL_SEPARABLE);
}

bool is_thin(material m)
{
    return HAS_LOBE(LOBE_THIN) && material_has(m, MATERIAL_THIN);
}

// Returns whether the interface is invisible because the indices on both sides are equal, up to the
// permitted error of Vulkan's division (2.5 units in the last place).
bool is_index_matched(float eta)
{
    return abs(eta - 1.0) <= GAMMA(6);
}

// Returns the reflectance of a thin slab with two faces, including all reflections between them: R
// + (1 - R)^2 R / (1 - R^2) = 2 R / (1 + R).
float fresnel_slab(float cos_i, float eta)
{
    float cos_t;
    float r = fresnel_dielectric(cos_i, eta, cos_t);
    return 2.0 * r / (1.0 + r);
}

// Evaluates reflection by GGX microfacets without their reflectance, D G2 / (4 wo.z), and the
// density of reflecting about a sampled normal. Requires wi.z > 0.
float eval_ggx_reflection(vec3 wo, vec3 wi, vec4 h, float alpha, bool separable, out float pdf)
{
    vec2 alphas = vec2(alpha);
    pdf = 0.0;
    if (!(h.w > 0.0))
        return 0.0;
    float visible = pdf_ggx_reflection(wo, h.xyz, alphas);
    pdf = pdf_ggx_drawn(visible, h.xyz, alphas, 0.25 / h.w);
    return visible * ggx_g2(wo, wi, alphas, separable) / ggx_g1(wo, alphas);
}

// --- repeated tries -----------------------------------------------------------------------------

// The maximum number of tries. A sample that is shadowed by another microfacet is sampled again. If
// it were absorbed instead, and the others were weighted by 1 / `survival`, few paths inside rough
// glass would carry all the light.
const int MICROFACET_TRIES = 32;

// Returns the probability that one of the tries survives, divided by that of a single try: (1 - (1
// - survival)^32) / survival, computed without cancellation.
float tries_scale(float survival)
{
    float failed = 1.0 - survival;
    float product = 1.0 + failed;
    for (int i = 2; i < MICROFACET_TRIES; i *= 2) {
        failed *= failed;
        product *= 1.0 + failed;
    }
    return product;
}

// Returns the uniforms of the next try, computed from those of the present try.
vec4 try_again(vec4 u)
{
    return to_uniforms(pcg4d(floatBitsToUint(u)));
}

bool dielectric_is_compensated(material m)
{
    return HAS_LOBE(LOBE_COMPENSATE) && material_has(m, MATERIAL_COMPENSATE);
}

// Returns whether samples are tried again: the tables have the probability of survival only for
// height-correlated masking and visible normals.
bool dielectric_tries_again(material m)
{
    return dielectric_is_compensated(m) && !is_separable(m) && NORMALS == NORMALS_VISIBLE;
}

// Returns the albedo by which single scattering is divided. The result then includes, in
// proportion, the energy that further scattering between microfacets would reflect and transmit, so
// that the interface is lossless (Turquin 2019, "Practical Multiple Scattering Compensation for
// Microfacet Models", eq. 14 with F = 1, over both sides). As eta approaches 1, this albedo
// approaches G1(wo), and the remaining energy passes straight through.
float dielectric_albedo(material m, float cos_o, float eta, float alpha)
{
    if (!dielectric_is_compensated(m))
        return 1.0;
    if (is_thin(m))
        return albedo_ggx(albedos_begin(), cos_o, alpha);
    return albedo_glass(albedos_begin(), cos_o, alpha, eta);
}

bsdf_sample dielectric_straight(vec3 wo)
{
    return bsdf_sample(-wo, vec3(1.0), 0.0, true, true, true);
}

bsdf_sample sample_smooth_dielectric(vec3 wo, float eta, bool thin, float u)
{
    float cos_t;
    float reflectance = thin ? fresnel_slab(wo.z, eta) : fresnel_dielectric(wo.z, eta, cos_t);
    if (u < reflectance)
        return bsdf_sample(vec3(-wo.xy, wo.z), vec3(1.0), 0.0, true, false, true);
    if (thin)
        return dielectric_straight(wo);
    return bsdf_sample(vec3(-wo.xy / eta, -cos_t), vec3(1.0 / refraction_divisor(eta)), 0.0, true,
                       true, true);
}

// Evaluates eqs. 16, 17, 20 and 21 of Walter et al. 2007. If `thin` is set, transmission is the
// mirror image of reflection.
vec3 eval_rough_dielectric(vec3 wo, vec3 wi, float eta, float alpha, bool thin, bool separable,
                           out float pdf)
{
    pdf = 0.0;
    vec2 alphas = vec2(alpha);
    float cos_t;
    if (wi.z > 0.0 || thin) {
        vec3 mirrored = vec3(wi.xy, abs(wi.z));
        vec4 h = reflection_half_vector(wo, mirrored);
        float f = eval_ggx_reflection(wo, mirrored, h, alpha, separable, pdf);
        float part = thin ? fresnel_slab(h.w, eta) : fresnel_dielectric(h.w, eta, cos_t);
        part = wi.z > 0.0 ? part : 1.0 - part;
        pdf *= part;
        return vec3(f * part);
    }
    vec3 sum = refraction_half_vector(wo, wi, eta);
    float length2 = dot(sum, sum);
    if (alpha * abs(eta - 1.0) < SMALLEST_REFRACTED_WIDTH || !(length2 > 0.0))
        return vec3(0.0);
    vec3 h = sum * inversesqrt(length2);
    float cos_o = dot(wo, h);
    float cos_i = -dot(wi, h);
    if (!(cos_o > 0.0 && cos_i > 0.0))
        return vec3(0.0);
    float transmittance = 1.0 - fresnel_dielectric(cos_o, eta, cos_t);
    float jacobian = eta * eta * cos_i / length2;
    float visible = transmittance * pdf_ggx_vndf(wo, h, alphas) * jacobian;
    pdf = pdf_ggx_drawn(visible, h, alphas, transmittance * jacobian);
    return vec3(visible * ggx_g1(wi, alphas) / refraction_divisor(eta));
}

// Makes one try to sample the rough interface. `unshadowed` is the probability that no other
// microfacet shadows the sampled direction; if normals are sampled by D, it is a weight instead.
bsdf_sample try_rough_dielectric(vec3 wo, float eta, float alpha, bool thin, bool separable,
                                 vec4 u, out float unshadowed)
{
    vec2 alphas = vec2(alpha);
    unshadowed = 0.0;
    vec3 h = sample_ggx_normal(wo, alphas, u.xy);
    float cos_o = dot(wo, h);
    if (!(cos_o > 0.0))
        return bsdf_absorbed();
    float cos_t;
    float reflectance = thin ? fresnel_slab(cos_o, eta) : fresnel_dielectric(cos_o, eta, cos_t);
    bool reflects = u.z < reflectance;
    vec3 wi;
    if (reflects || thin)
        wi = normalize(2.0 * cos_o * h - wo);
    else
        wi = refract_about(wo, h, eta, cos_o, cos_t);
    if (reflects || thin ? !(wi.z > 0.0) : !(wi.z < 0.0))
        return bsdf_absorbed();

    unshadowed = ggx_drawn_weight(wo, wi, h, alphas, separable);
    float scale = reflects || thin ? 1.0 : 1.0 / refraction_divisor(eta);
    if (!reflects && thin)
        wi.z = -wi.z;
    bool hidden =
        !reflects && !thin && alpha * abs(eta - 1.0) < SMALLEST_REFRACTED_WIDTH;
    return bsdf_sample(wi, vec3(scale), 0.0, hidden, !reflects, true);
}

vec3 eval_dielectric(material m, vec3 wo, vec3 wi, float eta, out float pdf)
{
    float alpha = dielectric_alpha(m);
    pdf = 0.0;
    if (!HAS_LOBE(LOBE_ROUGH) || is_delta(alpha) || is_index_matched(eta))
        return vec3(0.0);
    vec3 f = eval_rough_dielectric(wo, wi, eta, alpha, is_thin(m), is_separable(m), pdf);
    float albedo = dielectric_albedo(m, wo.z, eta, alpha);
    if (dielectric_tries_again(m))
        pdf = f.x * (wi.z < 0.0 && !is_thin(m) ? refraction_divisor(eta) : 1.0) *
              tries_scale(albedo);
    return f / albedo;
}

bsdf_sample sample_rough_dielectric(material m, vec3 wo, float eta, float alpha, vec4 u)
{
    bool again = dielectric_tries_again(m);
    float albedo = dielectric_albedo(m, wo.z, eta, alpha);
    float unshadowed;
    bool separable = is_separable(m);
    bsdf_sample s = try_rough_dielectric(wo, eta, alpha, is_thin(m), separable, u, unshadowed);
    for (int i = 1; again && !(u.w < unshadowed) && i < MICROFACET_TRIES; i++) {
        u = try_again(u);
        s = try_rough_dielectric(wo, eta, alpha, is_thin(m), separable, u, unshadowed);
    }
    if (!s.valid || (again && !(u.w < unshadowed)))
        return bsdf_absorbed();
    s.weight *= again ? 1.0 / (albedo * tries_scale(albedo)) : unshadowed / albedo;
    if (!s.specular) {
        vec3 f = eval_dielectric(m, wo, s.wi, eta, s.pdf);
        s.valid = s.pdf > 0.0;
        // With normals sampled by D the weight depends on the normal, which cannot be recomputed
        // exactly from rounded directions.
        if (NORMALS == NORMALS_NDF)
            s.weight = s.valid ? f / s.pdf : vec3(0.0);
    }
    return s;
}

bsdf_sample sample_dielectric(material m, vec3 wo, float eta, vec4 u)
{
    float alpha = dielectric_alpha(m);
    if (is_index_matched(eta))
        return dielectric_straight(wo);
    bsdf_sample s = bsdf_absorbed();
    if (HAS_LOBE(LOBE_DELTA) && is_delta(alpha))
        s = sample_smooth_dielectric(wo, eta, is_thin(m), u.z);
    if (HAS_LOBE(LOBE_ROUGH) && !is_delta(alpha))
        s = sample_rough_dielectric(m, wo, eta, alpha, u);
    return s;
}

// The complex index of a conductor is relative to vacuum. A conductor has no ior of its own, so
// `eta` gives the index outside.
vec3 conductor_reflectance(material m, float cos_theta, float eta)
{
    float outside = material_ior(m) / eta;
    return fresnel_conductor(cos_theta, material_conductor_eta(m) / outside,
                             material_conductor_k(m) / outside);
}

// Returns the factor on single scattering that adds the energy of further scattering between
// microfacets: 1 + F0 (1 - E1) / E1 (Turquin 2019, "Practical Multiple Scattering Compensation for
// Microfacet Models", eqs. 14 to 16).
vec3 conductor_compensation(material m, float cos_o, float eta, float alpha)
{
    if (!HAS_LOBE(LOBE_COMPENSATE) || !material_has(m, MATERIAL_COMPENSATE))
        return vec3(1.0);
    float e1 = albedo_ggx(albedos_begin(), cos_o, alpha);
    return 1.0 + conductor_reflectance(m, 1.0, eta) * ((1.0 - e1) / e1);
}

vec3 eval_conductor(material m, vec3 wo, vec3 wi, float eta, out float pdf)
{
    float alpha = dielectric_alpha(m);
    pdf = 0.0;
    if (!HAS_LOBE(LOBE_ROUGH) || is_delta(alpha) || !(wi.z > 0.0))
        return vec3(0.0);
    vec4 h = reflection_half_vector(wo, wi);
    float f = eval_ggx_reflection(wo, wi, h, alpha, is_separable(m), pdf);
    return f * conductor_reflectance(m, h.w, eta) * conductor_compensation(m, wo.z, eta, alpha);
}

bsdf_sample sample_conductor(material m, vec3 wo, float eta, vec4 u)
{
    float alpha = dielectric_alpha(m);
    if (is_delta(alpha))
        return bsdf_sample(vec3(-wo.xy, wo.z), conductor_reflectance(m, wo.z, eta), 0.0, true,
                           false, true);
    if (!HAS_LOBE(LOBE_ROUGH))
        return bsdf_absorbed();
    vec3 h = sample_ggx_normal(wo, vec2(alpha), u.xy);
    vec3 wi = normalize(2.0 * dot(wo, h) * h - wo);
    float pdf;
    vec3 f = eval_conductor(m, wo, wi, eta, pdf);
    return bsdf_sample(wi, pdf > 0.0 ? f / pdf : vec3(0.0), pdf, false, false, pdf > 0.0);
}

#endif
