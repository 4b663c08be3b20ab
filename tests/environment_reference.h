// Computes what scene/core/environment.h says of an image once more, in double precision: radiance
// between the centres of texels, and the density with which render/tables/environment_table.h says
// that it is sampled.
#ifndef LAMPYRIS_TESTS_ENVIRONMENT_REFERENCE_H
#define LAMPYRIS_TESTS_ENVIRONMENT_REFERENCE_H

#include "base/maths.h"
#include "scene/core/environment.h"

// A cell lies between columns `column` and the next one, and rows `row` and the next one of nodes:
// those of texels, and one before and after them for the poles. Where in it, from 0 to 1: `right`
// in longitude, `part` by angle from the row above, `down` by solid angle.
struct reference_place {
    uint32_t column, row;
    double right, part, down;
};

// Angle from the zenith.
static inline double reference_node_angle(const struct environment *e, uint32_t row)
{
    if (row == 0)
        return 0;
    return row > e->height ? M_PI : M_PI * (row - 0.5) / e->height;
}

// Without the factor on all.
static inline void reference_node(const struct environment *e, uint32_t row, uint32_t column,
                                  double rgb[3])
{
    bool is_pole = row == 0 || row > e->height;
    uint32_t of = row == 0 ? 0 : row > e->height ? e->height - 1 : row - 1;
    const float(*texels)[3] = (const float(*)[3])e->texels + (size_t)of * e->width;
    for (int c = 0; c < 3; c++) {
        double sum = 0;
        for (uint32_t i = 0; is_pole && i < e->width; i++)
            sum += (double)texels[i][c] / e->width;
        rgb[c] = is_pole ? sum : (double)texels[column % e->width][c];
    }
}

static inline struct reference_place reference_place_of(const struct environment *e,
                                                        const double direction[3])
{
    struct reference_place p;
    double radius = hypot(direction[0], direction[2]);
    double x = (0.5 + atan2(direction[2], direction[0]) / (2 * M_PI)) * e->width - 0.5;
    double angle = atan2(radius, direction[1]);
    p.right = x - floor(x);
    p.column = x < 0 ? e->width - 1 : (uint32_t)x % e->width;
    p.row = (uint32_t)(angle / M_PI * e->height + 0.5);
    if (p.row > e->height)
        p.row = e->height;
    double top = reference_node_angle(e, p.row), bottom = reference_node_angle(e, p.row + 1);
    p.part = (angle - top) / (bottom - top);
    p.down = sin((angle + top) / 2) * sin((angle - top) / 2) /
             (sin((bottom + top) / 2) * sin((bottom - top) / 2));
    return p;
}

static inline double reference_mix(const double corners[4], double right, double down)
{
    return (1 - down) * ((1 - right) * corners[0] + right * corners[1]) +
           down * ((1 - right) * corners[2] + right * corners[3]);
}

static inline void reference_corners(const struct environment *e, uint32_t row, uint32_t column,
                                     double rgb[4][3])
{
    for (uint32_t i = 0; i < 4; i++)
        reference_node(e, row + i / 2, column + i % 2, rgb[i]);
}

static inline void reference_radiance(const struct environment *e, const struct reference_place *p,
                                      double rgb[3])
{
    double corners[4][3];
    reference_corners(e, p->row, p->column, corners);
    for (int c = 0; c < 3; c++) {
        const double of[4] = {corners[0][c], corners[1][c], corners[2][c], corners[3][c]};
        rgb[c] = reference_mix(of, p->right, p->part);
    }
}

// Density per solid angle before it is normalised: what luminances at the corners exceed `floor`
// by.
static inline void reference_luminances(const struct environment *e, double floor, uint32_t row,
                                        uint32_t column, double corners[4])
{
    double rgb[4][3];
    reference_corners(e, row, column, rgb);
    for (int i = 0; i < 4; i++)
        corners[i] = fmax(vec3_luminance(rgb[i]) - floor, 0);
}

// The integral of that over all directions.
static inline double reference_total(const struct environment *e, double floor)
{
    double total = 0, corners[4];
    for (uint32_t row = 0; row <= e->height; row++)
        for (uint32_t column = 0; column < e->width; column++) {
            reference_luminances(e, floor, row, column, corners);
            total += environment_cell_solid_angle(e, row) * reference_mix(corners, 0.5, 0.5);
        }
    return total;
}

#endif
