// Evaluates and samples the principled model: Burley 2012 and 2015 with the layers of glTF's
// extensions. Formulas, sources and deviations are in docs/materials.md, whose names the code uses.
// All functions are pure, except that they read the tables of lib/albedo.glsl. See
// lib/bsdf_types.glsl for the frame and the conventions.
#ifndef BSDF_PRINCIPLED_GLSL
#define BSDF_PRINCIPLED_GLSL

#include "lib/principled.glsl"
#include "lib/sampling.glsl"

// --- lobes: each returns BSDF * |wi.z| and its own density ---------------------------------------

vec3 eval_fibres(principled p, vec3 wo, vec3 wi, vec4 h, out precise float pdf)
{
    pdf = 0.5 * INV_PI;
    float a = p.fibre_roughness * p.fibre_roughness;
    float sin2 = dot(h.xy, h.xy);
    precise float d = (2.0 + 1.0 / a) * pow(min(1.0, sin2), 0.5 / a) * (0.5 * INV_PI);
    precise float g = d / (4.0 * (wo.z + wi.z - wo.z * wi.z));
    float largest = max(p.fibre_albedo, albedo_charlie(p.tables, wi.z, p.fibre_roughness));
    return p.fibre_color * (g * wi.z / max(1.0, largest));
}

// Returns D of GTR1 (Burley 2012, eq. 4 and appendix B.2). The form a^2 cos^2 + sin^2 avoids
// cancellation.
float gtr1_d(vec3 h, float a)
{
    float a2 = a * a;
    return INV_PI * (a2 - 1.0) / (log(a2) * (a2 * h.z * h.z + dot(h.xy, h.xy)));
}

vec3 sample_gtr1(float a, vec2 u)
{
    float a2 = a * a;
    float power = pow(a2, 1.0 - u.x);
    float cos2 = (1.0 - power) / (1.0 - a2);
    float sin2 = (power - a2) / (1.0 - a2);
    return vec3(sqrt(max(0.0, sin2)) * cos_sin_turns(u.y), sqrt(max(0.0, cos2)));
}

float eval_coat(principled p, vec3 wo, vec3 wi, vec4 h, out precise float pdf)
{
    float f = p.coat * coat_fresnel(p, h.w);
    if (p.coat_ggx)
        return f * eval_ggx_reflection(wo, wi, h, p.coat_alpha, p.separable, pdf);
    precise float d = gtr1_d(h.xyz, p.coat_alpha);
    pdf = d * h.z / (4.0 * h.w);
    // g is G1(wo) G1(wi) / (4 wo.z), with alpha = 1/4.
    precise float g =
        ggx_g1(wi, vec2(0.25)) / (2.0 * (wo.z + ggx_stretched_length(wo, vec2(0.25))));
    return f * d * g;
}

// Converts a density of visible normals into that of the sampled direction. If shadowed samples are
// tried again, it is proportional to the probability of not being shadowed.
float principled_tried(principled p, float visible, float unshadowed)
{
    return principled_tries_again(p) ? unshadowed * p.tries_scale : visible;
}

vec3 eval_base_reflection(principled p, vec3 wo, vec3 wi, vec4 h, out precise float pdf)
{
    vec3 reflected, through;
    vec2 probabilities;
    float cos_t;
    float exact = fresnel_dielectric(h.w, p.eta, cos_t);
    principled_interface(p, h.w, cos_t, exact, reflected, through, probabilities);
    vec3 h_turned = principled_turn(p, h.xyz, false);
    vec3 wo_turned = principled_turn(p, wo, false);
    vec3 wi_turned = principled_turn(p, wi, false);
    pdf = pdf_ggx_vndf(wo_turned, h_turned, p.alpha) / (4.0 * h.w);
    precise float unshadowed =
        pdf * ggx_g2(wo_turned, wi_turned, p.alpha, p.separable) / ggx_g1(wo_turned, p.alpha);
    pdf = pdf_ggx_drawn(pdf, h_turned, p.alpha, 0.25 / h.w);
    pdf = probabilities.x * principled_tried(p, pdf, unshadowed);
    return reflected * unshadowed;
}

// Returns whether light passes through the base in a single direction, or in directions that single
// precision does not distinguish (as in lib/bsdf_dielectric.glsl).
bool principled_through_is_delta(principled p)
{
    return p.is_delta || p.eta == 1.0 ||
           (!p.thin && min(p.alpha.x, p.alpha.y) * abs(p.eta - 1.0) < SMALLEST_REFRACTED_WIDTH);
}

