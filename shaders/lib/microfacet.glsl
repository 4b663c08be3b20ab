// Evaluates and samples microfacets of the GGX distribution (Trowbridge and Reitz 1975; Walter et
// al. 2007), anisotropic after Burley 2012, appendix B.2, with Smith's masking (Heitz 2014). All
// functions are pure.
//
// Directions are unit vectors of the local frame, z along the macroscopic normal; h is a
// microfacet's normal, h.z >= 0. Both components of alpha = (alpha_x, alpha_y) are at least 1e-4.
// Below that, single precision does not resolve the highlight, and callers use a perfect reflection
// instead.
#ifndef MICROFACET_GLSL
#define MICROFACET_GLSL

#include "lib/angle.glsl"
#include "lib/constants.glsl"

const float SMALLEST_ALPHA = 1e-4;

// Returns the density of normals, per solid angle and unit of macroscopic area:
//   D = 1 / (pi alpha_x alpha_y t^2), t = (h.x / alpha_x)^2 + (h.y / alpha_y)^2 + h.z^2
// (Burley 2012, eq. 13). Small sines are computed from h.x and h.y, not from 1 - h.z^2.
float ggx_d(vec3 h, vec2 alpha)
{
    vec2 slope = h.xy / alpha;
    float t = dot(slope, slope) + h.z * h.z;
    return INV_PI / (alpha.x * alpha.y * t * t);
}

// Returns sqrt((alpha_x w.x)^2 + (alpha_y w.y)^2 + w.z^2), which is |w.z| (1 + 2 Lambda).
float ggx_stretched_length(vec3 w, vec2 alpha)
{
    return length(vec3(alpha * w.xy, w.z));
}

// Returns Smith's Lambda (Heitz 2014, eqs. 72 and 86): (sqrt(1 + t) - 1) / 2, computed without
// cancellation; infinite at w.z = 0.
float ggx_lambda(vec3 w, vec2 alpha)
{
    vec2 tangential = alpha * w.xy;
    float cos_theta = abs(w.z);
    return 0.5 * dot(tangential, tangential) /
           (cos_theta * (cos_theta + ggx_stretched_length(w, alpha)));
}

// Returns the masking of one direction, 1 / (1 + Lambda), which is 0 at w.z = 0.
float ggx_g1(vec3 w, vec2 alpha)
{
    float cos_theta = abs(w.z);
    return 2.0 * cos_theta / (cos_theta + ggx_stretched_length(w, alpha));
}

// Returns the masking and shadowing of two directions. On the same side they are height-correlated,
// 1 / (1 + Lambda_o + Lambda_i) (Heitz 2014, eq. 99), or separable, G1 G1. On opposite sides they
// are always separable, as in Walter et al. 2007, eq. 23, because points that are high for one
// direction are low for the other. wo.z and wi.z must not both be 0.
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

// Samples a normal visible from wo, wo.z >= 0, with density pdf_ggx_vndf(). Reflecting the
// stretched wo about the normals of a hemisphere gives directions that are uniform in a spherical
// cap (Dupuy and Benyoub 2023, listing 3). u.x in [0, 1) selects the height in the cap, u.y the
// azimuth. The point c of the cap is not computed, because 1 - c.z, 1 + c.z and h.z = c.z + k can
// be computed without differences.
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

// Returns the density per solid angle of h: G1(wo) max(0, wo.h) D(h) / wo.z (Heitz 2018, eq. 3).
// The density of the reflected direction is this divided by 4 wo.h.
float pdf_ggx_vndf(vec3 wo, vec3 h, vec2 alpha)
{
    return 2.0 * max(0.0, dot(wo, h)) * ggx_d(h, alpha) /
           (abs(wo.z) + ggx_stretched_length(wo, alpha));
}

