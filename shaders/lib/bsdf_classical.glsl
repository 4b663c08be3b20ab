// Evaluates and samples models with which papers and courses compare their own: Phong, Blinn-Phong
// and Torrance-Sparrow microfacets, each over a Lambertian base. All functions are pure. See
// lib/bsdf_types.glsl for the frame and the conventions, docs/materials-classical.md for the
// formulas and their energy.
#ifndef BSDF_CLASSICAL_GLSL
#define BSDF_CLASSICAL_GLSL

#include "lib/beckmann.glsl"
#include "lib/bsdf_dielectric.glsl"
#include "lib/sampling.glsl"

// The part of the BSDF that does not depend on wi: the colours of the two lobes, and the
// probability of sampling the specular one.
struct classical_parts {
    vec3 diffuse;  // albedo
    vec3 specular; // scale of the highlight
    float p_specular;
};

float sum_of(vec3 v)
{
    return v.r + v.g + v.b;
}

classical_parts classical_choose(vec3 diffuse, vec3 specular, float albedo_diffuse,
                                 float albedo_specular)
{
    float p = albedo_diffuse > 0.0 ? albedo_specular / (albedo_specular + albedo_diffuse) : 1.0;
    return classical_parts(diffuse, specular, p);
}

// Removes one of the two lobes if the material is restricted to the diffuse or the specular part.
classical_parts classical_part(material m, classical_parts parts)
{
    if (is_part(m, MATERIAL_DIFFUSE_PART))
        return classical_parts(parts.diffuse, vec3(0.0), 0.0);
    if (is_part(m, MATERIAL_SPECULAR_PART))
        return classical_parts(vec3(0.0), parts.specular, 1.0);
    return parts;
}

vec3 classical_specular_color(material m)
{
    return min(material_specular_color(m), vec3(1.0));
}

// Returns the lobes of Phong and Blinn-Phong: the highlight reflects at most `specular`, the base
// the rest.
classical_parts phong_parts(material m)
{
    vec3 specular = classical_specular_color(m);
    vec3 diffuse = min(material_base_color(m), 1.0 - specular);
    return classical_part(m, classical_choose(diffuse, specular, sum_of(diffuse),
                                              sum_of(specular)));
}

// Adds the base to a highlight with BSDF * wi.z = f and density pdf. `through` is the fraction of
// the base's light that passes the highlight's layer. The densities are not combined by mix(): some
// devices compute cosine + p (pdf - cosine), which loses a small pdf if p is 1.
vec3 classical_sum(classical_parts parts, vec3 wi, vec3 through, vec3 f, inout float pdf)
{
    float cosine = pdf_cosine_hemisphere(wi.z);
    pdf = (1.0 - parts.p_specular) * cosine + parts.p_specular * pdf;
    return f + parts.diffuse * through * cosine;
}

bsdf_sample classical_sample(vec3 wi, vec3 f, float pdf)
{
    bool valid = pdf > 0.0;
    return bsdf_sample(wi, valid ? f / pdf : vec3(0.0), pdf, false, false, valid);
}

// Samples a direction with density (n + 1) / (2 pi) cos^n about z, for Phong's lobe and Blinn's
// normals. w is 1 - z, which is accurate for large n.
vec4 sample_cosine_power(float n, vec2 u)
{
    float below = one_minus_exp(max(0.0, -log(1.0 - u.x) / (n + 1.0)));
    float radius = sqrt(below * (2.0 - below));
    return vec4(radius * cos_sin_turns(u.y), 1.0 - below, below);
}

// --- Phong --------------------------------------------------------------------------------------

vec3 mirrored(vec3 wo)
{
    return vec3(-wo.xy, wo.z);
}

