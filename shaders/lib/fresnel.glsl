// How much an interface reflects. Pure functions.
#ifndef FRESNEL_GLSL
#define FRESNEL_GLSL

// Reflectance of unpolarised light at a dielectric of relative index eta = n_t / n_i (Born and Wolf
// 1999, section 1.5.2, eqs. 21), for 0 <= cos_i <= 1. cos_t >= 0 is the cosine of refraction; it is
// 0, and the reflectance 1, from the angle of total internal reflection on.
//
// With k = eta^2 - 1 and g = eta cos_t, g^2 = k + cos_i^2, and the amplitudes' differences are
// written as products, since subtracting loses everything as eta approaches 1:
//   r_s = (cos_i - g) / (cos_i + g)             = -k / (cos_i + g)^2
//   r_p = (eta^2 cos_i - g) / (eta^2 cos_i + g) = k (cos_i (cos_i + g) - 1) /
//                                                 ((cos_i + g) (eta^2 cos_i + g))
float fresnel_dielectric(float cos_i, float eta, out float cos_t)
{
    float k = (eta - 1.0) * (eta + 1.0);
    float g2 = k + cos_i * cos_i;
    cos_t = 0.0;
    if (k == 0.0) {
        cos_t = cos_i;
        return 0.0;
    }
    if (g2 <= 0.0)
        return 1.0;
    float g = sqrt(g2);
    float sum = cos_i + g;
    cos_t = g / eta;
    float r_s = k / (sum * sum);
    float r_p = k * (cos_i * sum - 1.0) / (sum * (eta * eta * cos_i + g));
    return min(1.0, 0.5 * (r_s * r_s + r_p * r_p));
}

// Reflectance at normal incidence.
float fresnel_f0(float eta)
{
    float r = (eta - 1.0) / (eta + 1.0);
    return r * r;
}

// (1 - cos_theta)^5 of Schlick 1994, eq. 15.
float schlick_weight(float cos_theta)
{
    float m = 1.0 - clamp(cos_theta, 0.0, 1.0);
    float m2 = m * m;
    return m2 * m2 * m;
}

// Schlick 1994, eq. 15.
vec3 fresnel_schlick(vec3 f0, float cos_theta)
{
    return f0 + (1.0 - f0) * schlick_weight(cos_theta);
}

// Reflectance of unpolarised light at a conductor of index eta + i k relative to the medium in front
// (Born and Wolf 1999, section 14.4, with u and v there called a and b here: eqs. 23 and 24):
//   (a + i b)^2 = (eta + i k)^2 - sin^2
//   R_s = ((a - cos)^2 + b^2) / ((a + cos)^2 + b^2)
//   R_p = R_s ((a cos - sin^2)^2 + b^2 cos^2) / ((a cos + sin^2)^2 + b^2 cos^2)
// The smaller of a^2 and b^2 comes from a b = eta k rather than from a difference.
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
    // Zero only where nothing is there, eta = 1 and k = 0, seen at cos = 0.
    vec3 r_s = mix(vec3(0.0), ((a - c) * (a - c) + b2) / denominator,
                   greaterThan(denominator, vec3(0.0)));
    vec3 minus = a * c - s2;
    vec3 plus = a * c + s2;
    vec3 r_p = r_s * (minus * minus + b2 * c * c) / (plus * plus + b2 * c * c);
    return min(vec3(1.0), 0.5 * (r_s + r_p));
}

#endif
