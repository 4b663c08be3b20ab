// The quantities that shade_surface uses, in double precision from the scene's own arrays: points
// on surfaces, densities of next-event estimation, and random numbers.
#ifndef LAMPYRIS_TESTS_SURFACE_REFERENCE_H
#define LAMPYRIS_TESTS_SURFACE_REFERENCE_H

#include "kernel_fixture.h"

struct surface_point {
    double position[3];
    double geometric[3], shading[3]; // unit normals, towards where the ray came from
    double plane_point[3];           // a point that the plane of a triangle or disc passes through
    const struct flat_shape *shape;  // NULL: a triangle
    const struct flat_triangle *triangle;
    const struct material *material;
    double distance; // from the ray's origin
};

// Finds the surface of a path's hit, given by its primitive word.
struct surface_point surface_at(const struct renderer *r, const struct gpu_path *path);

// Density, a unit area, with which a point on an emitter of this material is chosen.
double pick_density(const struct renderer *r, const struct material *material);
// Density a solid angle with which next-event estimation from `origin` chooses the unit direction
// to a point of an emitter.
double light_density(const struct renderer *r, const double origin[3], const double direction[3],
                     const struct surface_point *light);
double power_heuristic(double pdf, double other_pdf);

// Four uniforms as the kernels draw them: pcg4d of (pixel, sample, dimension, seed).
void random_4d(uint32_t pixel, uint32_t sample, uint32_t dimension, uint32_t seed, double out[4]);

#endif