// Evaluates the model of Lafortune and Willems 1994, "Using the Modified Phong Reflectance Model
// for Physically Based Rendering": kd / pi + ks (n + 2) / (2 pi) cos^n of the angle from the mirror
// direction. The cosine is 1 - |difference|^2 / 2.
vec3 eval_phong(material m, vec3 wo, vec3 wi, out float pdf)
{
    pdf = 0.0;
    classical_parts parts = phong_parts(m);
    if (!(wi.z > 0.0))
        return vec3(0.0);
    float n = material_exponent(m);
    vec3 difference = wi - mirrored(wo);
    float lobe = 0.5 * INV_PI * power_one_minus(0.5 * dot(difference, difference), n);
    pdf = (n + 1.0) * lobe;
    return classical_sum(parts, wi, vec3(1.0), parts.specular * ((n + 2.0) * lobe * wi.z), pdf);
}

bsdf_sample sample_phong(material m, vec3 wo, vec4 u)
{
    classical_parts parts = phong_parts(m);
    vec3 wi;
    if (u.z < parts.p_specular)
        wi = normalize(basis_around(mirrored(wo)) *
                       sample_cosine_power(material_exponent(m), u.xy).xyz);
    else
        wi = sample_cosine_hemisphere(u.xy);
    float pdf;
    vec3 f = eval_phong(m, wo, wi, pdf);
    return classical_sample(wi, f, pdf);
}

// --- Blinn-Phong --------------------------------------------------------------------------------

// Returns 1 / (the integral of cos^n(theta / 2) cos(theta) over the hemisphere): with this factor
// the highlight reflects all light at normal incidence (Giesen 2009, "Phong and Blinn-Phong
// Normalization Factors").
float blinn_phong_normalization(float n)
{
    return (n + 2.0) * (n + 4.0) / (8.0 * PI * (exp2(-0.5 * n) + n));
}

// Evaluates kd / pi + ks normalization cos^n, with the cosine of the half vector.
vec3 eval_blinn_phong(material m, vec3 wo, vec3 wi, out float pdf)
{
    pdf = 0.0;
    classical_parts parts = phong_parts(m);
    vec4 h = reflection_half_vector(wo, wi);
    if (!(wi.z > 0.0) || !(h.w > 0.0))
        return vec3(0.0);
    float n = material_exponent(m);
    float lobe = power_one_minus(dot(h.xy, h.xy), 0.5 * n);
    pdf = (n + 1.0) * 0.5 * INV_PI * lobe / (4.0 * h.w);
    return classical_sum(parts, wi, vec3(1.0),
                         parts.specular * (blinn_phong_normalization(n) * lobe * wi.z), pdf);
}

bsdf_sample sample_blinn_phong(material m, vec3 wo, vec4 u)
{
    classical_parts parts = phong_parts(m);
    vec3 wi;
    if (u.z < parts.p_specular) {
        vec3 h = sample_cosine_power(material_exponent(m), u.xy).xyz;
        float cosine = dot(wo, h);
        if (!(cosine > 0.0))
            return bsdf_absorbed();
        wi = normalize(2.0 * cosine * h - wo);
    } else {
        wi = sample_cosine_hemisphere(u.xy);
    }
    float pdf;
    vec3 f = eval_blinn_phong(m, wo, wi, pdf);
    return classical_sample(wi, f, pdf);
}

// --- microfacets --------------------------------------------------------------------------------

uint microfacet_distribution(material m)
{
    return m.model_flags >> MATERIAL_DISTRIBUTION_SHIFT & 3u;
}

vec3 microfacet_fresnel(material m, float cos_theta, float eta)
{
    vec3 color = classical_specular_color(m);
    float cos_t;
    if (material_has(m, MATERIAL_EXACT_FRESNEL))
        return color * fresnel_dielectric(cos_theta, eta, cos_t);
    return fresnel_schlick(color, cos_theta);
}

// Returns whether the base receives the light that the microfacet between both directions does not
// reflect, so that its BSDF is kd (1 - F(wo.h)), as in real-time renderers. This is reciprocal, but
// at grazing angles it reflects light that the highlight has already reflected.
bool is_uncoupled(material m)
{
    return HAS_LOBE(LOBE_UNCOUPLED) && material_has(m, MATERIAL_UNCOUPLED);
}