// Evaluates eqs. 16, 17 and 21 of Walter et al. 2007, for radiance.
vec3 eval_base_refraction(principled p, vec3 wo, vec3 wi, out precise float pdf)
{
    pdf = 0.0;
    vec3 sum = refraction_half_vector(wo, wi, p.eta);
    float length2 = dot(sum, sum);
    if (!(length2 > 0.0))
        return vec3(0.0);
    vec3 h = sum * inversesqrt(length2);
    float cos_o = dot(wo, h);
    float cos_i = -dot(wi, h);
    if (!(cos_o > 0.0 && cos_i > 0.0))
        return vec3(0.0);
    vec3 reflected, through;
    vec2 probabilities;
    // Both cosines are passed, because near total reflection neither can be computed accurately
    // from the other.
    principled_interface(p, cos_o, cos_i, fresnel_refracted(cos_o, cos_i, p.eta), reflected,
                         through, probabilities);
    float jacobian = p.eta * p.eta * cos_i / length2;
    pdf = pdf_ggx_vndf(principled_turn(p, wo, false), principled_turn(p, h, false), p.alpha) *
          jacobian;
    float g1 = ggx_g1(principled_turn(p, wi, false), p.alpha);
    precise vec3 f = through * (pdf * g1 / refraction_divisor(p.eta));
    float drawn = pdf_ggx_drawn(pdf, principled_turn(p, h, false), p.alpha, jacobian);
    pdf = probabilities.y * principled_tried(p, drawn, pdf * g1);
    return f;
}

// Evaluates the thin-walled base's transmission: its reflection, mirrored to the other side.
vec3 eval_base_thin(principled p, vec3 wo, vec3 wi, out precise float pdf)
{
    pdf = 0.0;
    vec3 mirrored = vec3(wi.xy, -wi.z);
    vec4 h = reflection_half_vector(wo, mirrored);
    if (!(h.w > 0.0))
        return vec3(0.0);
    vec3 reflected, through;
    vec2 probabilities;
    float cos_t;
    float exact = fresnel_dielectric(h.w, p.eta, cos_t);
    principled_interface(p, h.w, cos_t, exact, reflected, through, probabilities);
    vec3 wo_turned = principled_turn(p, wo, false);
    vec3 wi_turned = principled_turn(p, mirrored, false);
    vec3 h_turned = principled_turn(p, h.xyz, false);
    pdf = pdf_ggx_vndf(wo_turned, h_turned, p.alpha) / (4.0 * h.w);
    precise float unshadowed =
        pdf * ggx_g2(wo_turned, wi_turned, p.alpha, p.separable) / ggx_g1(wo_turned, p.alpha);
    pdf = pdf_ggx_drawn(pdf, h_turned, p.alpha, 0.25 / h.w);
    pdf = probabilities.y * principled_tried(p, pdf, unshadowed);
    return through * unshadowed;
}

// Evaluates the diffuse lobe without the weights of the layers above and without the factor
// p.below.
vec3 eval_principled_diffuse(principled p, vec3 wo, vec3 wi, vec4 h, out precise float pdf)
{
    pdf = pdf_cosine_hemisphere(wi.z);
    float weight_o = schlick_weight(wo.z);
    float weight_i = schlick_weight(wi.z);
    float f90 = p.roughness * h.w * h.w;
    float a = 2.0 * f90 - 0.5;
    precise float d = 1.0;
    if (HAS_LOBE(LOBE_BURLEY) && !p.is_gltf)
        d = (1.0 + a * weight_o) * (1.0 + a * weight_i);
    if (HAS_LOBE(LOBE_SUBSURFACE)) {
        float f = (1.0 + (f90 - 1.0) * weight_o) * (1.0 + (f90 - 1.0) * weight_i);
        float below = 1.25 * (f * (1.0 / (wo.z + wi.z) - 0.5) + 0.5);
        d += p.subsurface * (below - d);
    }
    if (HAS_LOBE(LOBE_BURLEY) || HAS_LOBE(LOBE_SUBSURFACE))
        d /= max(1.0, max(p.albedo_diffuse, principled_albedo_diffuse(p, wi.z)));
    precise vec3 f = p.base_color * (p.sheen_layer * (1.0 - p.diffuse_transmission) * d * pdf);
    if (HAS_LOBE(LOBE_SHEEN))
        f += p.sheen * (schlick_weight(h.w) * wi.z);
    return f;
}

