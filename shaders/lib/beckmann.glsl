// Evaluates microfacet distributions other than GGX, namely Beckmann's and Phong's, with their
// masking functions and those that may replace Smith's. All functions are pure.
//
// Directions are unit vectors of the local frame, z along the macroscopic normal, on its side; h is
// a microfacet's normal. alpha is at least 1e-4. Walter et al. 2007 is "Microfacet Models for
// Refraction through Rough Surfaces".
#ifndef BECKMANN_GLSL
#define BECKMANN_GLSL

#include "lib/constants.glsl"

// Returns log(1 - x) for 0 <= x < 1. Vulkan's log() has errors of 2^-21 near 1, so below x = 1/4
// four terms of the series of -2 atanh(x / (2 - x)) are used. The fifth is less than 2^-24 of the
// sum.
float log_one_minus(float x)
{
    float z = x / (2.0 - x);
    float z2 = z * z;
    float series = -2.0 * z * (1.0 + z2 * (1.0 / 3.0 + z2 * (1.0 / 5.0 + z2 * (1.0 / 7.0))));
    return x < 0.25 ? series : log(1.0 - x);
}

// Returns 1 - exp(-x) for x >= 0. Below x = 1/4 six terms of the series are used. The seventh is
// less than 2^-24 of the sum.
float one_minus_exp(float x)
{
    float series =
        x * (1.0 - x / 2.0 *
                       (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0)))));
    return x < 0.25 ? series : 1.0 - exp(-x);
}

// Returns (1 - x)^n without the rounding of 1 - x, which a large n would amplify; 0 for x >= 1.
float power_one_minus(float x, float n)
{
    return x < 1.0 ? exp(n * log_one_minus(max(x, 0.0))) : 0.0;
}

// Returns D of Beckmann's distribution (Walter et al. 2007, eq. 25).
float beckmann_d(vec3 h, float alpha)
{
    float cos2 = h.z * h.z;
    float exponent = dot(h.xy, h.xy) / (cos2 * alpha * alpha);
    // For larger exponents exp() underflows in single precision, and cos^4 may, too.
    if (!(exponent < 87.0))
        return 0.0;
    return exp(-exponent) * INV_PI / (alpha * alpha * cos2 * cos2);
}

// Returns D of Phong's distribution, (a_p + 2) / (2 pi) cos^a_p (Walter et al. 2007, eq. 30). With
// a_p = 2 / alpha^2 - 2 the highlight is as wide as that of Beckmann's distribution (section 5.2).
float phong_d(vec3 h, float alpha)
{
    float inverse = 1.0 / (alpha * alpha); // a_p / 2 + 1
    return inverse * INV_PI * power_one_minus(dot(h.xy, h.xy), inverse - 1.0);
}

// Returns erf(x) for x >= 0, within 1.5e-7 (Abramowitz and Stegun 1964, eq. 7.1.26).
float error_function(float x)
{
    float t = 1.0 / (1.0 + 0.3275911 * x);
    float sum =
        t * (0.254829592 +
             t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))));
    return 1.0 - sum * exp(-x * x);
}

// Returns Smith's Lambda of Beckmann's distribution (Heitz 2014, eq. 66), with a = 1 / (alpha
// tan(theta)). It is computed without a division by the sine. For a >= 4, Lambda is less than 2^-24
// (its asymptote is exp(-a^2) / (4 sqrt(pi) a^3)).
float beckmann_lambda(vec3 w, float alpha)
{
    float slope = alpha * length(w.xy);
    if (!(w.z < 4.0 * slope))
        return 0.0;
    float a = w.z / slope;
    const float INV_SQRT_PI = 0.56418958354775628695;
    return max(0.0, 0.5 * (error_function(a) - 1.0 + INV_SQRT_PI * exp(-a * a) / a));
}

// Returns Smith's Lambda of Phong's distribution (Smith 1967, "Geometrical Shadowing of a Random
// Rough Surface"): the integral of (m / cot(theta) - 1) P(m) over the slopes m beyond cot(theta).
// The slopes have Student's t-distribution with 2 k = 2 / alpha^2 degrees of freedom, so that
//   Lambda = c s^k / ((2 k - 1) x) - 1/2 + P_k,  P_k = c integral of (1 - y^2)^(k-1) over 0 ... x,
//   x = cos(theta), s = 1 - x^2, c_k = Gamma(k + 1/2) / (sqrt(pi) Gamma(k)).
// P_(k+3) is computed by Wallace's approximation of Student's distribution by the normal
// distribution (1959, "Bounds on Normal Approximations to Student's and the Chi-Square
// Distributions"), which is within 2e-4 there, followed by three steps of P_k = P_(k+1) - c_k x s^k
// / (2 k) (integration by parts). c_(k+3) is computed by the asymptotic series of its square,
// within 1e-5.
float phong_lambda(vec3 w, float alpha)
{
    float x = w.z;
    float s = dot(w.xy, w.xy);
    if (!(s > ROUNDING)) // Lambda < s
        return 0.0;
    float k = 1.0 / (alpha * alpha);
    float k3 = k + 3.0;
    float c3 = sqrt((k3 - 0.25 + (0.03125 + 0.0078125 / k3) / k3) * INV_PI);
    float c2 = c3 * (k + 2.0) / (k + 2.5);
    float c1 = c2 * (k + 1.0) / (k + 1.5);
    float c = c1 * k / (k + 0.5);
    float root = sqrt(-k3 * log_one_minus(min(x * x, 1.0 - ROUNDING)));
    float p = 0.5 * error_function((16.0 * k3 + 1.0) / (16.0 * k3 + 3.0) * root);
    float steps = c / k + s * (c1 / (k + 1.0) + s * c2 / (k + 2.0));
    float power = power_one_minus(x * x, k);
    return max(0.0, c * power / ((2.0 * k - 1.0) * x) - 0.5 * x * power * steps + (p - 0.5));
}

// Returns masking and shadowing of two directions on the same side from their Lambdas:
// height-correlated (Heitz 2014, eq. 99), or separable.
float smith_g2(float lambda_o, float lambda_i, bool separable)
{
    return separable ? 1.0 / ((1.0 + lambda_o) * (1.0 + lambda_i))
                     : 1.0 / (1.0 + lambda_o + lambda_i);
}

// Returns the rational fit to Beckmann's G1 (Walter et al. 2007, eq. 27).
float rational_g1(vec3 w, float alpha)
{
    float slope = alpha * length(w.xy);
    if (!(w.z < 1.6 * slope))
        return 1.0;
    float a = w.z / slope;
    return a * (3.535 + 2.181 * a) / (1.0 + a * (2.276 + 2.577 * a));
}

// Returns the G1 of Schlick 1994, "An Inexpensive BRDF Model for Physically-based Rendering", eq.
// 19. His own k = sqrt(2 / pi) alpha fits Smith's function for Beckmann's distribution. Karis 2013,
// "Real Shading in Unreal Engine 4", uses k = alpha / 2, which equals the G1 of GGX at grazing
// incidence, and (roughness + 1)^2 / 8 for delta lights. With alpha = roughness^2 none of the three
// is below alpha / 2, so this G1 never exceeds that of GGX.
float schlick_g1(vec3 w, float k)
{
    return w.z / (w.z * (1.0 - k) + k);
}

#endif
