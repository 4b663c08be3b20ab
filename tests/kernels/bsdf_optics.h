// Fresnel's equations and microfacet distributions in double precision, written from the papers.
#ifndef LAMPYRIS_TESTS_BSDF_OPTICS_H
#define LAMPYRIS_TESTS_BSDF_OPTICS_H

#include <stdbool.h>

// Below this alpha a microfacet surface is a perfect mirror; this is part of the models'
// definition.
#define SMALLEST_ALPHA ((double)1e-4f)
// Returns roughness^2, rounded as the models do, because 0.01 is at the limit.
double optics_alpha(float roughness);

double optics_dot(const double a[3], const double b[3]);
void optics_normalize(double v[3]);

// Returns the reflectance of a dielectric with relative index eta for unpolarised light; 1 beyond
// the critical angle.
double optics_fresnel(double cosine, double eta);
// Returns the cosine on the other side of the surface; 0 from the critical angle on.
double optics_cos_refracted(double cosine, double eta);
double optics_fresnel_conductor(double cosine, double eta, double k);
double optics_schlick(double f0, double cosine);
// Returns the diffuse mean of F: 2 integral of F(c) c dc.
double optics_mean_fresnel(double eta);

// --- GGX -----------------------------------------------------------------------------------------

double ggx_density(const double h[3], const double alpha[2]);
double ggx_lambda(const double w[3], const double alpha[2]);
double ggx_masking(const double w[3], const double alpha[2]); // G1
// Returns the masking of both directions: height-correlated on one side, separable on opposite
// sides or on request.
double ggx_masking_both(const double wo[3], const double wi[3], const double alpha[2],
                        bool separable);
// Return the density of the normals visible from wo (Heitz 2018, eq. 3), and of the directions that
// they reflect: the former over 4 wo.h, which cancels.
double ggx_visible_density(const double wo[3], const double h[3], const double alpha[2]);
double ggx_reflected_density(const double wo[3], const double h[3], const double alpha[2]);

// --- half-vectors --------------------------------------------------------------------------------

// Computes the half-vector of reflection, a unit vector. Returns wo.h.
double optics_half_reflected(const double wo[3], const double wi[3], double h[3]);
// Computes the half-vector of refraction (Walter et al. 2007, eq. 16), a unit vector with h.z > 0.
// Returns dh/dwi (eq. 17), or 0 if there is none.
double optics_half_refracted(const double wo[3], const double wi[3], double eta, double h[3]);

#endif
