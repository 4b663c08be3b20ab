// Divides the directions wi into cells, in coordinates that follow the lobes of a BSDF, and
// integrates a density over each cell by adaptive cubature.
//
// Each side of the surface has a chart: a row coordinate in [0, 1] and an azimuth. However narrow a
// lobe is, it covers many rows of its chart: with t = tan(theta) / alpha, the row of a half-vector
// is the mean of 1 - 1 / sqrt(1 + t^2) over the lobes' alphas. Diffuse parts have an alpha of 1,
// for which this is 1 - cos(theta).
#ifndef LAMPYRIS_TESTS_BSDF_CELLS_H
#define LAMPYRIS_TESTS_BSDF_CELLS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { CHART_ROWS = 40, CHART_COLUMNS = 160, CHART_CELLS = CHART_ROWS * CHART_COLUMNS };
enum {
    SIDES = 2,
    CELLS = SIDES * CHART_CELLS
}; // reflection and transmission, each with 80 x 160
   // cells
enum { CHART_MAX_LOBES = 4 };

enum chart_kind {
    CHART_SPHERE,  // rows of equal angles from the normal
    CHART_MIRROR,  // about the mirrored wo
    CHART_REFLECT, // by the half-vector of reflection
    CHART_REFRACT, // by the half-vector of refraction
    CHART_NORMALS, // the half-vectors themselves instead of wi
};

struct chart {
    enum chart_kind kind;
    bool below; // directions below the surface; CHART_REFLECT and CHART_MIRROR are then turned over
    double wo[3], eta;
    double alpha[CHART_MAX_LOBES][2]; // along x and y; the aspect of the first one shapes the
                                      // azimuth
    int lobes;
    double turn[2]; // cosine and sine of the angle between the x axes of the frame and of the lobes
};

// chart_cosine() returns wo.h at (x, phi) of a chart by half-vectors. The other function returns
// the width, in wo.h, of the change of Fresnel's reflectance near grazing incidence: the cosine of
// the critical angle, on whichever side it is.
double chart_cosine(const struct chart *chart, double x, double phi);
double chart_fresnel_scale(const struct chart *chart);

// Computes the unit vector that was rounded to `rounded`: the greatest component, which lost most,
// is computed from the others.
void chart_unit(const float rounded[3], double out[3]);
// Computes the direction at (x, phi), and its solid angle per unit of dx dphi. Returns false if it
// is not on this side.
bool chart_direction(const struct chart *chart, double x, double phi, double wi[3],
                     double *jacobian);
// Computes the half-vector at (x, phi) of a chart that has half-vectors. Returns its solid angle
// per unit of dx dphi.
double chart_normal(const struct chart *chart, double x, double phi, double h[3]);
void chart_place(const struct chart *chart, const double wi[3], double *x, double *phi);
// Returns the row coordinate of the horizon.
double chart_end(const struct chart *chart, double phi);
// Returns the cell of the chart that contains wi.
uint32_t chart_cell(const struct chart *chart, const double wi[3]);

typedef double (*density_fn)(const void *context, const double wi[3]);

// A direction at which the cubature has evaluated the density.
struct cell_node {
    float wi[3];
    float weight; // solid angle that it represents
};

struct cell_integrals {
    double expected[CELLS]; // integral of the density over each cell
    double total;
    struct cell_node *nodes; // owned, on the heap
    size_t node_count;
    size_t unresolved; // number of parts of the least size in which the rules do not agree
};

// Integrates over both charts, on all CPU threads. The rule is Gauss-Legendre 3 x 3, compared with
// 2 x 2, in cells that are quartered until both agree. Returns false when out of memory.
bool cells_integrate(const struct chart charts[SIDES], density_fn density, const void *context,
                     struct cell_integrals *out);
void cells_finish(struct cell_integrals *integrals);

#endif
