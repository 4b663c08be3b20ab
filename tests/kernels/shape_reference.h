// Analytic shapes in double precision: intersections with rays, distances of points, random shapes
// and points on them.
#ifndef LAMPYRIS_TESTS_SHAPE_REFERENCE_H
#define LAMPYRIS_TESTS_SHAPE_REFERENCE_H

#include "kernel_fixture.h"

// A shape as its rounded record defines it, enlarged by `grown` on all sides, and by `longer` at
// the ends of a cylinder or open cylinder.
struct exact_shape {
    uint32_t kind;
    double center[3];
    double axis[3][3]; // unit vectors; for a quad the edges and the normal
    double half[3];    // half extents along them; for cylinders the first one is along the axis
    double radius;
};
struct exact_shape exact_shape(const struct flat_shape *flat, double grown, double longer);

// Returns the largest extent of a shape.
double exact_size(const struct exact_shape *shape);

// Computes the crossings in ascending order, including those behind the origin. Returns their
// number.
int exact_crossings(const struct exact_shape *shape, const double origin[3],
                    const double direction[3], double t[2]);

// Returns the height of a point above face `at` (as in hit records), positive outwards.
double exact_height(const struct exact_shape *shape, const double point[3], int at);

// Computes a random point on the shape, with `edge` on its edges, rims or corners, and the outward
// normal there.
void exact_point(const struct exact_shape *shape, struct random *random, bool edge, double point[3],
                 double normal[3]);

// Adds a shape of a kind with axes in random directions (with `upright` along the world's) and a
// random size, elongated by up to `aspect`.
void add_random_shape(struct scene *scene, uint32_t kind, const double center[3], double size,
                      double aspect, bool upright, struct random *random);

#endif
