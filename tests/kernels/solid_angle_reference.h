// Triangles as seen from a point, in double precision, by the angles between their sides.
// lib/solid_angle.glsl uses another method.
#ifndef LAMPYRIS_TESTS_SOLID_ANGLE_REFERENCE_H
#define LAMPYRIS_TESTS_SOLID_ANGLE_REFERENCE_H

#include <stdbool.h>

// Returns steradians. The corners are relative to the point.
double exact_solid_angle(double corners[3][3]);

// Returns whether points on a triangle with this solid angle are sampled by solid angle, not by
// area.
bool is_chosen_by_solid_angle(double solid_angle);

// Computes the point of the triangle for the uniforms u, sampled by solid angle.
void exact_seen_point(double corners[3][3], const double u[2], double out[3]);

#endif
