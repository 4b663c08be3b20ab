#include "bsdf_optics.h"

#include <complex.h>
#include <math.h>

double optics_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double optics_alpha(float roughness)
{
    float alpha = roughness * roughness;
    return (double)alpha;
}

void optics_normalize(double v[3])
{
    double length = sqrt(optics_dot(v, v));
    for (int c = 0; c < 3; c++)
        v[c] /= length;
}

// --- Fresnel -------------------------------------------------------------------------------------

double optics_cos_refracted(double cosine, double eta)
{
    double square = 1 - (1 - cosine * cosine) / (eta * eta);
    return square > 0 ? sqrt(square) : 0;
}

// Born and Wolf 1999, section 1.5.2, eq. 21, with Snell's law.
double optics_fresnel(double cosine, double eta)
{
    double beyond = optics_cos_refracted(cosine, eta);
    if (beyond == 0)
        return 1;
    double s = (cosine - eta * beyond) / (cosine + eta * beyond);
    double p = (eta * cosine - beyond) / (eta * cosine + beyond);
    return 0.5 * (s * s + p * p);
}

// The same with a complex index of refraction (section 14.2).
double optics_fresnel_conductor(double cosine, double eta, double k)
{
    double complex square = (eta + I * k) * (eta + I * k);
    double complex beyond = csqrt(square - (1 - cosine * cosine));
    double s = cabs((cosine - beyond) / (cosine + beyond));
    double p = cabs((square * cosine - beyond) / (square * cosine + beyond));
    return 0.5 * (s * s + p * p);
}

// Schlick 1994, eq. 15.
double optics_schlick(double f0, double cosine)
{
    return f0 + (1 - f0) * pow(1 - fmin(cosine, 1), 5);
}

// Uses the midpoint rule in x, with c = c0 + (1 - c0) x^2, which removes the square root at the
// critical angle.
double optics_mean_fresnel(double eta)
{
    double critical = eta < 1 ? sqrt(1 - eta * eta) : 0, sum = critical * critical;
    enum { STEPS = 100000 };
    for (int i = 0; i < STEPS; i++) {
        double x = (i + 0.5) / STEPS, c = critical + (1 - critical) * x * x;
        sum += 2 * optics_fresnel(c, eta) * c * (1 - critical) * 2 * x / STEPS;
    }
    return sum;
}

// --- GGX -----------------------------------------------------------------------------------------

// Walter et al. 2007, eq. 33; anisotropic after Burley 2012, eq. 13.
double ggx_density(const double h[3], const double alpha[2])
{
    double x = h[0] / alpha[0], y = h[1] / alpha[1], sum = x * x + y * y + h[2] * h[2];
    return h[2] > 0 ? 1 / (M_PI * alpha[0] * alpha[1] * sum * sum) : 0;
}

// Heitz 2014, eqs. 72 and 85.
double ggx_lambda(const double w[3], const double alpha[2])
{
    double x = alpha[0] * w[0], y = alpha[1] * w[1];
    return 0.5 * (sqrt(1 + (x * x + y * y) / (w[2] * w[2])) - 1);
}

double ggx_masking(const double w[3], const double alpha[2])
{
    return w[2] == 0 ? 0 : 1 / (1 + ggx_lambda(w, alpha));
}

double ggx_masking_both(const double wo[3], const double wi[3], const double alpha[2],
                        bool separable)
{
    if (separable || wo[2] * wi[2] < 0)
        return ggx_masking(wo, alpha) * ggx_masking(wi, alpha);
    return 1 / (1 + ggx_lambda(wo, alpha) + ggx_lambda(wi, alpha)); // Heitz 2014, eq. 99
}

double ggx_visible_density(const double wo[3], const double h[3], const double alpha[2])
{
    return ggx_masking(wo, alpha) * fmax(0, optics_dot(wo, h)) * ggx_density(h, alpha) / wo[2];
}

double ggx_reflected_density(const double wo[3], const double h[3], const double alpha[2])
{
    return ggx_masking(wo, alpha) * ggx_density(h, alpha) / (4 * wo[2]);
}

// --- half-vectors --------------------------------------------------------------------------------

double optics_half_reflected(const double wo[3], const double wi[3], double h[3])
{
    for (int c = 0; c < 3; c++)
        h[c] = wo[c] + wi[c];
    double length = sqrt(optics_dot(h, h));
    for (int c = 0; c < 3; c++)
        h[c] /= length;
    return length / 2;
}

double optics_half_refracted(const double wo[3], const double wi[3], double eta, double h[3])
{
    for (int c = 0; c < 3; c++)
        h[c] = wo[c] + eta * wi[c];
    double length = sqrt(optics_dot(h, h)), sign = h[2] < 0 ? -1 : 1;
    for (int c = 0; c < 3; c++)
        h[c] *= sign / length;
    double outside = optics_dot(wo, h), inside = optics_dot(wi, h);
    if (!(length > 0) || !(outside > 0) || !(inside < 0))
        return 0;
    return eta * eta * -inside / (length * length);
}
