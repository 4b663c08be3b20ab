// Implements strategies for sampling the next direction of a path that use little or no information
// about the surface, for comparison with BSDF sampling. A sample is weighted by BSDF * |cos| /
// density, and its density is used in MIS weights, so the image converges to the same result with
// every strategy.
//
// - If a material transmits other than as a delta, transmitted light is sampled, too: hemispheres
// are mirrored to the other side with probability 1/2.
// - Delta lobes can only be sampled by the BSDF. Materials that consist of them are sampled that
// way. Materials that also have other lobes use either strategy with probability 1/2, and the
// density is that of the mixture (Veach and Guibas 1995, the one-sample model).
#ifndef DIRECTIONS_GLSL
#define DIRECTIONS_GLSL

#include "lib/bsdf.glsl"
#include "lib/sampling.glsl"

// The power cosine about the mirror direction has little density far from it. This fraction of the
// samples uses the cosine instead, so that weights are bounded (Hesterberg 1995, "Weighted Average
// Importance Sampling and Defensive Mixture Distributions").
const float DEFENSIVE_PART = 0.125;

// Returns whether the material transmits light other than as a delta.
bool transmits(material m)
{
    uint model = material_model(m);
    if (HAS_LOBE(LOBE_DIELECTRIC) && model == MATERIAL_DIELECTRIC)
        return true;
    bool principled_does = HAS_LOBE(LOBE_TRANSMISSION) && material_transmission(m) > 0.0;
    if (HAS_LOBE(LOBE_DIFFUSE_TRANSMISSION))
        principled_does = principled_does || material_diffuse_transmission(m) > 0.0;
    return model == MATERIAL_PRINCIPLED && principled_does;
}

// Returns the probability of sampling the BSDF.
float part_by_bsdf(material m, vec3 wo, float eta)
{
    uint model = material_model(m);
    bool delta = is_delta(dielectric_alpha(m));
    if (HAS_LOBE(LOBE_MIRROR) && model == MATERIAL_MIRROR)
        return 1.0;
    if (HAS_LOBE(LOBE_CONDUCTOR) && model == MATERIAL_CONDUCTOR)
        return delta ? 1.0 : 0.0;
    if (HAS_LOBE(LOBE_DIELECTRIC) && model == MATERIAL_DIELECTRIC) {
        if (delta || is_index_matched(eta))
            return 1.0;
        float width = dielectric_alpha(m) * abs(eta - 1.0);
        return !is_thin(m) && width < SMALLEST_REFRACTED_WIDTH ? 0.5 : 0.0;
    }
    if (HAS_LOBE(LOBE_MICROFACET) && model == MATERIAL_MICROFACET)
        return delta ? 0.5 : 0.0;
    if (HAS_LOBE(LOBE_PRINCIPLED) && model == MATERIAL_PRINCIPLED) {
        principled p = principled_prepare(m, wo, eta);
        bool through = HAS_LOBE(LOBE_TRANSMISSION) && p.transmission > 0.0 &&
                       principled_through_is_delta(p);
        return p.is_delta || (p.coat_delta && p.p_coat > 0.0) || through ? 0.5 : 0.0;
    }
    return 0.0;
}

// Returns the density per solid angle. Below the surface the density of the lobe need not be 0.
float pdf_one_side(vec3 wo, vec3 wi)
{
    float cosine = pdf_cosine_hemisphere(max(wi.z, 0.0));
    if (DIRECTIONS == DIRECTIONS_HEMISPHERE)
        return wi.z > 0.0 ? 0.5 * INV_PI : 0.0;
    if (DIRECTIONS == DIRECTIONS_COSINE)
        return cosine;
    vec3 difference = wi - mirrored(wo);
    float n = frame.direction_exponent;
    float lobe = (n + 1.0) * 0.5 * INV_PI *
                 power_one_minus(0.5 * dot(difference, difference), n);
    return mix(lobe, cosine, DEFENSIVE_PART);
}

float pdf_direction(bool through, vec3 wo, vec3 wi)
{
    if (DIRECTIONS == DIRECTIONS_SPHERE)
        return 0.25 * INV_PI;
    float pdf = pdf_one_side(wo, wi);
    return through ? 0.5 * (pdf + pdf_one_side(wo, vec3(wi.xy, -wi.z))) : pdf;
}

// Samples a direction. u: x and y select the direction, z the side, w the lobe or the cosine.
vec3 sample_direction(bool through, vec3 wo, vec4 u)
{
    if (DIRECTIONS == DIRECTIONS_SPHERE)
        return sample_sphere(u.xy);
    vec3 wi;
    if (DIRECTIONS == DIRECTIONS_HEMISPHERE)
        wi = sample_hemisphere(u.xy);
    else if (DIRECTIONS == DIRECTIONS_COSINE || u.w < DEFENSIVE_PART)
        wi = sample_cosine_hemisphere(u.xy);
    else
        wi = normalize(basis_around(mirrored(wo)) *
                       sample_cosine_power(frame.direction_exponent, u.xy).xyz);
    if (through && u.z < 0.5)
        wi.z = -wi.z;
    return wi;
}

// Returns the density with which a path continues in direction wi, given the density of BSDF
// sampling.
float pdf_onwards(material m, vec3 wo, vec3 wi, float eta, float bsdf_pdf)
{
    if (DIRECTIONS == DIRECTIONS_BSDF)
        return bsdf_pdf;
    return mix(pdf_direction(transmits(m), wo, wi), bsdf_pdf, part_by_bsdf(m, wo, eta));
}

// Replaces sample_bsdf(). u_part selects between BSDF sampling and the other strategy.
bsdf_sample sample_onwards(material m, vec3 wo, float eta, vec4 u, float u_part)
{
    float part = part_by_bsdf(m, wo, eta);
    bsdf_sample s = bsdf_absorbed();
    if (u_part < part) {
        s = sample_bsdf(m, wo, eta, u);
        s.weight /= part;
        if (s.specular || !s.valid)
            return s;
    } else {
        s.wi = sample_direction(transmits(m), wo, u);
        s.transmitted = s.wi.z < 0.0;
    }
    vec3 f = eval_bsdf(m, wo, s.wi, eta, s.pdf);
    s.pdf = pdf_onwards(m, wo, s.wi, eta, s.pdf);
    s.valid = s.pdf > 0.0;
    s.weight = s.valid ? f / s.pdf : vec3(0.0);
    return s;
}

#endif
