// Fresnel's equations and microfacets in double precision, straight from the papers.
#ifndef LAMPYRIS_TESTS_BSDF_OPTICS_H
#define LAMPYRIS_TESTS_BSDF_OPTICS_H

#include <stdbool.h>

// Below it a microfacet surface is a perfect mirror: part of the models' definition.
#define SMALLEST_ALPHA ((double)1e-4f)
// roughness^2, rounded as the models round it, since 0.01 is on the border.
double optics_alpha(float roughness);

double optics_dot(const double a[3], const double b[3]);
void optics_normalize(double v[3]);

// Unpolarised light at a dielectric of relative index eta; 1 beyond the critical angle.
double optics_fresnel(double cosine, double eta);
// The cosine beyond the surface; 0 from the critical angle on.
double optics_cos_refracted(double cosine, double eta);
double optics_fresnel_conductor(double cosine, double eta, double k);
double optics_schlick(double f0, double cosine);
// Diffuse mean of F: 2 integral of F(c) c dc.
double optics_mean_fresnel(double eta);

// --- GGX -----------------------------------------------------------------------------------------

double ggx_density(const double h[3], const double alpha[2]);
double ggx_lambda(const double w[3], const double alpha[2]);
double ggx_masking(const double w[3], const double alpha[2]); // G1
// Both directions; height-correlated on one side, separable on opposite ones or where asked for.
double ggx_masking_both(const double wo[3], const double wi[3], const double alpha[2],
                        bool separable);
// Density of the normals that wo sees (Heitz 2018, eq. 3), and of what they reflect: over 4 wo.h,
// which cancels.
double ggx_visible_density(const double wo[3], const double h[3], const double alpha[2]);
double ggx_reflected_density(const double wo[3], const double h[3], const double alpha[2]);

// --- half-vectors --------------------------------------------------------------------------------

// Finds the half-vector of reflection, a unit vector; returns wo.h.
double optics_half_reflected(const double wo[3], const double wi[3], double h[3]);
// Finds the half-vector of refraction (Walter et al. 2007, eq. 16), a unit vector with h.z > 0;
// returns dh/dwi (eq. 17), or 0 if there is none.
double optics_half_refracted(const double wo[3], const double wi[3], double eta, double h[3]);

#endif
