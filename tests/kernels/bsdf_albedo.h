// The tables of directional albedos, looked up in double precision as lib/albedo.glsl does in
// single. That they are right is tested by quadrature.
#ifndef LAMPYRIS_TESTS_BSDF_ALBEDO_H
#define LAMPYRIS_TESTS_BSDF_ALBEDO_H

#include <stdbool.h>

double table_ggx(double mu, double alpha);     // E1
double table_schlick(double mu, double alpha); // mean of Schlick's weight over what GGX reflects
double table_fresnel(double mu, double alpha, double eta); // the same of Fresnel's reflectance
// Return the albedos of an interface that reflects and refracts, and of one that reflects nothing
// but totally.
double table_glass(double mu, double alpha, double eta);
double table_clear(double mu, double alpha, double eta);
// Return anisotropic GGX's E1, and a cosine that stands for those of what it reflects. wo is in the
// frame of the turned tangent.
double table_turned(const double wo[3], double roughness, double anisotropic,
                    const double alpha[2]);
double table_turned_cosine(const double wo[3], double roughness, double anisotropic,
                           const double alpha[2]);
// Returns the albedo of an anisotropic interface that reflects and refracts; if `is_clear`, it
// reflects nothing but totally.
double table_turned_glass(const double wo[3], double roughness, double anisotropic,
                          const double alpha[2], double eta, bool is_clear);
double table_charlie(double mu, double roughness);
double table_coat(double mu, double gloss);       // Burley's, of weight 1
double table_coat_exact(double mu, double gloss); // with the reflectance of index 1.5
// Burley's subsurface approximation, base colour 1, and his sheen.
double table_below(double mu, double roughness);
double table_sheen(double mu);

#endif
