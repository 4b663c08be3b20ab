// Computes directional albedos by numerical quadrature of the formulas of docs/materials.md, in
// double precision. Arguments are coordinates in [0, 1] along the tables' axes (lib/albedo.glsl).
// Only albedo_generate uses this file.
#ifndef LAMPYRIS_RENDER_TABLES_ALBEDO_INTEGRALS_H
#define LAMPYRIS_RENDER_TABLES_ALBEDO_INTEGRALS_H

#include <math.h>

static inline double clamp01(double x)
{
    return fmin(1.0, fmax(0.0, x));
}

double albedo_ggx(double x, double y);
double albedo_schlick(double x, double y);
double albedo_fresnel(double x, double y, double z, double w);
double glass_outside(double x, double y, double z, double w);
double glass_inside(double x, double y, double z, double w);
double clear_glass(double x, double y, double z, double w);
double albedo_anisotropic(double x, double y, double z, double w);
double albedo_anisotropic_sine(double x, double y, double z, double w);
double turned_glass(const double at[5], int inside);
double albedo_charlie(double x, double y);
double albedo_coat(double x, double y);
double albedo_coat_exact(double x, double y);
void albedo_diffuse(double x, double out[4]);

#endif