// The base lies below the microfacets: light enters and leaves it in proportion to what they do not
// reflect. If the base is uncoupled, its albedo is computed for light along the normal; the angle
// between wo and the microfacet's normal is then half of the angle between wo and the surface's
// normal.
classical_parts microfacet_parts(material m, vec3 wo, float eta)
{
    vec3 reflected = microfacet_fresnel(m, wo.z, eta);
    vec3 diffuse = material_base_color(m) * (1.0 - reflected);
    if (is_uncoupled(m)) {
        diffuse = material_base_color(m);
        vec3 middle = microfacet_fresnel(m, sqrt(0.5 + 0.5 * wo.z), eta);
        return classical_part(m, classical_choose(diffuse, reflected,
                                                  sum_of(diffuse * (1.0 - middle)),
                                                  sum_of(reflected)));
    }
    return classical_part(m, classical_choose(diffuse, reflected, sum_of(diffuse),
                                              sum_of(reflected)));
}

float microfacet_d(material m, vec3 h, float alpha)
{
    uint distribution = microfacet_distribution(m);
    if (distribution == DISTRIBUTION_BECKMANN)
        return beckmann_d(h, alpha);
    if (distribution == DISTRIBUTION_PHONG)
        return phong_d(h, alpha);
    return ggx_d(h, vec2(alpha));
}

// Returns G1 of the distribution: exact for GGX and Beckmann, accurate for Phong.
float microfacet_g1(material m, vec3 w, float alpha)
{
    uint distribution = microfacet_distribution(m);
    if (distribution == DISTRIBUTION_GGX)
        return ggx_g1(w, vec2(alpha));
    return 1.0 / (1.0 + (distribution == DISTRIBUTION_PHONG ? phong_lambda(w, alpha)
                                                            : beckmann_lambda(w, alpha)));
}

float microfacet_smith(material m, vec3 wo, vec3 wi, float alpha)
{
    bool separable = is_separable(m);
    uint distribution = microfacet_distribution(m);
    if (distribution == DISTRIBUTION_GGX)
        return ggx_g2(wo, wi, vec2(alpha), separable);
    if (distribution == DISTRIBUTION_PHONG)
        return smith_g2(phong_lambda(wo, alpha), phong_lambda(wi, alpha), separable);
    return smith_g2(beckmann_lambda(wo, alpha), beckmann_lambda(wi, alpha), separable);
}

// Returns the rational function for G1, which is a fit to Beckmann's G1. With other distributions
// it would make more area visible than a surface has, and reflect up to 1.7 times the light; so it
// is limited to the G1 of the distribution.
float microfacet_rational(material m, vec3 w, float alpha)
{
    float g1 = rational_g1(w, alpha);
    bool fits = microfacet_distribution(m) == DISTRIBUTION_BECKMANN;
    return fits ? g1 : min(g1, microfacet_g1(m, w, alpha));
}

// Returns k for the variants of Schlick's masking.
float microfacet_schlick_k(material m, uint masking, float alpha)
{
    const float SQRT_2_OVER_PI = 0.79788456080286535588;
    float remapped = material_roughness(m) + 1.0;
    if (HAS_LOBE(LOBE_MASKINGS) && masking == MASKING_SCHLICK)
        return SQRT_2_OVER_PI * alpha;
    if (HAS_LOBE(LOBE_MASKINGS) && masking == MASKING_SCHLICK_REMAPPED)
        return 0.125 * remapped * remapped;
    return 0.5 * alpha;
}

