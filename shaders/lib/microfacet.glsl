// Microfacets of the GGX distribution (Trowbridge and Reitz 1975; Walter et al. 2007), anisotropic
// after Burley 2012, appendix B.2, with Smith's masking (Heitz 2014). Pure functions.
//
// Directions are unit vectors of the local frame, z along the macroscopic normal; h is a
// microfacet's normal, h.z >= 0. alpha = (alpha_x, alpha_y) from 1e-4 on: below, single precision
// does not resolve the highlight, and callers take a perfect reflection instead.
#ifndef MICROFACET_GLSL
#define MICROFACET_GLSL

#include "lib/angle.glsl"
#include "lib/constants.glsl"

const float SMALLEST_ALPHA = 1e-4;

// Density of normals, per solid angle and projected area:
//   D = 1 / (pi alpha_x alpha_y t^2), t = (h.x / alpha_x)^2 + (h.y / alpha_y)^2 + h.z^2
// (Burley 2012, eq. 13). Small sines come from h.x and h.y, never from 1 - h.z^2.
float ggx_d(vec3 h, vec2 alpha)
{
    vec2 slope = h.xy / alpha;
    float t = dot(slope, slope) + h.z * h.z;
    return INV_PI / (alpha.x * alpha.y * t * t);
}

// sqrt((alpha_x w.x)^2 + (alpha_y w.y)^2 + w.z^2): |w.z| (1 + 2 Lambda).
float ggx_stretched_length(vec3 w, vec2 alpha)
{
    return length(vec3(alpha * w.xy, w.z));
}

// Smith's Lambda (Heitz 2014, eqs. 72 and 86), (sqrt(1 + t) - 1) / 2 without the difference;
// infinite at w.z = 0.
float ggx_lambda(vec3 w, vec2 alpha)
{
    vec2 tangential = alpha * w.xy;
    float cos_theta = abs(w.z);
    return 0.5 * dot(tangential, tangential) /
           (cos_theta * (cos_theta + ggx_stretched_length(w, alpha)));
}

// Masking of one direction, 1 / (1 + Lambda); 0 at w.z = 0.
float ggx_g1(vec3 w, vec2 alpha)
{
    float cos_theta = abs(w.z);
    return 2.0 * cos_theta / (cos_theta + ggx_stretched_length(w, alpha));
}

// Masking and shadowing. On the same side: height-correlated, 1 / (1 + Lambda_o + Lambda_i) (Heitz
// 2014, eq. 99), or separable, G1 G1. On opposite sides always separable, as in Walter et al. 2007,
// eq. 23: what is high for one direction is low for the other. Not both of wo.z and wi.z may be 0.
float ggx_g2(vec3 wo, vec3 wi, vec2 alpha, bool separable)
{
    float cos_o = abs(wo.z);
    float cos_i = abs(wi.z);
    float length_o = ggx_stretched_length(wo, alpha);
    float length_i = ggx_stretched_length(wi, alpha);
    if (separable || wo.z * wi.z < 0.0)
        return 4.0 * cos_o * cos_i / ((cos_o + length_o) * (cos_i + length_i));
    return 2.0 * cos_o * cos_i / (cos_o * length_i + cos_i * length_o);
}

// A normal seen from wo, wo.z >= 0, with pdf_ggx_vndf(): reflecting the stretched wo about normals
// of a hemisphere gives a uniform spherical cap (Dupuy and Benyoub 2023, listing 3). u.x in [0, 1)
// chooses the height in the cap, u.y the azimuth. The cap's point c is never formed: of 1 - c.z and
// 1 + c.z, and of h.z = c.z + k, none is a difference.
vec3 sample_ggx_vndf(vec3 wo, vec2 alpha, vec2 u)
{
    vec3 stretched = normalize(vec3(alpha * wo.xy, wo.z));
    float k = stretched.z;
    float below = dot(stretched.xy, stretched.xy) / (1.0 + k); // 1 - k
    float height = (1.0 - u.x) * (1.0 + k);                    // c.z + k
    float sin_theta = sqrt(u.x * (1.0 + k) * (height + below));
    vec2 tangential = sin_theta * cos_sin_turns(u.y) + stretched.xy;
    return normalize(vec3(alpha * tangential, height));
}