// --- all lobes -----------------------------------------------------------------------------------

vec3 eval_principled_reflection(principled p, vec3 wo, vec3 wi, out precise float pdf)
{
    pdf = 0.0;
    vec4 h = reflection_half_vector(wo, wi);
    if (!(h.w > 0.0))
        return vec3(0.0);
    float lobe_pdf;
    precise vec3 f = p.base_layer * p.below * eval_principled_diffuse(p, wo, wi, h, lobe_pdf);
    pdf = p.p_diffuse * lobe_pdf;
    if (HAS_LOBE(LOBE_ROUGH) && !p.is_delta) {
        f += p.base_layer * eval_base_reflection(p, wo, wi, h, lobe_pdf);
        pdf += p.p_base * lobe_pdf;
    }
    if (HAS_LOBE(LOBE_CLEARCOAT) && !p.coat_delta) {
        f += p.coat_layer * eval_coat(p, wo, wi, h, lobe_pdf);
        pdf += p.p_coat * lobe_pdf;
    }
    if (HAS_LOBE(LOBE_CHARLIE)) {
        f += p.fibre_layer * eval_fibres(p, wo, wi, h, lobe_pdf);
        pdf += p.p_fibre * lobe_pdf;
    }
    return f;
}

vec3 eval_principled_through(principled p, vec3 wo, vec3 wi, out precise float pdf)
{
    pdf = 0.0;
    float lobe_pdf;
    precise vec3 f = vec3(0.0);
    if (HAS_LOBE(LOBE_DIFFUSE_TRANSMISSION)) {
        lobe_pdf = pdf_cosine_hemisphere(-wi.z);
        f = p.base_layer * p.below * p.base_color *
            (p.sheen_layer * p.diffuse_transmission * lobe_pdf);
        pdf = p.p_through * lobe_pdf;
    }
    if (HAS_LOBE(LOBE_TRANSMISSION) && HAS_LOBE(LOBE_ROUGH) && !principled_through_is_delta(p)) {
        if (p.thin)
            f += p.base_layer * eval_base_thin(p, wo, wi, lobe_pdf);
        else
            f += p.base_layer * eval_base_refraction(p, wo, wi, lobe_pdf);
        pdf += p.p_base * lobe_pdf;
    }
    return f;
}

vec3 eval_prepared(principled p, vec3 wo, vec3 wi, out precise float pdf)
{
    pdf = 0.0;
    if (wi.z > 0.0)
        return eval_principled_reflection(p, wo, wi, pdf);
    if ((HAS_LOBE(LOBE_TRANSMISSION) || HAS_LOBE(LOBE_DIFFUSE_TRANSMISSION)) && wi.z < 0.0)
        return eval_principled_through(p, wo, wi, pdf);
    return vec3(0.0);
}

vec3 eval_principled(material m, vec3 wo, vec3 wi, float eta, out precise float pdf)
{
    return eval_prepared(principled_prepare(m, wo, eta), wo, wi, pdf);
}

