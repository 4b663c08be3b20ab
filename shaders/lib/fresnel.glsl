// Computes the reflectance of interfaces. All functions are pure.
#ifndef FRESNEL_GLSL
#define FRESNEL_GLSL

#include "lib/angle.glsl"

// Returns the reflectance for unpolarised light of a dielectric with relative index eta = n_t / n_i
// (Born and Wolf 1999, section 1.5.2, eqs. 21), given the cosines of the incident and the refracted
// direction.
//
// With k = eta^2 - 1 and g = eta cos_t, g^2 = k + cos_i^2. Differences of the amplitudes are
// written as products, because subtraction would cancel all digits as eta approaches 1:
//   r_s = (cos_i - g) / (cos_i + g)             = -k / (cos_i + g)^2
//   r_p = (eta^2 cos_i - g) / (eta^2 cos_i + g) = k (cos_i (cos_i + g) - 1) /
//                                                 ((cos_i + g) (eta^2 cos_i + g))
float fresnel_refracted(float cos_i, float cos_t, float eta)
{
    float k = (eta - 1.0) * (eta + 1.0);
    if (k == 0.0)
        return 0.0;
    float g = eta * cos_t;
    float sum = cos_i + g;
    float r_s = k / (sum * sum);
    float r_p = k * (cos_i * sum - 1.0) / (sum * (eta * eta * cos_i + g));
    return min(1.0, 0.5 * (r_s * r_s + r_p * r_p));
}

// Returns the reflectance of a dielectric for 0 <= cos_i <= 1. cos_t >= 0; from the angle of total
// internal reflection on, cos_t is 0 and the reflectance 1.
float fresnel_dielectric(float cos_i, float eta, out float cos_t)
{
    float k = (eta - 1.0) * (eta + 1.0);
    float g2 = k + cos_i * cos_i;
    cos_t = k == 0.0 ? cos_i : sqrt(max(0.0, g2)) / eta;
    return g2 > 0.0 || k == 0.0 ? fresnel_refracted(cos_i, cos_t, eta) : 1.0;
}

// Returns the reflectance at normal incidence.
float fresnel_f0(float eta)
{
    float r = (eta - 1.0) / (eta + 1.0);
    return r * r;
}

// Returns (1 - cos_theta)^5, as in Schlick 1994, eq. 15.
float schlick_weight(float cos_theta)
{
    float m = 1.0 - clamp(cos_theta, 0.0, 1.0);
    float m2 = m * m;
    return m2 * m2 * m;
}

// Returns the approximate reflectance of Schlick 1994, eq. 15.
vec3 fresnel_schlick(vec3 f0, float cos_theta)
{
    return f0 + (1.0 - f0) * schlick_weight(cos_theta);
}

// Returns the reflectance for unpolarised light of a conductor with index eta + i k relative to the
// medium in front (Born and Wolf 1999, section 14.4, eqs. 23 and 24, whose u and v are called a and
// b here):
//   (a + i b)^2 = (eta + i k)^2 - sin^2
//   R_s = ((a - cos)^2 + b^2) / ((a + cos)^2 + b^2)
//   R_p = R_s ((a cos - sin^2)^2 + b^2 cos^2) / ((a cos + sin^2)^2 + b^2 cos^2)
// The smaller of a^2 and b^2 is computed from a b = eta k, not from a difference.
vec3 fresnel_conductor(float cos_theta, vec3 eta, vec3 k)
{
    float c = clamp(cos_theta, 0.0, 1.0);
    float s2 = (1.0 - c) * (1.0 + c);
    vec3 eta_k = eta * k;
    vec3 difference = (eta - k) * (eta + k) - s2; // a^2 - b^2
    vec3 larger = 0.5 * (sqrt(difference * difference + 4.0 * eta_k * eta_k) + abs(difference));
    vec3 smaller = mix(vec3(0.0), eta_k * eta_k / larger, greaterThan(larger, vec3(0.0)));
    bvec3 a_larger = greaterThanEqual(difference, vec3(0.0));
    vec3 a = sqrt(mix(smaller, larger, a_larger));
    vec3 b2 = mix(larger, smaller, a_larger);
    vec3 denominator = (a + c) * (a + c) + b2;
    // The denominator is 0 only for eta = 1 and k = 0 at cos = 0, where there is no interface.
    vec3 r_s = mix(vec3(0.0), ((a - c) * (a - c) + b2) / denominator,
                   greaterThan(denominator, vec3(0.0)));
    vec3 minus = a * c - s2;
    vec3 plus = a * c + s2;
    vec3 r_p = r_s * (minus * minus + b2 * c * c) / (plus * plus + b2 * c * c);
    return min(vec3(1.0), 0.5 * (r_s + r_p));
}