// Per solid angle of h: G1(wo) max(0, wo.h) D(h) / wo.z (Heitz 2018, eq. 3). Of the reflected
// direction it is this over 4 wo.h.
float pdf_ggx_vndf(vec3 wo, vec3 h, vec2 alpha)
{
    return 2.0 * max(0.0, dot(wo, h)) * ggx_d(h, alpha) /
           (abs(wo.z) + ggx_stretched_length(wo, alpha));
}

// A normal of the density D(h) h.z itself, whatever wo sees of it: tan^2 = alpha^2 u / (1 - u)
// (Walter et al. 2007, eqs. 35 and 36), stretched.
vec3 sample_ggx_ndf(vec2 alpha, vec2 u)
{
    float radius = sqrt(u.x / (1.0 - u.x));
    return normalize(vec3(alpha * radius * cos_sin_turns(u.y), 1.0));
}

// The setting `normals` chooses between both: a normal, and its density per solid angle of h.
vec3 sample_ggx_normal(vec3 wo, vec2 alpha, vec2 u)
{
    if (NORMALS == NORMALS_NDF)
        return sample_ggx_ndf(alpha, u);
    return sample_ggx_vndf(wo, alpha, u);
}

// The density with which a normal is drawn, for `visible`, that of visible normals, at hand; both
// are over the same measure, of which a normal's solid angle has the part `scale`.
float pdf_ggx_drawn(float visible, vec3 h, vec2 alpha, float scale)
{
    return NORMALS == NORMALS_NDF ? ggx_d(h, alpha) * h.z * scale : visible;
}

// The weight f / density of a sample of a drawn normal, without its reflectance: G2 / G1(wo) where
// normals are drawn from the visible ones, G2 wo.h / (wo.z h.z) where they are drawn from all.
float ggx_drawn_weight(vec3 wo, vec3 wi, vec3 h, vec2 alpha, bool separable)
{
    float g2 = ggx_g2(wo, wi, alpha, separable);
    if (NORMALS == NORMALS_NDF)
        return g2 * dot(wo, h) / (wo.z * h.z);
    return g2 / ggx_g1(wo, alpha);
}

// Density of reflecting about a visible normal, per solid angle of the reflected direction:
// pdf_ggx_vndf() / (4 wo.h), in which wo.h cancels.
float pdf_ggx_reflection(vec3 wo, vec3 h, vec2 alpha)
{
    return 0.5 * ggx_d(h, alpha) / (abs(wo.z) + ggx_stretched_length(wo, alpha));
}

// Directions are rounded, so that their lengths are not quite 1. Where they nearly cancel that
// turns their sum, by more than a narrow highlight's width when wo.z is small. Both half-vectors
// are freed of it to first order by what is known of unit vectors: (a + b).(a - b) = |a|^2 - |b|^2.

// The normal between two directions on the same side, and in .w its cosine with either of them,
// which is half of the length of their sum. 0 where they are opposite to single precision.
vec4 reflection_half_vector(vec3 wo, vec3 wi)
{
    vec3 sum = wo + wi;
    vec3 difference = wo - wi;
    // sum^2 + difference^2 = 4: a small difference means that nothing cancels.
    sum -= difference * (dot(sum, difference) / max(1.0, dot(difference, difference)));
    float length2 = dot(sum, sum);
    if (!(length2 > 0.0))
        return vec4(0.0);
    float l = sqrt(length2);
    return vec4(sum / l, 0.5 * l);
}

// The microfacet's normal that refracts wo into wi on the other side, h.z > 0, times the length of
// wo + eta wi (Walter et al. 2007, eq. 16). The near-cancelling part is subtracted first, where
// that is exact, so that eta may be close to 1.
vec3 refraction_half_vector(vec3 wo, vec3 wi, float eta)
{
    vec3 h = (wo + wi) + (eta - 1.0) * wi;
    vec3 difference = (wo - wi) - (eta - 1.0) * wi;
    float excess = dot(h, difference) + (eta - 1.0) * (eta + 1.0);
    h -= difference * (excess / max(1.0, dot(difference, difference)));
    return h.z < 0.0 ? -h : h;
}

// wo refracted about h, for cos_i = wo.h and cos_t of fresnel_dielectric().
vec3 refract_about(vec3 wo, vec3 h, float eta, float cos_i, float cos_t)
{
    return normalize((cos_i / eta - cos_t) * h - wo / eta);
}

#endif