// Makes one try to sample the base. The sample is complete if it is a delta; otherwise only wi is
// set. It survives masking by other microfacets if `chance`, uniform in [0, 1), is below
// `unshadowed`.
bsdf_sample try_base(principled p, vec3 wo, vec4 u, out float chance, out precise float unshadowed)
{
    precise bsdf_sample s = bsdf_absorbed();
    chance = 0.0;
    unshadowed = 0.0;
    vec3 h = vec3(0.0, 0.0, 1.0);
    vec3 wo_turned = principled_turn(p, wo, false);
    if (HAS_LOBE(LOBE_ROUGH) && !p.is_delta)
        h = principled_turn(p, sample_ggx_normal(wo_turned, p.alpha, u.xy), true);
    float cos_o = dot(wo, h);
    if (!(cos_o > 0.0))
        return s;
    vec3 reflected, through;
    vec2 probabilities;
    float cos_t;
    float exact = fresnel_dielectric(cos_o, p.eta, cos_t);
    principled_interface(p, cos_o, cos_t, exact, reflected, through, probabilities);
    bool reflects = u.w < probabilities.x;
    float probability = p.p_base * (reflects ? probabilities.x : probabilities.y);
    if (!(probability > 0.0))
        return s;
    s.wi = p.is_delta ? vec3(-wo.xy, wo.z) : normalize(2.0 * cos_o * h - wo);
    s.weight = reflected * (p.base_layer / probability);
    s.specular = p.is_delta;
    s.valid = s.wi.z > 0.0;
    bool tries_again = principled_tries_again(p);
    if (tries_again) {
        chance = (reflects ? u.w : u.w - probabilities.x) /
                 (reflects ? probabilities.x : probabilities.y);
        if (s.valid)
            unshadowed = ggx_g2(wo_turned, principled_turn(p, s.wi, false), p.alpha, false) /
                         ggx_g1(wo_turned, p.alpha);
    }
    if (HAS_LOBE(LOBE_TRANSMISSION) && !reflects) {
        s.weight = through * (p.base_layer / probability);
        s.specular = principled_through_is_delta(p);
        s.transmitted = true;
        if (p.eta == 1.0 || (p.thin && p.is_delta)) {
            s.wi = -wo;
            s.valid = true;
        } else if (p.thin) {
            s.wi.z = -s.wi.z;
        } else {
            s.wi = refract_about(wo, h, p.eta, cos_o, cos_t);
            s.weight /= refraction_divisor(p.eta);
            s.valid = s.wi.z < 0.0;
            precise float g1 = 1.0;
            if (HAS_LOBE(LOBE_ROUGH) && !p.is_delta) {
                g1 = ggx_g1(principled_turn(p, s.wi, false), p.alpha);
                if (NORMALS == NORMALS_NDF)
                    g1 *= ggx_g1(wo_turned, p.alpha) * cos_o / (wo.z * h.z);
            }
            s.weight *= tries_again ? 1.0 / p.tries_scale : g1;
            unshadowed = s.valid ? g1 : 0.0;
        }
    }
    return s;
}

bsdf_sample sample_base(principled p, vec3 wo, vec4 u)
{
    float chance;
    precise float unshadowed;
    precise bsdf_sample s = try_base(p, wo, u, chance, unshadowed);
    if (!principled_tries_again(p))
        return s;
    for (int i = 1; !(chance < unshadowed) && i < MICROFACET_TRIES; i++) {
        u = try_again(u);
        s = try_base(p, wo, u, chance, unshadowed);
    }
    s.valid = s.valid && chance < unshadowed;
    return s;
}

vec3 sample_coat_normal(principled p, vec3 wo, vec2 u)
{
    if (p.coat_ggx)
        return sample_ggx_normal(wo, vec2(p.coat_alpha), u);
    return sample_gtr1(p.coat_alpha, u);
}

bsdf_sample sample_principled(material m, vec3 wo, float eta, vec4 u)
{
    principled p = principled_prepare(m, wo, eta);
    float bound_diffuse = p.p_diffuse;
    float bound_through = bound_diffuse + p.p_through;
    float bound_fibre = bound_through + p.p_fibre;
    float bound_coat = bound_fibre + p.p_coat;

    precise bsdf_sample s = bsdf_absorbed();
    if (u.z >= bound_coat) {
        s = sample_base(p, wo, u);
    } else if (HAS_LOBE(LOBE_CLEARCOAT) && u.z >= bound_fibre) {
        vec3 h = p.coat_delta ? vec3(0.0, 0.0, 1.0) : sample_coat_normal(p, wo, u.xy);
        s.wi = normalize(2.0 * dot(wo, h) * h - wo);
        s.weight = vec3(p.coat_layer * p.coat / p.p_coat * coat_fresnel(p, wo.z));
        s.specular = p.coat_delta;
        s.valid = s.wi.z > 0.0;
    } else if (HAS_LOBE(LOBE_CHARLIE) && u.z >= bound_through) {
        s.wi = sample_hemisphere(u.xy);
        s.valid = true;
    } else {
        s.wi = sample_cosine_hemisphere(u.xy);
        s.valid = s.wi.z > 0.0;
        s.transmitted = u.z >= bound_diffuse;
        s.wi.z = s.transmitted ? -s.wi.z : s.wi.z;
    }
    if (s.valid && !s.specular) {
        vec3 f = eval_prepared(p, wo, s.wi, s.pdf);
        s.valid = s.pdf > 0.0;
        s.weight = s.valid ? f / s.pdf : vec3(0.0);
    }
    return s;
}

#endif