// Returns G / wo.z; cos_h is the cosine between either direction and the microfacet's normal.
float microfacet_masking(material m, vec3 wo, vec3 wi, float cos_h, float alpha)
{
    uint masking = m.model_flags >> MATERIAL_MASKING_SHIFT & 7u;
    if (masking == MASKING_LH) // Kelemen and Szirmay-Kalos 2001: G / (wo.z wi.z) = 1 / cos_h^2
        return wi.z / (cos_h * cos_h);
    if (masking == MASKING_SCHLICK_GGX ||
        (HAS_LOBE(LOBE_MASKINGS) &&
         (masking == MASKING_SCHLICK || masking == MASKING_SCHLICK_REMAPPED))) {
        float k = microfacet_schlick_k(m, masking, alpha);
        return schlick_g1(wo, k) * schlick_g1(wi, k) / wo.z;
    }
    if (HAS_LOBE(LOBE_MASKINGS) && masking == MASKING_RATIONAL_UNBOUNDED)
        return rational_g1(wo, alpha) * rational_g1(wi, alpha) / wo.z;
    if (masking == MASKING_RATIONAL)
        return microfacet_rational(m, wo, alpha) * microfacet_rational(m, wi, alpha) / wo.z;
    return microfacet_smith(m, wo, wi, alpha) / wo.z;
}

// Visible normals are sampled by GGX whatever the distribution: GGX has the longest tail, so the
// weights are bounded. With NORMALS_NDF, normals are sampled by the material's own D: tan^2 =
// -alpha^2 log(1 - u) for Beckmann, cos = (1 - u)^(1 / (a_p + 2)) for Phong (Walter et al. 2007,
// eqs. 28 and 31).
vec3 sample_microfacet_normal(material m, vec3 wo, float alpha, vec2 u)
{
    uint distribution = microfacet_distribution(m);
    if (NORMALS == NORMALS_NDF && distribution == DISTRIBUTION_BECKMANN) {
        float radius = alpha * sqrt(max(0.0, -log_one_minus(u.x)));
        return normalize(vec3(radius * cos_sin_turns(u.y), 1.0));
    }
    if (NORMALS == NORMALS_NDF && distribution == DISTRIBUTION_PHONG)
        return sample_cosine_power(2.0 / (alpha * alpha) - 1.0, u).xyz;
    return sample_ggx_normal(wo, vec2(alpha), u);
}

// Evaluates the base and the highlight, which is eq. 20 of Walter et al. 2007.
vec3 eval_microfacet(material m, vec3 wo, vec3 wi, float eta, out float pdf)
{
    pdf = 0.0;
    classical_parts parts = microfacet_parts(m, wo, eta);
    if (!(wi.z > 0.0))
        return vec3(0.0);
    vec3 f = vec3(0.0);
    float alpha = dielectric_alpha(m);
    vec4 h = reflection_half_vector(wo, wi);
    bool has_highlight = !is_part(m, MATERIAL_DIFFUSE_PART);
    if (HAS_LOBE(LOBE_ROUGH) && !is_delta(alpha) && h.w > 0.0 && has_highlight) {
        float d = microfacet_d(m, h.xyz, alpha);
        pdf = pdf_ggx_reflection(wo, h.xyz, vec2(alpha));
        if (NORMALS == NORMALS_NDF)
            pdf = 0.25 * d * h.z / h.w;
        f = microfacet_fresnel(m, h.w, eta) *
            (0.25 * d * microfacet_masking(m, wo, wi, h.w, alpha));
    }
    float cos_base = is_uncoupled(m) ? h.w : wi.z;
    return classical_sum(parts, wi, 1.0 - microfacet_fresnel(m, cos_base, eta), f, pdf);
}

bsdf_sample sample_microfacet(material m, vec3 wo, float eta, vec4 u)
{
    classical_parts parts = microfacet_parts(m, wo, eta);
    float alpha = dielectric_alpha(m);
    vec3 wi;
    if (u.z < parts.p_specular) {
        if (is_delta(alpha))
            return bsdf_sample(mirrored(wo), parts.specular / parts.p_specular, 0.0, true, false,
                               true);
        vec3 h = sample_microfacet_normal(m, wo, alpha, u.xy);
        wi = normalize(2.0 * dot(wo, h) * h - wo);
    } else {
        wi = sample_cosine_hemisphere(u.xy);
    }
    float pdf;
    vec3 f = eval_microfacet(m, wo, wi, eta, pdf);
    return classical_sample(wi, f, pdf);
}

#endif
