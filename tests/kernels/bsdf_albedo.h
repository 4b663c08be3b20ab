// Looks up the tables of directional albedos in double precision, as lib/albedo.glsl does in single
// precision. Other tests check the tables themselves by quadrature.
#ifndef LAMPYRIS_TESTS_BSDF_ALBEDO_H
#define LAMPYRIS_TESTS_BSDF_ALBEDO_H

#include <stdbool.h>

double table_ggx(double mu, double alpha);     // E1
double table_schlick(double mu, double alpha); // mean of Schlick's weight over the light that GGX
                                               // reflects
double table_fresnel(double mu, double alpha, double eta); // the same mean of Fresnel's reflectance
// Return the albedos of an interface that reflects and refracts, and of one whose only reflection
// is total reflection.
double table_glass(double mu, double alpha, double eta);
double table_clear(double mu, double alpha, double eta);
// Return E1 of anisotropic GGX, and a cosine that represents those of the reflected directions. wo
// is in the frame of the rotated tangent.
double table_turned(const double wo[3], double roughness, double anisotropic,
                    const double alpha[2]);
double table_turned_cosine(const double wo[3], double roughness, double anisotropic,
                           const double alpha[2]);
// Returns the albedo of an anisotropic interface that reflects and refracts; with `is_clear` its
// only reflection is total reflection.
double table_turned_glass(const double wo[3], double roughness, double anisotropic,
                          const double alpha[2], double eta, bool is_clear);
double table_charlie(double mu, double roughness);
double table_coat(double mu, double gloss);       // Burley's clearcoat with weight 1
double table_coat_exact(double mu, double gloss); // the same with Fresnel's reflectance for index
                                                  // 1.5
// Burley's subsurface approximation with base colour 1, and his sheen.
double table_below(double mu, double roughness);
double table_sheen(double mu);

#endif
