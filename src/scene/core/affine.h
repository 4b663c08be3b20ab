// Affine maps in double precision. A map is the upper three rows of a 4x4 matrix,
// row-major, that multiplies column vectors: p' = M p.
#ifndef LAMPYRIS_SCENE_CORE_AFFINE_H
#define LAMPYRIS_SCENE_CORE_AFFINE_H

#include "base/maths.h"
#include <stdbool.h>

extern const double AFFINE_IDENTITY[3][4];

// Computes out = a b, which applies b first. `out` may be `a` or `b`.
void affine_multiply(const double a[3][4], const double b[3][4], double out[3][4]);
void affine_point(const double m[3][4], const double p[3], double out[3]);
// Transforms a vector, ignoring the translation.
void affine_vector(const double m[3][4], const double v[3], double out[3]);

// Computes the rotation by `angle` radians about `axis` (of any length but zero) through the
// origin, counter-clockwise when the axis points to the viewer. Returns false when the axis has no
// direction.
bool affine_rotation(const double axis[3], double angle, double out[3][4]);

// Returns the determinant of the linear part; exactly 0 if it does not exceed its own rounding
// error.
double affine_determinant(const double m[3][4]);
// Computes the matrix of cofactors, which is the determinant times the inverse transpose. It
// transforms normals without a division, even for singular maps. A negative determinant reverses
// the normals.
void affine_cofactors(const double m[3][4], double out[3][3]);
// Computes the inverse. Returns false, leaving `out` unchanged, if the map is singular.
bool affine_inverse(const double m[3][4], double out[3][4]);
// Computes the bounding box of a transformed box.
void affine_box(const double m[3][4], const double min[3], const double max[3], double out_min[3],
                double out_max[3]);
// Returns whether the linear part is a rotation or a reflection times one scale factor, and stores
// that factor.
bool affine_uniform_scale(const double m[3][4], double *scale);

#endif