// Returns the reflectance, for unpolarised light, of a film of index n2 and `thickness` (nm) over a
// base of index n3. Both indices are relative to the medium in front (n2 >= 1). It is Airy's sum of
// all reflections (Born and Wolf 1999, section 7.6.1, eqs. 1 to 13) of amplitudes r12 and r23,
//   R = (r12^2 + r23^2 + 2 r12 r23 V cos(phi)) / (1 + r12^2 r23^2 + 2 r12 r23 V cos(phi)),
// phi = 4 pi n2 cos_2 thickness / wavelength, at the dominant wavelengths of Rec. 709's primaries.
// V = exp(-(phi sigma / wavelength)^2 / 2) is the visibility of fringes over a Gaussian band whose
// full width at half maximum is the mean distance of the three wavelengths, 74 nm. Belcour and
// Barla 2017, "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence",
// integrate the series over measured responses; this model keeps 0 <= R <= 1 and costs one cosine.
// With highest = true the fringes have the greatest brightness of all thicknesses.
vec3 fresnel_film(float cos_1, float n2, vec3 n3, float thickness, bool highest)
{
    const vec3 wavelength = vec3(611.4, 549.1, 464.2);
    const float sigma = 73.6 / 2.3548; // full width at half maximum over 2 sqrt(2 ln 2)
    float s2 = (1.0 - cos_1) * (1.0 + cos_1);
    float a2 = sqrt((n2 - 1.0) * (n2 + 1.0) + cos_1 * cos_1); // n2 cos_2
    vec3 a3 = sqrt(max(vec3(0.0), n3 * n3 - s2));
    vec3 turns = 2.0 * thickness * a2 / wavelength;
    vec3 band = 2.0 * PI * turns * sigma / wavelength;
    vec3 cos_phi = vec3(cos_sin_turns(turns.r).x, cos_sin_turns(turns.g).x, cos_sin_turns(turns.b).x);
    vec3 fringe = exp(-0.5 * band * band) * cos_phi;

    vec2 r12 = vec2((cos_1 - a2) / (cos_1 + a2),
                    (n2 * n2 * cos_1 - a2) / (n2 * n2 * cos_1 + a2));
    vec3 r23_s = (a2 - a3) / (a2 + a3);
    vec3 r23_p = (n3 * n3 * a2 - n2 * n2 * a3) / (n3 * n3 * a2 + n2 * n2 * a3);
    vec3 product_s = r12.x * r23_s;
    vec3 product_p = r12.y * r23_p;
    vec3 mixed_s = 2.0 * (highest ? abs(product_s) : product_s * fringe);
    vec3 mixed_p = 2.0 * (highest ? abs(product_p) : product_p * fringe);
    vec3 s = (r12.x * r12.x + r23_s * r23_s + mixed_s) / (1.0 + product_s * product_s + mixed_s);
    vec3 p = (r12.y * r12.y + r23_p * r23_p + mixed_p) / (1.0 + product_p * product_p + mixed_p);
    return clamp(0.5 * (s + p), 0.0, 1.0);
}

// Returns the real index that reflects f0 at normal incidence; for f0 = 1, the greatest index that
// single precision resolves.
vec3 index_of_f0(vec3 f0)
{
    vec3 root = sqrt(min(f0, vec3(0.9999)));
    return (1.0 + root) / (1.0 - root);
}

#endif
