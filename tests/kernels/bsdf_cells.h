// Cells over the directions of wi in coordinates that follow a BSDF's lobes, and what a density
// holds in each by adaptive cubature.
//
// Each side of the surface has a chart: a row coordinate in [0, 1] and an azimuth. However narrow a
// lobe is, it covers many rows of its chart: with t = tan(theta) / alpha, the row of a half-vector
// is the mean of 1 - 1 / sqrt(1 + t^2) over the lobes' alphas, and an alpha of 1 for what is
// diffuse (where that is 1 - cos(theta)).
#ifndef LAMPYRIS_TESTS_BSDF_CELLS_H
#define LAMPYRIS_TESTS_BSDF_CELLS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { CHART_ROWS = 40, CHART_COLUMNS = 160, CHART_CELLS = CHART_ROWS * CHART_COLUMNS };
enum { SIDES = 2, CELLS = SIDES * CHART_CELLS }; // reflection, transmission: 80 x 160 in all
enum { CHART_MAX_LOBES = 4 };

enum chart_kind {
    CHART_SPHERE,  // rows of equal angles from the normal
    CHART_MIRROR,  // about the mirrored wo
    CHART_REFLECT, // by the half-vector of reflection
    CHART_REFRACT, // by that of refraction
    CHART_NORMALS, // half-vectors themselves in place of wi
};

struct chart {
    enum chart_kind kind;
    bool below; // directions under the surface; CHART_REFLECT and _MIRROR are turned over then
    double wo[3], eta;
    double alpha[CHART_MAX_LOBES][2]; // along x and y; the first one's aspect shapes the azimuth
    int lobes;
    double turn[2]; // cosine and sine of the angle from the frame's x axis to the lobes'
};

// wo.h at (x, phi) of charts by half-vectors, and how narrow a change over wo.h Fresnel's equations
// make near grazing incidence: the cosine of the critical angle, on whichever side it is.
double chart_cosine(const struct chart *chart, double x, double phi);
double chart_fresnel_scale(const struct chart *chart);

// The unit vector that was rounded to `rounded`: its greatest component, which lost most, again
// from the others.
void chart_unit(const float rounded[3], double out[3]);
// The direction at (x, phi) and the solid angle a unit of dx dphi; false outside of the side.
bool chart_direction(const struct chart *chart, double x, double phi, double wi[3],
                     double *jacobian);
// The half-vector at (x, phi), of charts that have them; returns its solid angle a unit of dx dphi.
double chart_normal(const struct chart *chart, double x, double phi, double h[3]);
void chart_place(const struct chart *chart, const double wi[3], double *x, double *phi);
// The row coordinate at which the horizon is met.
double chart_end(const struct chart *chart, double phi);
// The cell of the chart that holds wi.
uint32_t chart_cell(const struct chart *chart, const double wi[3]);

typedef double (*density_fn)(const void *context, const double wi[3]);

// A place where the cubature has looked.
struct cell_node {
    float wi[3];
    float weight; // solid angle that it stands for
};

struct cell_integrals {
    double expected[CELLS]; // integral of the density over each cell
    double total;
    struct cell_node *nodes; // heap
    size_t node_count;
    size_t unresolved; // parts that were as small as they may become before the rules agreed
};

// Integrates over both charts, on all CPU threads. The rule: Gauss-Legendre 3 x 3, checked by 2 x
// 2, in cells that are quartered until both agree. False when out of memory.
bool cells_integrate(const struct chart charts[SIDES], density_fn density, const void *context,
                     struct cell_integrals *out);
void cells_finish(struct cell_integrals *integrals);

#endif
