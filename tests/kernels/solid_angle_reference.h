// Triangles as a point sees them, in double precision, by the angles between their sides: another
// way than that of lib/solid_angle.glsl.
#ifndef LAMPYRIS_TESTS_SOLID_ANGLE_REFERENCE_H
#define LAMPYRIS_TESTS_SOLID_ANGLE_REFERENCE_H

#include <stdbool.h>

// In steradians; the corners are relative to the point.
double exact_solid_angle(double corners[3][3]);

// Returns whether a point on a triangle of this solid angle is chosen by it, not by area.
bool is_chosen_by_solid_angle(double solid_angle);

// The point of the triangle that the uniforms u lead to, by solid angle.
void exact_seen_point(double corners[3][3], const double u[2], double out[3]);

#endif
