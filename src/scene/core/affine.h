// Affine maps in double precision. A map is the upper three rows of a 4x4 matrix,
// row-major, that multiplies column vectors: p' = M p.
#ifndef LAMPYRIS_SCENE_CORE_AFFINE_H
#define LAMPYRIS_SCENE_CORE_AFFINE_H

#include "base/maths.h"
#include <stdbool.h>

extern const double AFFINE_IDENTITY[3][4];

// out = a b: first b, then a. out may be a or b.
void affine_multiply(const double a[3][4], const double b[3][4], double out[3][4]);
void affine_point(const double m[3][4], const double p[3], double out[3]);
void affine_vector(const double m[3][4], const double v[3], double out[3]); // without translation

// The rotation about `axis` (of any length but zero) through the origin, counter-clockwise when the
// axis points to the eye. False when the axis has no direction.
bool affine_rotation(const double axis[3], double angle, double out[3][4]);

// The determinant of the linear part; exactly 0 when it is singular up to the rounding of the
// determinant itself.
double affine_determinant(const double m[3][4]);
// The matrix of cofactors, determinant times inverse transpose: it takes normals along without a
// division, for singular maps too. A negative determinant turns its normals round.
void affine_cofactors(const double m[3][4], double out[3][3]);
// False, and out unset, when it is singular.
bool affine_inverse(const double m[3][4], double out[3][4]);
// The box around the image of a box.
void affine_box(const double m[3][4], const double min[3], const double max[3], double out_min[3],
                double out_max[3]);
// Returns whether the linear part is a rotation or reflection times one scale; that scale.
bool affine_uniform_scale(const double m[3][4], double *scale);

#endif
