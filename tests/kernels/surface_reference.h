// The quantities that shade_surface uses, in double precision from the scene's own arrays: points
// on surfaces, densities of next-event estimation, and random numbers.
#ifndef LAMPYRIS_TESTS_SURFACE_REFERENCE_H
#define LAMPYRIS_TESTS_SURFACE_REFERENCE_H

#include "kernel_fixture.h"

struct surface_point {
    double position[3];
    double geometric[3], shading[3]; // unit normals, on the side from which the ray came
    double plane_point[3];           // a point in the plane of a triangle or disc
    const struct flat_shape *shape;  // NULL for a triangle
    const struct flat_triangle *triangle;
    const struct material *material;
    double distance; // from the ray's origin
};

// Computes the surface point of a path's hit from its primitive word.
struct surface_point surface_at(const struct renderer *r, const struct gpu_path *path);

// Returns the density, per unit area, with which a point on an emitter with this material is
// chosen.
double pick_density(const struct renderer *r, const struct material *material);
// Returns the density, per solid angle, with which next-event estimation from `origin` chooses the
// unit direction to a point of an emitter.
double light_density(const struct renderer *r, const double origin[3], const double direction[3],
                     const struct surface_point *light);
double power_heuristic(double pdf, double other_pdf);

// Draws four uniforms as the kernels do: pcg4d of (pixel, sample, dimension, seed).
void random_4d(uint32_t pixel, uint32_t sample, uint32_t dimension, uint32_t seed, double out[4]);

#endif