// Samples a normal with density D(h) h.z, independently of wo: tan^2 = alpha^2 u / (1 - u) (Walter
// et al. 2007, eqs. 35 and 36), then stretched.
vec3 sample_ggx_ndf(vec2 alpha, vec2 u)
{
    float radius = sqrt(u.x / (1.0 - u.x));
    return normalize(vec3(alpha * radius * cos_sin_turns(u.y), 1.0));
}

// Samples a normal by the strategy of the setting `normals`. pdf_ggx_drawn() returns its density.
vec3 sample_ggx_normal(vec3 wo, vec2 alpha, vec2 u)
{
    if (NORMALS == NORMALS_NDF)
        return sample_ggx_ndf(alpha, u);
    return sample_ggx_vndf(wo, alpha, u);
}

// Returns the density of a normal sampled by sample_ggx_normal(). `visible` is the result if
// visible normals are sampled. scale: converts a density per solid angle of h into the measure of
// the result.
float pdf_ggx_drawn(float visible, vec3 h, vec2 alpha, float scale)
{
    return NORMALS == NORMALS_NDF ? ggx_d(h, alpha) * h.z * scale : visible;
}

// Returns the weight f / density of a sample, without reflectance: G2 / G1(wo) if visible normals
// are sampled, G2 wo.h / (wo.z h.z) if all normals are.
float ggx_drawn_weight(vec3 wo, vec3 wi, vec3 h, vec2 alpha, bool separable)
{
    float g2 = ggx_g2(wo, wi, alpha, separable);
    if (NORMALS == NORMALS_NDF)
        return g2 * dot(wo, h) / (wo.z * h.z);
    return g2 / ggx_g1(wo, alpha);
}

// Returns the density of reflecting about a visible normal, per solid angle of the reflected
// direction: pdf_ggx_vndf() / (4 wo.h), in which wo.h cancels.
float pdf_ggx_reflection(vec3 wo, vec3 h, vec2 alpha)
{
    return 0.5 * ggx_d(h, alpha) / (abs(wo.z) + ggx_stretched_length(wo, alpha));
}

// The lengths of rounded directions differ from 1. If two directions nearly cancel, this changes
// the direction of their sum, by more than the width of a narrow highlight if wo.z is small. Both
// half vectors below are corrected to first order by an identity of unit vectors: (a + b).(a - b) =
// |a|^2 - |b|^2 = 0.

// Returns the normal halfway between two directions on the same side, and in w its cosine with
// either of them, half the length of their sum. The result is 0 if they are opposite in single
// precision.
vec4 reflection_half_vector(vec3 wo, vec3 wi)
{
    vec3 sum = wo + wi;
    vec3 difference = wo - wi;
    // sum^2 + difference^2 = 4, so if the difference is small, the sum does not cancel.
    sum -= difference * (dot(sum, difference) / max(1.0, dot(difference, difference)));
    float length2 = dot(sum, sum);
    if (!(length2 > 0.0))
        return vec4(0.0);
    float l = sqrt(length2);
    return vec4(sum / l, 0.5 * l);
}

// Returns the microfacet normal that refracts wo to wi on the other side, h.z > 0, multiplied by
// the length of wo + eta wi (Walter et al. 2007, eq. 16). The part that nearly cancels is
// subtracted first, where the subtraction is exact, so eta may be close to 1.
vec3 refraction_half_vector(vec3 wo, vec3 wi, float eta)
{
    vec3 h = (wo + wi) + (eta - 1.0) * wi;
    vec3 difference = (wo - wi) - (eta - 1.0) * wi;
    float excess = dot(h, difference) + (eta - 1.0) * (eta + 1.0);
    h -= difference * (excess / max(1.0, dot(difference, difference)));
    return h.z < 0.0 ? -h : h;
}

// Refracts wo about h; cos_i is wo.h, and cos_t comes from fresnel_dielectric().
vec3 refract_about(vec3 wo, vec3 h, float eta, float cos_i, float cos_t)
{
    return normalize((cos_i / eta - cos_t) * h - wo / eta);
}

#endif
