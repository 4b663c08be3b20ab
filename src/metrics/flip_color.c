// The colour spaces of FLIP: opponent colours for filtering, and a space for colour differences.
#include "metrics/flip_color.h"

#include "base/maths.h"
#include <math.h>

// The matrix from linear Rec. 709 to CIE XYZ, relative to the white point D65, which becomes (1, 1,
// 1): its rows are those of the usual matrix, as fractions, divided by their sums.
static const double to_xyz[3][3] = {
    {10135552.0 / 23359437.0, 8788810.0 / 23359437.0, 4435075.0 / 23359437.0},
    {2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0},
    {1425312.0 / 80288307.0, 8788810.0 / 80288307.0, 70074185.0 / 80288307.0},
};

static void relative_xyz(const double rgb[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = vec3_dot(to_xyz[i], rgb);
}

// Computes the inverse by Cramer's rule.
static void rgb_of_relative_xyz(const double v[3], double out[3])
{
    const double(*m)[3] = to_xyz;
    double cofactors[3];
    vec3_cross(m[1], m[2], cofactors);
    double determinant = vec3_dot(m[0], cofactors);
    for (int c = 0; c < 3; c++) {
        int d = (c + 1) % 3, e = (c + 2) % 3;
        double minor = v[0] * (m[1][d] * m[2][e] - m[1][e] * m[2][d]) +
                       v[1] * (m[2][d] * m[0][e] - m[2][e] * m[0][d]) +
                       v[2] * (m[0][d] * m[1][e] - m[0][e] * m[1][d]);
        out[c] = minor / determinant;
    }
}

void flip_ycxcz_of_rgb(const double rgb[3], double out[3])
{
    double xyz[3];
    relative_xyz(rgb, xyz);
    out[0] = 116 * xyz[1] - 16;
    out[1] = 500 * (xyz[0] - xyz[1]);
    out[2] = 200 * (xyz[1] - xyz[2]);
}

void flip_rgb_of_ycxcz(const double ycxcz[3], double out[3])
{
    double y = (ycxcz[0] + 16) / 116;
    const double xyz[3] = {y + ycxcz[1] / 500, y, y - ycxcz[2] / 200};
    rgb_of_relative_xyz(xyz, out);
}

static double lab_curve(double t)
{
    const double delta = 6.0 / 29.0;
    return t > delta * delta * delta ? cbrt(t) : t / (3 * delta * delta) + 4.0 / 29.0;
}

void flip_hunt_lab(const double rgb[3], double out[3])
{
    double xyz[3];
    relative_xyz(rgb, xyz);
    double fx = lab_curve(xyz[0]), fy = lab_curve(xyz[1]), fz = lab_curve(xyz[2]);
    out[0] = 116 * fy - 16;
    out[1] = 0.01 * out[0] * 500 * (fx - fy);
    out[2] = 0.01 * out[0] * 200 * (fy - fz);
}

double flip_hyab(const double a[3], const double b[3])
{
    return fabs(a[0] - b[0]) + hypot(a[1] - b[1], a[2] - b[2]);
}

double flip_luminance(const double rgb[3])
{
    return vec3_dot(to_xyz[1], rgb);
}
