// Analytic shapes in double precision: where rays cross them, how far points are from them, random
// ones and points on them.
#ifndef LAMPYRIS_TESTS_SHAPE_REFERENCE_H
#define LAMPYRIS_TESTS_SHAPE_REFERENCE_H

#include "kernel_fixture.h"

// A shape as its rounded record says, larger by `grown` to all sides, and longer by `longer` at the
// ends of a cylinder or tube.
struct exact_shape {
    uint32_t kind;
    double center[3];
    double axis[3][3]; // unit; of a quad's edges the third is its normal
    double half[3];    // along them; cylinder, tube: the axis is the first
    double radius;
};
struct exact_shape exact_shape(const struct flat_shape *flat, double grown, double longer);

// Returns the largest extent of a shape.
double exact_size(const struct exact_shape *shape);

// Crossings in ascending order, behind the origin as well: how many.
int exact_crossings(const struct exact_shape *shape, const double origin[3],
                    const double direction[3], double t[2]);

// How far a point is above face `at` (as hit records have it), outwards.
double exact_height(const struct exact_shape *shape, const double point[3], int at);

// A point on the shape and the normal there, outwards; at its edges, rims, corners where `edge`.
void exact_point(const struct exact_shape *shape, struct random *random, bool edge, double point[3],
                 double normal[3]);

// Adds a shape of a kind with axes in random directions (along the world's where `upright`), and a
// size; elongated up to `aspect`.
void add_random_shape(struct scene *scene, uint32_t kind, const double center[3], double size,
                      double aspect, bool upright, struct random *random);

#endif
